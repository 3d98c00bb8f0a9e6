"""The figures of a study, to stand inside the page."""

from __future__ import annotations

import base64
import json
import re
from dataclasses import dataclass
from pathlib import Path

from impactlab.figures.draw import CAPTIONS
from impactlab.report.drawn_data import drawn_data
from impactlab.report.table import Table

_SCREEN = 1.3
"""Figures are 8 pt at the width of a paper; on a screen that is small."""
_FILES = {".csv": "CSV", ".nc": "netCDF", ".svg": "SVG", ".png": "PNG"}


@dataclass(frozen=True)
class Picture:
    """A numbered figure.

    alt: what it shows, in words. uri: the whole SVG as a data URI. width: on a screen, in CSS
    pixels. data: its numbers, thinned; None for maps. files: (kind, name) of those in its folder.
    """

    number: int
    name: str
    title: str
    caption: str
    alt: str
    uri: str
    width: int
    data: Table | None
    files: list[tuple[str, str]]


def pictures(folder: Path) -> list[Picture]:
    """The figures that captions.json lists, in its order.

    Raises FileNotFoundError, saying what to do, when it or a figure is not in the folder.
    """
    captions = json.loads(_read(folder / CAPTIONS))
    return [
        _picture(number, folder / f"{name}.svg", entry)
        for number, (name, entry) in enumerate(captions.items(), 1)
    ]


def _picture(number: int, path: Path, entry: dict[str, str]) -> Picture:
    """An image of its own keeps the names inside one SVG from meeting those of another."""
    svg, numbers = _read(path), path.with_suffix(".csv")
    return Picture(
        number,
        path.stem,
        entry["title"],
        entry["caption"],
        f"{entry['title']}. {entry['alt']}".strip(),
        f"data:image/svg+xml;base64,{base64.b64encode(svg).decode('ascii')}",
        _width(svg),
        drawn_data(numbers) if numbers.exists() else None,
        [(kind, f"{path.stem}{suffix}") for suffix, kind in _FILES.items()],
    )


def _width(svg: bytes) -> int:
    """From the width in points that matplotlib writes into the root element."""
    found = re.search(rb'<svg [^>]*?\bwidth="([\d.]+)pt"', svg)
    points = float(found.group(1)) if found else 0.0
    return round(points * 96 / 72 * _SCREEN)


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise FileNotFoundError(
            f"{path} is missing: draw the figures again (impactlab figures)"
        ) from None
