"""The record of a figure, and what its folder says of those drawn."""

import json
import re
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import xarray as xr
from matplotlib.figure import Figure as Drawing

from impactlab.figures import style

CAPTIONS = "captions.json"
LEAD = "lead"
"""Name of the figure that shows what the answer's headline is about, alone."""
Drawer = Callable[[xr.Dataset, xr.Dataset], Drawing]


@dataclass(frozen=True)
class Figure:
    """One figure of a study; its functions take runs.nc and analysis.nc, and change neither.

    name: of its files. title: heads the figure. applies: whether the datasets hold what it needs.
    plot: draws it, where it applies. caption: what is shown, which values are held, how many runs
    are missing and why.
    """

    name: str
    title: str
    applies: Callable[[xr.Dataset, xr.Dataset], bool]
    plot: Drawer
    caption: Callable[[xr.Dataset, xr.Dataset], str]


def figure(
    title: str,
    text: str,
    applies: Callable[[xr.Dataset, xr.Dataset], bool],
    sentences: Callable[[xr.Dataset, xr.Dataset], Iterable[str]],
    name: str = "",
) -> Callable[[Drawer], Figure]:
    """Make a function that draws a figure into its record, named after it if there is no `name`.

    text: opens the caption. sentences: follow it, by the datasets; empty ones are left out.
    """
    return lambda plot: Figure(
        name or plot.__name__,
        title,
        applies,
        style.paper(plot),
        lambda runs, analysis: " ".join(filter(None, (text, *sentences(runs, analysis)))),
    )


def listed(folder: Path) -> dict[str, dict[str, str]]:
    """Return what captions.json says of each figure. Raises ValueError where it was damaged."""
    path = folder / CAPTIONS
    with suppress(ValueError, TypeError, AttributeError):
        entries: dict[str, dict[str, str]] = json.loads(path.read_bytes())
        sound = {"title", "caption", "alt"}.issubset
        if all(re.fullmatch(r"\w+", name) and sound(entry) for name, entry in entries.items()):
            return entries
    raise ValueError(f"{path}: is damaged: draw the figures again (impactlab figures)")
