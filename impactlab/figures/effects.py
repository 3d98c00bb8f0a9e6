"""Figures of grids: the effect of each varied parameter, and of shear."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as MplFigure
from numpy.typing import NDArray

from impactlab.figures import access, curves, labels, responses_grid, scales, style
from impactlab.figures.access import is_sample, physical, responses, usable
from impactlab.figures.curves import Choice, Plan, plan
from impactlab.figures.labels import display
from impactlab.figures.record import Figure
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Beam, paper_impact
from impactlab.model.parameters import PARAMETERS, with_values
from impactlab.verification.solutions.shear import impact_share

_FEWEST = 3
_THRESHOLD = 1.0
"""Changes that matter, %."""
_WIDE = 10.0
"""Largest change in % up to which an axis is linear."""
_WITHOUT, _WITH = "euler_bernoulli", "timoshenko"
_PEAK, _DURATION = "peak_force", "contact_duration"
_NAMES = (_PEAK, _DURATION)
_BEAM = [name for name, entry in PARAMETERS.items() if entry.path[:2] == ("impact", "beam")]

Array = NDArray[np.float64]


def _parameters_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether a physical parameter of a grid has at least three values."""
    return not is_sample(runs) and _along(runs) is not None and bool(responses(runs))


def _parameters_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        f"Responses against the {labels.parameter(str(_along(runs)))}; where curves coincide, the "
        f"first in the legend lies on top. {_plan_parameters(runs).note(runs)} "
        f"{access.missing_note(runs, responses(runs))}".strip()
    )


@style.paper
def _plot_parameters(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response: colours by the second parameter, line styles by the third."""
    along, selected = runs[_along(runs)], _plan_parameters(runs)
    unit = display(along)
    figure, axes = responses_grid.panels(responses(runs), height=38)
    for name, ax in axes.items():
        values, label = responses_grid.shown(runs, name)
        ax.set_title(label, loc="left")
        for curve in selected.curves:
            y = values.isel(selected.held | curve.where).values
            if np.isfinite(y).any():
                look = curves.marked(curve)
                ax.plot(unit(along), y, label=curve.label or "_only", **look)
        drawn = [value for line in ax.lines for value in np.asarray(line.get_ydata())]
        scales.fit(ax, "x", unit(along))
        scales.fit(ax, "y", drawn)
        if not ax.lines:
            responses_grid.empty(ax, "no finite values")
    figure.supxlabel(labels.axis(labels.parameter(str(along.name)), unit.symbol))
    style.legend(figure, selected.title(), selected.labels())
    return figure


def _along(runs: xr.Dataset) -> str | None:
    """Return the first physical parameter with enough values to draw a curve."""
    found = (name for name in physical(runs) if runs.sizes.get(name, 0) >= _FEWEST)
    return next(found, None)


def _plan_parameters(runs: xr.Dataset) -> Plan:
    others = [name for name in physical(runs) if name != _along(runs)]
    return plan(runs, responses(runs)[0], along=[str(_along(runs))], prefer=others)


PARAMETER_EFFECTS = Figure(
    "parameter_effects",
    "Effect of the varied parameters",
    _parameters_applies,
    _plot_parameters,
    _parameters_caption,
)


def _shear_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether a grid has three depths or more, each with and without shear."""
    if is_sample(runs) or not all(name in runs for name in _NAMES):
        return False
    models = runs["beam_model"].values.tolist() if "beam_model" in runs.sizes else []
    return runs.sizes.get("beam_depth", 0) >= _FEWEST and {_WITHOUT, _WITH} <= set(models)


def _shear_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    found = " ".join(filter(None, (_finding(runs, name) for name in _NAMES)))
    return (
        "Relative change by shear and rotary inertia: a Timoshenko beam over an Euler-Bernoulli "
        "one, minus one. Below, the same changes against how much shear and "
        "rotary inertia slow the wave that turns by π during the contact, which goes with depth "
        "over contact duration: if it decided alone, the curves would coincide. Grey: changes of "
        f"{labels.number(_THRESHOLD)} %. {found} {_plan_shear(runs).note(runs)} "
        f"{access.missing_note(runs, _NAMES)}".strip()
    )


@style.paper
def _plot_shear(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a column per response: against depth over span above, against the share below."""
    selected = _plan_shear(runs)
    figure, axes = style.panels(4, columns=2, height=55)
    for at, name in enumerate(_NAMES):
        above, below = axes[at], axes[at + 2]
        for curve in selected.curves:
            slenderness, share, change = _curve(runs, name, selected.held | curve.where)
            _draw(above, slenderness, change, curve)
            _draw(below, share, change, curve)
        for ax in (above, below):
            ax.set_ylabel(labels.axis(f"change of {labels.response(name)}", "%"))
            _finish(ax)
        above.set_xlabel(labels.axis("depth of the beam over its span", ""))
        below.set_xlabel(labels.axis("slowing of the wave of the contact", "%"))
    style.legend(figure, selected.title(), selected.labels())
    return figure


def _plan_shear(runs: xr.Dataset) -> Plan:
    return plan(runs, _PEAK, along=["beam_depth", "beam_model"])


def _curve(runs: xr.Dataset, name: str, where: dict[str, int]) -> tuple[Array, Array, Array]:
    """Return depth over span, the contact's share (NaN without one) and the change, both in %."""
    run = runs.isel(where)
    values, durations = usable(run, name), usable(run, _DURATION).sel(beam_model=_WITHOUT)
    change = values.sel(beam_model=_WITH) / values.sel(beam_model=_WITHOUT) - 1.0
    plain = run.sel(beam_model=_WITHOUT)
    beams = [_beam(plain.isel(beam_depth=at)) for at in range(run.sizes["beam_depth"])]
    share = [
        100.0 * impact_share(beam, duration) if duration > 0 else np.nan
        for beam, duration in zip(beams, durations.values.tolist(), strict=True)
    ]
    return (
        np.array([beam.depth / beam.span for beam in beams]),
        np.array(share),
        100 * change.values,
    )


def _beam(run: xr.Dataset) -> Beam:
    values = {name: float(run[name]) for name in _BEAM if name in run.coords}
    return with_values(paper_impact(), Discretisation(), values)[0].beam


def _draw(ax: Axes, x: Array, y: Array, curve: Choice) -> None:
    """Draw in the order of the depths; a long contact of two pushes may reverse the share."""
    if np.isfinite(x + y).any():
        ax.plot(x, y, label=curve.label or "_only", **curves.marked(curve))


def _finish(ax: Axes) -> None:
    """Scale the axes to the curves, then draw the thresholds."""
    if not ax.lines:
        responses_grid.empty(ax, "no finite values")
        return
    scales.logarithmic(ax, "x", np.concatenate([np.asarray(line.get_xdata()) for line in ax.lines]))
    drawn = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.lines])
    if np.nanmax(abs(drawn)) > _WIDE:
        ax.set_yscale("symlog", linthresh=_THRESHOLD)
        scales.at(ax, "y", _ticks(drawn))
    else:
        scales.linear(ax, "y")
    low, high = min(0.0, np.nanmin(drawn)), max(0.0, np.nanmax(drawn))
    ax.set_ylim(1.3 * low, 1.3 * high)  # from no change on
    for sign in (-1.0, 1.0):
        if (sign * drawn > 0).any():
            ax.axhline(sign * _THRESHOLD, label="_guide", linestyle=(0, (4, 2)), **style.GUIDE)


