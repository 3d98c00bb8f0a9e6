"""Figures of grids: against the impact velocity, and the effects of parameters and of shear."""

from collections.abc import Callable
from functools import partial

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import offset_copy

from impactlab.figures import access, curves, labels, record, scales, style
from impactlab.figures.access import physical, responses, usable, varied
from impactlab.figures.curves import Plan, plan
from impactlab.figures.data import name_places
from impactlab.figures.labels import Display, display
from impactlab.model.parameters import REFINEMENTS
from impactlab.types import Floats
from impactlab.variables import MARKS

_PEAK, _DURATION, _RESTITUTION = "peak_force", "contact_duration", "restitution"
_FORCE, _INDENTATION, _DENT = "contact_force", "indentation", "permanent_indentation"
_FEWEST = 3  # smallest number of values, of a parameter or of contact laws, for a figure
_OUTSIDE = MARKS["outside_contact_law"][0]
_LEAST_RANGE = 0.05  # of compared values over the largest one, below which the axis is widened
_BESIDE = 1.7  # between the markers of a row, points
_THRESHOLD = 1.0  # changes by shear that matter, %
_WIDE = 10.0  # largest change in % up to which an axis is linear
_WITHOUT, _WITH = "euler_bernoulli", "timoshenko"
_SHEARED = (_PEAK, _DURATION)
_velocity_plan = partial(plan, along=["velocity"], prefer=["contact"])
_plan_shear = partial(plan, variable=_PEAK, along=["beam_depth", "beam_model"])


def _velocity_figure(name: str, title: str, text: str) -> Callable[[record.Drawer], record.Figure]:
    """Make the record of a figure of a response on a grid of at least three velocities."""
    return record.figure(
        title,
        text,
        lambda runs, analysis: name in runs and runs[name].sizes.get("velocity", 0) >= _FEWEST,
        lambda runs, analysis: (
            _velocity_plan(runs, name).note(runs),
            curves.note_measured(analysis, [name], "velocity"),
            access.missing_note(runs, [name]),
        ),
    )


def _against_velocity(
    runs: xr.Dataset, analysis: xr.Dataset, name: str, label: str
) -> tuple[Figure, Axes, Plan]:
    """Draw a curve per contact law, or per value of what else is varied, and measurements."""
    selected = _velocity_plan(runs, name)
    figure, (ax,) = style.panels(1, columns=1, height=62)
    unit = _add_curves(ax, runs, analysis, name, runs["velocity"], selected)
    if not ax.lines:
        style.remark(ax)
    ax.set_xlabel(parameter_axis(runs["velocity"]))
    ax.set_ylabel(labels.axis(label, unit.symbol))
    return figure, ax, selected


def _add_curves(
    ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str, along: xr.DataArray, selected: Plan
) -> Display:
    """Draw the planned curves of a response over a parameter, and measurements; return its unit."""
    valid, across = usable(runs, name), display(along)
    unit, x = display(valid), across(along)
    drawn: list[Floats] = []
    for curve in selected.curves:
        y = unit(valid.isel(curve.where))
        covered = sum(curves.coincide(y, other) for other in drawn)
        curves.add(ax, *curves.broken(x, y), curve, covered=covered)
        drawn.append(y)
    curves.add_measured(ax, analysis, name, str(along.name), across, unit)
    return unit


