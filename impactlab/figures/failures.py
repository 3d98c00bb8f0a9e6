"""Figures of where in the parameter space runs fail."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as MplFigure
from numpy.typing import NDArray

from impactlab.figures import access, labels, scales, style
from impactlab.figures.access import is_sample, varied
from impactlab.figures.labels import display
from impactlab.figures.record import Figure

_BINS = 10
_LOOK: dict[str, Any] = {
    "color": style.COLOURS[0],
    "marker": "o",
    "linestyle": "",
    "elinewidth": 0.8,
}
_TELLING = 3
_SHOWN = {"good": 2000, "failed": 1000}
"""Largest numbers of runs drawn."""
_LOOKS: dict[str, dict[str, Any]] = {
    "good": {"color": "0.65", "marker": ".", "markersize": 2.0, "markeredgewidth": 0.0},
    "failed": {"color": style.COLOURS[1], "marker": "x", "markersize": 3.0, "markeredgewidth": 0.8},
}


def _shares_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether runs of a sample failed."""
    return is_sample(runs) and bool(varied(runs)) and bool(access.failed(runs).any())


def _shares_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
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
def _plot_shares(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per parameter."""
    names, failed = varied(runs), access.failed(runs).values
    figure, axes = style.panels(len(names), columns=3, height=36, sharey=True)
    for ax, name in zip(axes, names, strict=True):
        unit = display(runs[name])
        _shares(ax, unit(runs[name].values), failed)
        ax.set_xlabel(labels.wrapped_axis(labels.parameter(name), unit.symbol))
    figure.supylabel("Failed runs (%)")
    return figure


def wilson(failed: int, total: int) -> tuple[float, float]:
    """Return the 95 % interval of a binomial share (Wilson 1927, J. Am. Stat. Assoc. 22, 209)."""
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


FAILURE_SHARES = Figure(
    "failure_shares",
    "Share of failed runs along each parameter",
    _shares_applies,
    _plot_shares,
    _shares_caption,
)


def _map_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether some runs of a sample of two parameters or more failed, but not all."""
    if not is_sample(runs) or len(varied(runs)) < 2:
        return False
    failed = access.failed(runs)
    return bool(failed.any()) and not bool(failed.all())


def _map_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    failed = access.failed(runs).values
    told = [
        f"{labels.parameter(name)} {distance:.2f}" for name, distance in _distances(runs).items()
    ]
    return (
        f"The {int(failed.sum())} failed runs among the good ones (at most {_SHOWN['failed']} and "
        f"{_SHOWN['good']} are drawn), over the parameters whose values differ most between the "
        "two. Distance of Kolmogorov and Smirnov between failed and good runs, 1 where they do "
        f"not overlap: {labels.listing(told)}."
    )


@style.paper
def _plot_map(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per pair of parameters."""
    pairs = list(combinations(_distances(runs), 2))
    figure, axes = style.panels(len(pairs), columns=max(len(pairs), 2), height=58)
    failed = access.failed(runs).values
    kinds = {"good": np.flatnonzero(~failed), "failed": np.flatnonzero(failed)}
    for ax, pair in zip(axes, pairs, strict=True):
        units = [display(runs[name]) for name in pair]
        for kind, which in kinds.items():
            some = np.random.default_rng(1).permutation(which)[: _SHOWN[kind]]
            x, y = (unit(runs[name].values[some]) for name, unit in zip(pair, units, strict=True))
            ax.plot(x, y, linestyle="", label=kind, rasterized=kind == "good", **_LOOKS[kind])
        texts = [
            labels.wrapped_axis(labels.parameter(name), display(runs[name]).symbol) for name in pair
        ]
        ax.set(xlabel=texts[0], ylabel=texts[1])
        scales.linear(ax, "x", 4)
        scales.linear(ax, "y", 4)
    style.legend(figure)
    return figure


def _distances(runs: xr.Dataset) -> dict[str, float]:
    """Return the Kolmogorov-Smirnov distances of the most telling parameters, the largest first."""
    failed = access.failed(runs).values
    found = {
        name: float(
            scipy.stats.ks_2samp(
                runs[name].values[failed], runs[name].values[~failed], method="asymp"
            ).statistic
        )
        for name in varied(runs)
    }
    ranked = sorted(found, key=lambda name: -found[name])
    return {name: found[name] for name in ranked[:_TELLING]}


FAILURE_MAP = Figure(
    "failure_map",
    "Where runs failed",
    _map_applies,
    _plot_map,
    _map_caption,
)
