"""Surrogates against the solver, on runs that they were not fitted to."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, labels, responses_grid, scales, style
from impactlab.figures.access import known, responses, usable
from impactlab.figures.curves import spread
from impactlab.figures.labels import display

TITLE = "Surrogates against the solver"
_MOST = 400
"""Points in a panel; more hide each other."""


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the analysis has tested surrogates of these runs' responses."""
    return "surrogate_held_out" in analysis and bool(_names(runs, analysis))


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, how many of the tests, and what is missing."""
    tests = analysis.sizes["held_out"]
    shown = f", {_MOST} of them shown" if tests > _MOST else ""
    return (
        "Prediction of a polynomial chaos against the solver's answer, for "
        f"{labels.counted(tests, 'run')} that it was not fitted to{shown}; on the line both agree. "
        "Q²: 1 less the mean squared error over the variance of all of them. "
        f"{access.missing_note(runs, _names(runs, analysis))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response, both axes alike."""
    figure, axes = responses_grid.panels(_names(runs, analysis), height=46)
    for name, ax in axes.items():
        _points(ax, runs, analysis, name)
        _worth(ax, analysis, name)
    figure.supxlabel("Computed by the solver")
    figure.supylabel("Predicted by the surrogate")
    return figure


def _names(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    return [name for name in responses(runs) if known(analysis, name)]


def _points(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str) -> None:
    answers = usable(runs, name).rename(name).assign_attrs(runs[name].attrs)
    unit = display(answers)
    ax.set_title(labels.axis(labels.response(name), unit.symbol), loc="left")
    found = analysis["surrogate_held_out"].sel(response=name)
    found = found[spread(found.size, min(found.size, _MOST))]
    computed = unit(answers.set_index(run="run").sel(run=found["held_out"].values))
    predicted = unit(found)
    given = np.isfinite(computed) & np.isfinite(predicted)
    if not given.any():
        return
    ends = np.array([computed[given], predicted[given]])
    low, high = float(ends.min()), float(ends.max())
    ax.axline((low, low), (high, high), label="_guide", **style.GUIDE)
    ax.plot(
        computed[given],
        predicted[given],
        linestyle="",
        marker="o",
        markersize=1.8,
        markeredgewidth=0,
        alpha=0.6,
        color=style.COLOURS[0],
        label="runs held out",
    )
    for which in ("x", "y"):
        scales.linear(ax, which, ticks=4)


def _worth(ax: Axes, analysis: xr.Dataset, name: str) -> None:
    """Q2 in the corner that agreement leaves empty, with a warning where there is one."""
    verdict = access.verdict(analysis, "surrogate_verdict", name)
    if not ax.lines:
        responses_grid.empty(ax, f"no surrogate:\n{verdict.words if verdict else 'unknown'}")
        return
    q2 = float(analysis["surrogate_q2"].sel(response=name))
    sound = verdict is None or verdict.sound
    text = f"Q² = {labels.number(q2)}"
    ax.annotate(
        text if sound or verdict is None else f"{text}\n{verdict.words}",
        (0.04, 0.96),
        xycoords="axes fraction",
        va="top",
        fontsize=7,
        fontweight="normal" if sound else "bold",
        color=style.MUTED if sound else style.COLOURS[1],
    )