@_velocity_figure(
    _DURATION,
    "Contact duration against velocity",
    "Duration of the first contact (a later sub-impact does not count) against the impact "
    "velocity. Grey: the slope of Hertz's elastic impact on a half-space. A jump is not joined.",
)
def contact_duration(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw on logarithmic axes, as durations follow powers of the velocity, with a guide."""
    figure, ax, selected = _against_velocity(
        runs, analysis, _DURATION, "duration of the first contact"
    )
    values, speed = scales.drawn(ax, "y"), runs["velocity"].values
    if values.size:
        scales.logarithmic(ax, "x", speed)
        scales.logarithmic(ax, "y", values)
        ends = np.array([speed.min(), speed.max()])
        guide = np.nanmax(values) * (ends / ends[0]) ** -0.2 * 1.08
        ax.plot(ends, guide, label="_guide: slope −1/5", linestyle="-", **style.GUIDE)
    return selected.finish(figure)


@_velocity_figure(
    _RESTITUTION,
    "Restitution against velocity",
    "Coefficient of restitution, the sphere's rebound velocity over its impact velocity, "
    "against the impact velocity. But for the weight, it is the impulse of all contacts over the "
    "sphere's momentum, less one. That of the first contact changes smoothly; what later contacts "
    "add depends on the phase of the vibrating beam that they meet, which neighbouring velocities "
    "do not share. Such a zigzag is not joined.",
)
def restitution_velocity(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw with an axis that holds zero and one."""
    label = labels.response(_RESTITUTION)
    figure, ax, selected = _against_velocity(runs, analysis, _RESTITUTION, label)
    if ax.lines:
        scales.fit(ax, "x", runs["velocity"].values)
        scales.linear(ax, "y")
        ax.set_ylim(min(0.0, ax.get_ylim()[0]), max(1.0, ax.get_ylim()[1]))
    return selected.finish(figure)


def _law_variables(runs: xr.Dataset) -> list[str]:
    """Return what a figure of contact laws can show: histories, then responses."""
    histories = [_FORCE] if _FORCE in runs and _INDENTATION in runs else []
    return histories + [name for name in (_RESTITUTION, _DENT) if name in runs]


def _plan_laws(runs: xr.Dataset) -> Plan:
    """Plan a curve for every law."""
    return _velocity_plan(runs, "status", most=runs.sizes["contact"])


def _law_sentences(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    names, velocity = _law_variables(runs), runs["velocity"]
    middle = labels.value(velocity, velocity.size // 2)
    beyond = bool(((runs["status"] & _OUTSIDE) != 0).any())
    return [
        f"Force against indentation at {middle}, while in contact." if _FORCE in names else "",
        "Permanent indentations of zero or below are not shown." if _DENT in names else "",
        "Open markers: beyond the range of the law." if beyond else "",
        _plan_laws(runs).note(runs),
        curves.note_measured(analysis, names, "velocity"),
        access.missing_note(runs, names),
    ]


@record.figure(
    "Contact laws side by side",
    "",
    lambda runs, analysis: (
        all(runs.sizes.get(dim, 0) >= _FEWEST for dim in ("contact", "velocity"))
        and bool(_law_variables(runs))
    ),
    _law_sentences,
)
def contact_laws(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a panel of histories and one per response, with a colour per law."""
    selected, names = _plan_laws(runs), _law_variables(runs)
    figure, axes = style.panels(len(names), columns=max(len(names), 2), height=62)
    for ax, name in zip(axes, names, strict=True):
        if name == _FORCE:
            _law_forces(ax, runs, selected)
        else:
            _law_responses(ax, runs, analysis, name, selected)
    return selected.finish(figure)


def _law_forces(ax: Axes, runs: xr.Dataset, selected: Plan) -> None:
    """Draw force against indentation at the middle velocity."""
    force, depth = display(runs[_FORCE]), display(runs[_INDENTATION])
    valid = runs.assign({_FORCE: usable(runs, _FORCE)})
    middle = {"velocity": runs.sizes["velocity"] // 2}
    for curve in selected.curves:
        run = valid.isel(curve.where | middle)
        run = run.isel(time=run[_FORCE].values > 0)
        curves.add(ax, depth(run[_INDENTATION]), force(run[_FORCE]), curve, markers=False)
    ax.set_xlabel(labels.axis("indentation", depth.symbol))
    ax.set_ylabel(labels.axis("contact force", force.symbol))
    if ax.lines:
        scales.linear(ax, "xy")
        ax.set(xlim=(0.0, None), ylim=(0.0, None))
    else:
        style.empty(ax)


def _law_responses(
    ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str, selected: Plan
) -> None:
    """Draw a response against the velocity, with open markers beyond the range of a law."""
    values, label = style.in_display_units(runs, name)
    speed = runs["velocity"].values
    for curve in selected.curves:
        y = values.isel(curve.where).values
        if curves.add(ax, speed, y, curve):
            outside = (runs["status"].isel(curve.where).values & _OUTSIDE) != 0
            hollow = {"linestyle": "", "markerfacecolor": "white", "label": "_open"}
            ax.plot(speed[outside], y[outside], **(curves.look(curve, markers=True) | hollow))
    unit = display(usable(runs, name))
    curves.add_measured(ax, analysis, name, "velocity", display(runs["velocity"]), unit)
    ax.set(xlabel=labels.axis("velocity", "m/s"), ylabel=label)
    if not ax.lines:
        style.empty(ax)
        return
    scales.fit(ax, "x", speed)
    # dents span decades, and those of zero (Hertz) or below (some laws, just beyond yield) do not
    # matter beside the others
    (scales.logarithmic if name == _DENT else scales.fit)(ax, "y", scales.drawn(ax, "y"))


def _along(runs: xr.Dataset) -> str | None:
    """Return the first physical parameter with enough values to draw a curve."""
    return next((name for name in physical(runs) if runs.sizes.get(name, 0) >= _FEWEST), None)


def _plan_effects(runs: xr.Dataset) -> Plan:
    parameters = [name for name in physical(runs) if name != _along(runs)]
    return plan(runs, responses(runs)[0], along=[str(_along(runs))], prefer=parameters)


@record.figure(
    "Effect of the varied parameters",
    "",
    lambda runs, analysis: _along(runs) is not None and bool(responses(runs)),
    lambda runs, analysis: (
        f"Responses against the {labels.parameter(runs[_along(runs)])}. Rings: curves that "
        "coincide with those of the markers inside. Neither a jump nor a zigzag is joined.",
        _plan_effects(runs).note(runs),
        curves.note_measured(analysis, responses(runs), str(_along(runs))),
        access.missing_note(runs, responses(runs)),
    ),
)
def parameter_effects(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a panel per response: colours by the second parameter, line styles by the third."""
    along, selected = runs[_along(runs)], _plan_effects(runs)
    figure, axes = style.response_panels(responses(runs), height=38)
    for name, ax in axes.items():
        ax.set_title(response_curves(ax, runs, analysis, name, along, selected), loc="left")
    return selected.finish(figure, parameter_axis(along))


def _compared(runs: xr.Dataset) -> str | None:
    """Return the first parameter of several values, words first, where none has a curve.

    None for samples and where a grid is refined: those have figures of their own.
    """
    several = [dim for dim in varied(runs) if runs.sizes.get(dim, 0) > 1]
    if access.is_sample(runs) or _along(runs) is not None or REFINEMENTS.keys() & {*several}:
        return None
    return min(several, key=lambda dim: runs[dim].dtype.kind in "if", default=None)


def _plan_compared(runs: xr.Dataset) -> Plan:
    return plan(runs, responses(runs)[0], along=[str(_compared(runs))])


@record.figure(
    "Responses side by side",
    "",
    lambda runs, analysis: _compared(runs) is not None and bool(responses(runs)),
    lambda runs, analysis: (
        f"Responses by {labels.parameter(runs[_compared(runs)])}.",
        _plan_compared(runs).note(runs),
        access.missing_note(runs, responses(runs)),
    ),
)
def compared_values(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a panel per response, a row per word or number, colours by the second parameter."""
    compared, selected = runs[_compared(runs)], _plan_compared(runs)
    rows = np.arange(compared.size, dtype=float)
    figure, axes = style.response_panels(responses(runs), height=16.0 + 4.0 * compared.size)
    for name, ax in axes.items():
        values, label = style.in_display_units(runs, name)
        for number, curve in enumerate(selected.curves):
            if curves.add(ax, values.isel(curve.where).values, rows, curve):
                ax.lines[-1].set_linestyle("none")  # nothing lies between
                down = (number - 0.5 * (len(selected.curves) - 1)) * _BESIDE
                ax.lines[-1].set_transform(offset_copy(ax.transData, figure, 0.0, -down, "points"))
        name_places(ax, "y", [labels.brief(compared, row) for row in range(compared.size)])
        ax.set_ylim(compared.size - 0.5, -0.5)
        ax.tick_params(labelleft=style.starts_row(ax))
        ax.set_title(label, loc="left")
        _show_differences(ax)
    return selected.finish(figure)


def _show_differences(ax: Axes) -> None:
    """Scale the axis of the values so that small differences look as small as they are."""
    if not ax.lines:
        style.empty(ax)
        return
    points = scales.drawn(ax, "x")
    scales.fit(ax, "x", points)
    low, high = np.nanmin(points), np.nanmax(points)
    if high - low < _LEAST_RANGE * abs(high):
        ax.set_xlim(low - _LEAST_RANGE * abs(high), high + _LEAST_RANGE * abs(high))


def response_curves(
    ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str, along: xr.DataArray, selected: Plan
) -> str:
    """Draw the planned curves of a response over a parameter, and measurements of it.

    Returns the response's label.
    """
    unit = _add_curves(ax, runs, analysis, name, along, selected)
    scales.fit(ax, "x", display(along)(along))
    scales.fit(ax, "y", scales.drawn(ax, "y"))
    if not ax.lines:
        style.empty(ax)
    return labels.axis(labels.response(name), unit.symbol)


def parameter_axis(along: xr.DataArray) -> str:
    """Return the label of an axis of a parameter."""
    return labels.axis(labels.parameter(along), display(along).symbol)


@record.figure(
    "When shear matters",
    "Relative change by shear and rotary inertia: a Timoshenko beam over an Euler-Bernoulli "
    "one, minus one. Below, the same changes against depth over contact "
    "duration, with which shear and rotary inertia slow the wave that turns by π during the "
    "contact: if that decided alone, the curves of one material would coincide.",
    lambda runs, analysis: (
        runs.sizes.get("beam_depth", 0) >= _FEWEST
        and {_WITHOUT, _WITH} <= set(runs.get("beam_model", xr.DataArray()).values.ravel())
        and all(name in runs for name in _SHEARED)
    ),
    lambda runs, analysis: (
        *(_shear_finding(runs, name) for name in _SHEARED),
        _plan_shear(runs).note(runs),
        access.missing_note(runs, _SHEARED),
    ),
)
def shear(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a column per response: against depth over span above, over contact duration below."""
    selected = _plan_shear(runs)
    figure, axes = style.panels(4, columns=2, height=55)
    for column, name in enumerate(_SHEARED):
        above, below = axes[column], axes[column + 2]
        for curve in selected.curves:  # joined by depth: two pushes may reverse the pace
            slenderness, pace, change = _shear_curve(runs, name, curve.where)
            curves.add(above, slenderness, change, curve)
            curves.add(below, pace, change, curve)
        for ax in (above, below):
            ax.set_ylabel(labels.axis(f"change of {labels.response(name)}", "%"))
            _scale_changes(ax)
        above.set_xlabel(labels.axis("depth of the beam over its span", ""))
        below.set_xlabel(labels.axis("depth of the beam over contact duration", "m/s"))
    return selected.finish(figure)


def _shear_curve(
    runs: xr.Dataset, name: str, where: dict[str, int]
) -> tuple[Floats, Floats, Floats]:
    """Return depth over span, depth over contact duration (m/s, NaN without one), change in %."""
    run = runs.isel(where)
    depth = run["beam_depth"]
    values, durations = usable(run, name), usable(run, _DURATION).sel(beam_model=_WITHOUT)
    change = values.sel(beam_model=_WITH) / values.sel(beam_model=_WITHOUT) - 1.0
    pace = depth / durations.where(durations > 0)
    return (depth / run["beam_span"]).values, pace.values, 100 * change.values


def _scale_changes(ax: Axes) -> None:
    """Scale the axes to the curves, then draw the thresholds."""
    if not ax.lines:
        style.empty(ax)
        return
    scales.logarithmic(ax, "x", scales.drawn(ax, "x"))
    changes = scales.drawn(ax, "y")
    low, high = min(0.0, np.nanmin(changes)), max(0.0, np.nanmax(changes))
    if np.nanmax(abs(changes)) > _WIDE:
        ax.set_yscale("symlog", linthresh=_THRESHOLD)
        steps = [first * 10.0**power for power in range(4) for first in (1.0, 2.0, 5.0)]
        ticks = sorted([0.0, *steps, *(-step for step in steps)])
        scales.at(ax, "y", [tick for tick in ticks if low <= tick <= high])
    else:
        scales.linear(ax, "y")
    ax.set_ylim(1.3 * low, 1.3 * high)  # from no change on
    for sign in (-1.0, 1.0):
        if (sign * changes > 0).any():
            ax.axhline(
                sign * _THRESHOLD, label="_guide: ±1 %", linestyle=(0, (4, 2)), **style.GUIDE
            )


def _shear_finding(runs: xr.Dataset, name: str) -> str:
    """Return a sentence on the drawn curves: their change, where it matters, and the pace."""
    selected = _plan_shear(runs)
    series = [_shear_curve(runs, name, curve.where) for curve in selected.curves]
    slenderness, pace, change = (np.concatenate(part) for part in zip(*series, strict=True))
    finite = np.isfinite(change + pace)
    if not finite.any():
        return ""
    matters = finite & (abs(change) >= _THRESHOLD)
    deep = f" (depth over span {labels.span(slenderness[matters], 2)})" if matters.any() else ""
    return (
        f"The {labels.response(name)} changes by {labels.span(change[finite], 2)} %, by "
        f"{labels.number(_THRESHOLD)} % or more in {matters.sum()} of {finite.sum()} "
        f"impacts{deep}, while depth over duration goes from {labels.span(pace[finite], 2)} m/s."
    )