def _ticks(drawn: Array) -> list[float]:
    """Return zero and 1, 2 and 5 times the powers of ten, within the drawn range."""
    steps = [first * 10.0**power for power in range(4) for first in (1.0, 2.0, 5.0)]
    low, high = min(0.0, np.nanmin(drawn)), max(0.0, np.nanmax(drawn))
    both = [0.0, *steps, *(-step for step in steps)]
    return [tick for tick in sorted(both) if low <= tick <= high]


def _finding(runs: xr.Dataset, name: str) -> str:
    """Return a sentence on the drawn curves: their change, where it matters, and the share."""
    selected = _plan_shear(runs)
    found = [_curve(runs, name, selected.held | curve.where) for curve in selected.curves]
    slenderness, share, change = (np.concatenate(part) for part in zip(*found, strict=True))
    known = np.isfinite(change + share)
    if not known.any():
        return ""
    matters = known & (abs(change) >= _THRESHOLD)
    where = f" (depth over span {_range(slenderness[matters])})" if matters.any() else ""
    return (
        f"The {labels.response(name)} changes by {_range(change[known])} %, by "
        f"{labels.number(_THRESHOLD)} % or more in {matters.sum()} of {known.sum()} "
        f"impacts{where}, while the slowing goes from {_range(share[known])} %."
    )


def _range(values: Array) -> str:
    low, high = labels.number(float(values.min()), 2), labels.number(float(values.max()), 2)
    return low if low == high else f"{low} to {high}"


SHEAR = Figure(
    "shear",
    "When shear matters",
    _shear_applies,
    _plot_shear,
    _shear_caption,
)
