"""Every comparison of a verification on one axis: its error over its tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from impactlab.figures import labels, scales, style
from impactlab.verification.finding import Outcome

TITLE = "All comparisons"
_ROW = 8.0
"""Height of a check's row, mm."""
_LEAST, _MOST = 1e-6, 1e3
"""Ratios beyond are drawn at the edge."""
_SPREAD = 0.32
"""How far the points of a row stand from its middle, of the distance of two rows."""
_LETTERS = 34
_LOOKS: dict[str, dict[str, Any]] = {
    "passed": {"marker": "o", "color": style.COLOURS[0], "alpha": 0.7},
    "failed": {"marker": "X", "color": style.COLOURS[1], "markersize": 6.0},
}


def caption(outcomes: Sequence[Outcome]) -> str:
    """What is shown, and how many points lie at the edges."""
    ratios = np.concatenate([_ratios(outcome) for outcome in outcomes])
    small = int(np.count_nonzero(ratios < _LEAST))
    large = int(np.count_nonzero(ratios > _MOST))
    edges = [
        f"{count} {side} {labels.number(limit)} or {tail}"
        for count, side, limit, tail in (
            (small, "below", _LEAST, "without any error at the left edge"),
            (large, "above", _MOST, "without a number at the right edge"),
        )
        if count
    ]
    shown = f" Drawn as triangles: {labels.listing(edges)}." if edges else ""
    return (
        "Error over tolerance, a point a comparison and a row a check; right of the line at 1 a "
        f"comparison fails. Within a row, points are spread in the order of the comparisons.{shown}"
    )


@style.paper
def plot(outcomes: Sequence[Outcome]) -> Figure:
    """A row a check, the first on top; failed comparisons in another shape and colour."""
    size = (style.DOUBLE * style.MILLIMETRE, (18.0 + _ROW * len(outcomes)) * style.MILLIMETRE)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots()
    for row, outcome in enumerate(outcomes):
        _draw(axes, row, outcome)
    axes.axvline(1.0, label="_limit", **style.GUIDE)
    _finish(axes, outcomes)
    style.legend(figure, order=["passed", "failed"])
    return figure


def _draw(axes: Axes, row: int, outcome: Outcome) -> None:
    ratios = _ratios(outcome)
    places = row + np.linspace(-_SPREAD, _SPREAD, ratios.size) if ratios.size > 1 else row
    passed = np.array([entry.passed for entry in outcome.finding.comparisons], dtype=bool)
    shown = np.clip(ratios, _LEAST, _MOST)
    for verdict, chosen in (("passed", passed), ("failed", ~passed)):
        for marker, beyond in (("<", ratios < _LEAST), (">", ratios > _MOST), (None, None)):
            inside = (ratios >= _LEAST) & (ratios <= _MOST) if beyond is None else beyond
            if not (mask := chosen & inside).any():
                continue
            look = _LOOKS[verdict] | ({"marker": marker} if marker else {})
            label = verdict if marker is None else f"_{verdict}"
            y = np.broadcast_to(places, ratios.shape)[mask]
            axes.plot(shown[mask], y, linestyle="", markeredgewidth=0.0, label=label, **look)
    text, failed = _count(outcome)
    axes.annotate(
        text,
        (1.0, row),
        (3, 0),
        xycoords=axes.get_yaxis_transform(),
        textcoords="offset points",
        va="center",
        fontsize=7,
        fontweight="bold" if failed else "normal",
        color=style.COLOURS[1] if failed else style.MUTED,
    )


def _ratios(outcome: Outcome) -> NDArray[np.float64]:
    return np.array([entry.ratio for entry in outcome.finding.comparisons], dtype=float)


def _least(outcomes: Sequence[Outcome]) -> float:
    """The decade below all that is drawn."""
    ratios = np.clip(np.concatenate([_ratios(o) for o in outcomes] + [[0.01]]), _LEAST, _MOST)
    return float(10.0 ** np.floor(np.log10(ratios.min())))


def _count(outcome: Outcome) -> tuple[str, bool]:
    """What stands right of a row, and whether it is bad news."""
    total, failed = len(outcome.finding.comparisons), len(outcome.failures)
    if outcome.verdict == "error" or not total:
        return ("error" if outcome.reason else "nothing"), True
    return (f"{failed} of {total} failed", True) if failed else (f"all {total}", False)


def _finish(axes: Axes, outcomes: Sequence[Outcome]) -> None:
    """Decades along x up to what is drawn; the checks' titles along y."""
    largest = max((float(_ratios(outcome).max(initial=0.0)) for outcome in outcomes), default=0.0)
    limits = 0.6 * _least(outcomes), 2.5 * min(max(largest, 4.0), _MOST)
    scales.logarithmic(axes, "x", limits, ticks=8)
    axes.set(xlim=limits, ylim=(len(outcomes) - 0.5, -0.5), xlabel="Error over tolerance (–)")
    axes.set_yticks(
        range(len(outcomes)), [fill(outcome.title, width=_LETTERS) for outcome in outcomes]
    )
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False, axis="y")
    for row in range(1, len(outcomes)):
        axes.axhline(row - 0.5, color="0.85", linewidth=0.5)
