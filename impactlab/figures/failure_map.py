"""Where in parameter space runs fail: failed and good runs over the most telling parameters."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import access, labels, scales, style
from impactlab.figures.access import is_sample, varied
from impactlab.figures.labels import display

TITLE = "Where runs failed"
_TELLING = 3
_SHOWN = {"good": 2000, "failed": 1000}
"""Runs drawn of each kind, at most."""
_LOOKS: dict[str, dict[str, Any]] = {
    "good": {"color": "0.65", "marker": ".", "markersize": 2.0, "markeredgewidth": 0.0},
    "failed": {"color": style.COLOURS[1], "marker": "x", "markersize": 3.0, "markeredgewidth": 0.8},
}


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether some runs of a sample of two parameters or more failed, but not all."""
    if not is_sample(runs) or len(varied(runs)) < 2:
        return False
    failed = access.failed(runs)
    return bool(failed.any()) and not bool(failed.all())


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, and how many runs failed."""
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
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a pair of parameters."""
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
    """Kolmogorov-Smirnov distances of the most telling parameters, the largest first."""
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
