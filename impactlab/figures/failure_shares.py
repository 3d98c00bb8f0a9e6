"""Where in parameter space runs fail: the share of failed runs along each parameter."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from impactlab.figures import access, labels, scales, style
from impactlab.figures.access import is_sample, varied
from impactlab.figures.labels import display

TITLE = "Share of failed runs along each parameter"
_BINS = 10
_LOOK: dict[str, Any] = {
    "color": style.COLOURS[0],
    "marker": "o",
    "linestyle": "",
    "elinewidth": 0.8,
}


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether runs of a sample failed."""
    return is_sample(runs) and bool(varied(runs)) and bool(access.failed(runs).any())


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, and how many failed why."""
    failed = access.failed(runs)
    why = [f"{number} × “{text}”" for text, number in access.causes(runs, failed).items()]
    return (
        "Share of the runs that failed in each tenth of a parameter's draws, with the 95 % "
        "interval of a binomial share (Wilson); dashed: the share of all runs. A parameter along "
        "which the share rises tells where runs fail. "
        f"{int(failed.sum())} of {failed.size} runs failed, or are missing a response: "
        f"{labels.listing(why)}."
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a parameter."""
    names, failed = varied(runs), access.failed(runs).values
    figure, axes = style.panels(len(names), columns=3, height=36, sharey=True)
    for ax, name in zip(axes, names, strict=True):
        unit = display(runs[name])
        _shares(ax, unit(runs[name].values), failed)
        ax.set_xlabel(labels.wrapped_axis(labels.parameter(name), unit.symbol))
    figure.supylabel("Failed runs (%)")
    return figure


def wilson(failed: int, total: int) -> tuple[float, float]:
    """The 95 % interval of a binomial share (Wilson 1927, J. Am. Stat. Assoc. 22, 209)."""
    share, z = failed / total, 1.959963984540054
    middle = share + z**2 / (2 * total)
    half = z * np.sqrt(share * (1 - share) / total + (z / (2 * total)) ** 2)
    scale = 1 + z**2 / total
    return max(0.0, (middle - half) / scale), (middle + half) / scale


def _shares(ax: Axes, x: NDArray[np.float64], failed: NDArray[np.bool_]) -> None:
    edges = np.unique(np.quantile(x, np.linspace(0.0, 1.0, _BINS + 1)))
    place = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, max(edges.size - 2, 0))
    found = []
    for at in np.unique(place):
        here = place == at
        low, high = wilson(int(failed[here].sum()), int(here.sum()))
        share = failed[here].mean()
        found.append((x[here].mean(), 100 * share, 100 * (share - low), 100 * (high - share)))
    middle, share, below, above = np.array(found).T
    ax.errorbar(middle, share, np.clip([below, above], 0.0, None), label="share", **_LOOK)
    ax.axhline(100 * failed.mean(), label="_guide", linestyle="--", **style.GUIDE)
    ax.set_ylim(0.0, None)
    scales.linear(ax, "x", 4)
    scales.linear(ax, "y", 4)
