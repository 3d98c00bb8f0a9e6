"""The record of a figure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import matplotlib.figure
import xarray as xr

Drawer = Callable[[xr.Dataset, xr.Dataset], matplotlib.figure.Figure]


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
