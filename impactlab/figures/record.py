"""The record of a figure."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import xarray as xr
from matplotlib.figure import Figure as Drawing

from impactlab.figures import style

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
