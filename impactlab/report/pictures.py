"""The figures of a study, to stand inside the page."""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass
from pathlib import Path

from impactlab.figures.draw import CAPTIONS


@dataclass(frozen=True)
class Picture:
    """A numbered figure; uri: the whole SVG as a data URI."""

    number: int
    name: str
    title: str
    caption: str
    uri: str


def pictures(folder: Path) -> list[Picture]:
    """The figures that captions.json lists, in its order.

    Raises FileNotFoundError, saying what to do, when it or a figure is not in the folder.
    """
    captions = json.loads(_read(folder / CAPTIONS))
    return [
        Picture(number, name, entry["title"], entry["caption"], _uri(folder / f"{name}.svg"))
        for number, (name, entry) in enumerate(captions.items(), 1)
    ]


def _uri(path: Path) -> str:
    """An image of its own keeps the names inside one SVG from meeting those of another."""
    return f"data:image/svg+xml;base64,{base64.b64encode(_read(path)).decode('ascii')}"


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise FileNotFoundError(
            f"{path} is missing: draw the figures again (impactlab figures)"
        ) from None
