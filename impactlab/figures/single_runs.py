"""Figures of single runs: histories of force and displacement, and profiles of plastic strain."""

import math
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, curves, labels, record, scales, style
from impactlab.figures.access import usable
from impactlab.figures.curves import Plan, Selection, plan
from impactlab.figures.labels import Display, display
from impactlab.files import replaced
from impactlab.types import Floats

_FORCE, _INDENTATION = "contact_force", "indentation"
_TIME = "time since first touch"
_COLUMNS = 4  # largest number of force histories side by side
_plan_by_law = partial(plan, variable=_FORCE, panel="velocity", prefer=["contact"])
_WIDE = 3  # largest number of contact laws whose displacements fit side by side
_DISPLACEMENTS = {
    "sphere_displacement": "sphere",
    "midspan_deflection": "beam under the sphere",
    "indentation": "indentation",
}
_STRAIN = "equivalent_plastic_strain"
_LOWEST = 1e-3  # smallest strain on an axis, in %
_PAPER_LIMIT = 0.2  # the plastic strain that the paper compares with, in %


def _force_sentences(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, str]:
    return curves.note(runs, _FORCE), access.missing_note(runs, [_FORCE])


@record.figure(
    "Contact force during the first contact",
    "Contact force from first touch to the end of the longest first contact.",
    lambda runs, analysis: _FORCE in runs,
    _force_sentences,
)
def first_contact(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a curve per run, up to the end of the longest first contact."""
    force, time = display(runs[_FORCE]), display(runs["time"])
    across, up = labels.axis(_TIME, time.symbol), labels.axis("contact force", force.symbol)
    figure, axes, selected = curves.draw(
        runs, _FORCE, lambda run: (time(run["time"]), force(run[_FORCE])), across, up
    )
    end = 0.0
    for line in (line for ax in axes for line in ax.lines):
        x, y = (np.asarray(values, dtype=float) for values in line.get_data())
        outside = np.flatnonzero(y[1:] <= 0)
        end = max(end, float(x[outside[0] + 1 if outside.size else -1]))
    for ax in axes:
        scales.linear(ax, "xy")
        ax.set(xlim=(0.0, 1.05 * end or None), ylim=(0.0, None))
    return selected.finish(figure)


@record.figure(
    "Contact force against time",
    "Contact force from first touch to the end of the last contact; each panel has scales of its "
    "own, and a peak after a gap is a sub-impact.",
    lambda runs, analysis: _FORCE in runs,
    _force_sentences,
)
def force_history(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a panel per run, as sub-impacts would hide each other; a row or more per velocity."""
    selected, force = curves.chosen(runs, _FORCE), usable(runs, _FORCE)
    time, unit = display(runs["time"]), display(runs[_FORCE])
    laws = len(selected.panels)
    columns = math.ceil(laws / math.ceil(laws / _COLUMNS))
    height = 32.0 if laws * len(selected.curves) <= 3 * columns else 24.0
    figure, panels = _panel_per_run(selected, columns, height, sharex=False)
    x = time(runs["time"])
    for ax, where, curve in panels:
        scales.linear(ax, "x", ticks=4)
        scales.linear(ax, "y", ticks=3)
        y = unit(force.isel(where))
        if np.isfinite(y).any():
            look = curves.look(curve) | {"linestyle": "-", "linewidth": 0.9}
            ax.plot(x, y, label=curve.label or "_only", **look)
            ax.fill_between(x, y, color=look["color"], alpha=0.3, linewidth=0.0)
            end = float(x.max(initial=0.0, where=y > 0))
            ax.set(xlim=(0.0, 1.05 * end or None), ylim=(0.0, None))
        else:
            style.remark(ax)
    figure.supylabel(labels.axis("contact force", unit.symbol))
    figure.supxlabel(labels.axis(_TIME, time.symbol))
    return figure


def _panel_per_run(
    selected: Plan, columns: int, height: float, *, sharex: bool
) -> tuple[Figure, list[tuple[Axes, dict[str, int], Selection]]]:
    """Return a figure and, for each chosen run, its panel, its place among the runs, its curve."""
    shown = [(panel, curve) for curve in selected.curves for panel in selected.panels]
    titles = [
        ", ".join(filter(None, (labels.sentence(panel.label), curve.label)))
        for panel, curve in shown
    ]
    figure, axes = style.titled_panels(titles, columns=columns, height=height, sharex=sharex)
    places = [(panel.where | curve.where, curve) for panel, curve in shown]
    return figure, [(ax, *place) for ax, place in zip(axes, places, strict=True)]


@record.figure(
    "Displacements against time",
    "Displacement of the sphere since first touch, deflection of the beam under it, and "
    "their difference, the indentation (below zero: the two are apart); downwards is positive. "
    "The sphere's flight after its last contact is cut off where it would hide the rest.",
    lambda runs, analysis: (
        all(name in runs for name in _DISPLACEMENTS)
        and len(curves.chosen(runs, "sphere_displacement").panels) <= _WIDE
    ),
    lambda runs, analysis: (
        curves.note(runs, "sphere_displacement"),
        access.missing_note(runs, list(_DISPLACEMENTS)),
    ),
)
def displacement_history(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a panel per run, in a column per contact law."""
    selected = curves.chosen(runs, "sphere_displacement")
    laws = len(selected.panels)
    columns = laws if laws > 1 else min(len(selected.curves), 2)
    figure, panels = _panel_per_run(selected, columns, height=45, sharex=True)
    time, unit = display(runs["time"]), display(runs["midspan_deflection"])
    x = time(runs["time"])
    for ax, where, _ in panels:
        scales.linear(ax, "xy")
        for number, (name, label) in enumerate(_DISPLACEMENTS.items()):
            y = unit(usable(runs, name).isel(where))
            if np.isfinite(y).any():
                ax.plot(
                    x, y, label=label, color=style.COLOURS[number], linestyle=style.LINES[number]
                )
        if ax.lines:
            ax.set_xlim(0.0, float(x[-1]))
            ax.set_ylim(_until_flight(runs.isel(where), unit))
            ax.axhline(0.0, label="_guide", linestyle="-", **style.GUIDE)
        else:
            style.remark(ax)
    across, up = labels.axis(_TIME, time.symbol), labels.axis("displacement", unit.symbol)
    return style.finish(figure, across, up, order=list(_DISPLACEMENTS.values()))


def _until_flight(run: xr.Dataset, unit: Display) -> tuple[float, float]:
    """Return limits that hold the beam's motion, and the sphere's up to its last contact."""
    beam, sphere, depth = (
        unit(run[name]) for name in ("midspan_deflection", "sphere_displacement", "indentation")
    )
    touching = np.flatnonzero(depth > 0)
    end = int(touching[-1]) + 1 if touching.size else 1
    held = np.concatenate([beam, sphere[:end], depth[:end]])
    low, high = float(np.nanmin(held)), float(np.nanmax(held))
    room = 0.08 * (high - low) or 1.0
    return low - room, high + room


@record.figure(
    "Contact force against indentation",
    "Contact force against indentation while in contact; each sub-impact is a loop of its "
    "own, and the area inside is the energy dissipated in the contact.",
    lambda runs, analysis: _FORCE in runs and _INDENTATION in runs,
    _force_sentences,
)
def force_indentation(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a curve per run, broken where sphere and beam are apart."""
    force, depth = display(runs[_FORCE]), display(runs[_INDENTATION])
    across = labels.axis("indentation", depth.symbol)
    up = labels.axis("contact force", force.symbol)
    line = partial(_loop, depth=depth, force=force)
    figure, axes, selected = curves.draw(runs, _FORCE, line, across, up)
    for ax in axes:
        scales.linear(ax, "xy")
        ax.set(xlim=(0.0, None), ylim=(0.0, None))
    return selected.finish(figure)


def _loop(run: xr.Dataset, depth: Display, force: Display) -> tuple[Floats, Floats]:
    """Return indentation and force of one run in display units, NaN where the two are apart."""
    values = run[_FORCE].values
    inside = values > 0  # and one sample to either side, so that loops reach the axis
    before, after = np.roll(inside, -1), np.roll(inside, 1)
    before[-1] = after[0] = False
    touching = inside | before | after
    return depth(run[_INDENTATION].where(touching)), force(np.where(touching, values, np.nan))


@record.figure(
    "Contact force against indentation under each contact law",
    "Contact force against indentation while in contact, each panel on scales of its own; the "
    "area inside a loop is the energy dissipated in the contact.",
    lambda runs, analysis: (
        _FORCE in runs
        and _INDENTATION in runs
        and all(runs[_FORCE].sizes.get(dim, 0) > 1 for dim in ("contact", "velocity"))
    ),
    lambda runs, analysis: (_plan_by_law(runs).note(runs), access.missing_note(runs, [_FORCE])),
)
def force_indentation_by_law(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a curve per contact law, broken where sphere and beam are apart."""
    selected, valid = _plan_by_law(runs), runs.assign({_FORCE: usable(runs, _FORCE)})
    force, depth = display(runs[_FORCE]), display(runs[_INDENTATION])
    count = len(selected.panels)
    figure, axes = style.panels(count, columns=min(count, 2), height=58)
    for ax, panel in zip(axes, selected.panels, strict=True):
        ax.set_title(f"At {panel.label}", loc="left")
        for curve in selected.curves:
            run = valid.isel(panel.where | curve.where)
            curves.add(ax, *_loop(run, depth, force), curve, markers=False)
        scales.linear(ax, "xy")
        if ax.lines:
            ax.set(xlim=(0.0, None), ylim=(0.0, None))
        else:
            style.remark(ax)
    across = labels.axis("indentation", depth.symbol)
    return selected.finish(figure, across, labels.axis("contact force", force.symbol))


def _largest(runs: xr.Dataset) -> xr.DataArray:
    """Return the largest PEEQ of each run."""
    return usable(runs, _STRAIN).max(["x", "z"])


def _plastic(runs: xr.Dataset) -> xr.Dataset:
    """Return the runs at the velocities with a plastic strain in some run; all if none has."""
    if "velocity" not in runs[_STRAIN].dims:
        return runs
    yielded = _largest(runs) > 0
    velocities = yielded.any([dim for dim in yielded.dims if dim != "velocity"])
    return runs.isel(velocity=velocities.values.nonzero()[0]) if bool(velocities.any()) else runs


def _elastic(runs: xr.Dataset) -> str:
    """Return a sentence on the velocities at which no run with a result has a plastic strain."""
    largest = _largest(runs)
    if "velocity" not in largest.dims:
        return "" if bool((largest > 0).any()) else "No fibre yields in these runs."
    rest = [dim for dim in largest.dims if dim != "velocity"]
    none = (~(largest > 0)).all(rest) & largest.notnull().any(rest)
    if not bool(none.any()):
        return ""
    where = none.values.nonzero()[0].tolist()
    return f"No fibre yields at {labels.setting(runs['velocity'], where)}."


def _strain_sentences(runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, str, str]:
    shown = curves.note(_plastic(runs), _STRAIN)
    return shown, _elastic(runs), access.missing_note(runs, [_STRAIN])


@record.figure(
    "Equivalent plastic strain along the beam",
    "Equivalent plastic strain (PEEQ) along the beam at the end of the run, the largest over "
    "the depth at each place.",
    lambda runs, analysis: _STRAIN in runs,
    _strain_sentences,
)
def plastic_strain(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a curve per run; zeros, which a logarithmic axis cannot show, leave a gap."""
    plastic = _plastic(runs)
    strain, place = display(plastic[_STRAIN]), display(plastic["x"])

    def line(run: xr.Dataset) -> tuple[Floats, Floats]:
        largest = run[_STRAIN].max("z").dropna("x")
        return place(largest["x"]), strain(largest.where(largest > 0))

    along = labels.axis("distance from the left end", place.symbol)
    figure, axes, selected = curves.draw(plastic, _STRAIN, line, along, labels.axis("PEEQ", "%"))
    for ax in axes:
        values = scales.drawn(ax, "y")
        scales.linear(ax, "x")
        if np.isfinite(values).any():
            top = 2 * max(float(np.nanmax(values)), _PAPER_LIMIT)
            scales.logarithmic(ax, "y", [_LOWEST, top])
            ax.set_ylim(_LOWEST, top)
        elif ax.lines:
            style.remark(ax, "no plastic strain")
        struck = plastic["beam_span"] * plastic.get("strike_position", 0.5)
        if not plastic["beam_depth"].ndim and not struck.ndim:
            middle, depth = float(struck), float(plastic["beam_depth"])
            for mark in (middle - depth, middle + depth):
                label = "_guide: one beam depth from the impact"
                ax.axvline(place.scale * mark, linestyle=":", label=label, **style.GUIDE)
        label = f"_guide: {_PAPER_LIMIT} %, the paper's limit"
        ax.axhline(_PAPER_LIMIT, linestyle="--", label=label, **style.GUIDE)
    return selected.finish(figure)


@record.figure(
    "Equivalent plastic strain over the depth",
    "Equivalent plastic strain (PEEQ) over the depth in the section that it is largest in, at "
    "the end of the run; a marker is an integration point; "
    "zeros have no place on the logarithmic axis.",
    lambda runs, analysis: _STRAIN in runs,
    _strain_sentences,
)
def plastic_strain_depth(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a curve per run, the depth downwards as in the beam."""
    plastic = _plastic(runs)
    strain, depth = display(plastic[_STRAIN]), display(plastic["z"])

    def line(run: xr.Dataset) -> tuple[Floats, Floats]:
        section = run[_STRAIN].isel(x=int(np.argmax(run[_STRAIN].max("z").fillna(-1.0).values)))
        return scales.positive(strain(section)), depth(section["z"])

    across = labels.axis("PEEQ", strain.symbol)
    down = labels.axis("distance below the axis", depth.symbol)
    figure, axes, selected = curves.draw(plastic, _STRAIN, line, across, down, markers=True)
    for ax in axes:
        values = scales.drawn(ax, "x")
        if np.isfinite(values).any():
            limits = _LOWEST, 2.0 * float(np.nanmax(values))
            scales.logarithmic(ax, "x", limits)
            ax.set_xlim(limits)
        elif ax.lines:
            style.remark(ax, "no plastic strain")
        scales.linear(ax, "y")
    axes[0].set_ylim(*sorted(axes[0].get_ylim(), reverse=True))
    return selected.finish(figure)


def save_picture(run: xr.Dataset, path: Path) -> None:
    """Draw a run of impactlab.simulate into a file, of the format that its name ends in."""
    figure = picture(run)
    with style.applied(), replaced(path) as unfinished:
        figure.savefig(unfinished, format=path.suffix[1:])


@style.paper
def picture(run: xr.Dataset) -> Figure:
    """Return the picture of a run of impactlab.simulate, of four panels."""
    figure, (force, motion, loop, beam) = style.panels(4, columns=2, height=52)
    _draw_over(force, run, "time", ["contact_force"], "contact force")
    peak, time = run["peak_force"], run["time_of_peak_force"]
    if np.isfinite(peak):
        place = display(run["time"])(time).item(), display(run["contact_force"])(peak).item()
        force.annotate(f"  {_quantity(peak)} at {_quantity(time)}", place, va="top")
    _draw_over(motion, run, "time", list(_DISPLACEMENTS)[:2], "displacement down")
    motion.legend()
    touching = run.where(run["contact_force"] > 0)
    _draw_over(loop, touching, "indentation", ["contact_force"], "contact force")
    strain = run["equivalent_plastic_strain"].max("z", keep_attrs=True)
    if bool((strain > 0).any()):
        _draw_over(beam, run.assign(plastic_strain=strain), "x", ["plastic_strain"], "largest PEEQ")
    else:
        _draw_over(beam, run, "x", ["deflection"], "deflection at the end")
        beam.invert_yaxis()
    for axes in (force, loop):
        axes.set(xlim=(0.0, None), ylim=(0.0, None))
    case = f"Sphere of {_quantity(run['sphere_radius'])} radius at {_quantity(run['velocity'])}"
    phrases = {"contact_duration": "first contact", "restitution": "restitution"}
    answers = [f"{text} {_quantity(run[name])}" for name, text in phrases.items() if run[name] >= 0]
    title = ": ".join(filter(None, (case, ", ".join(answers))))
    figure.suptitle(title, x=0.01, ha="left", fontsize=9)
    return figure


def _draw_over(axes: Axes, run: xr.Dataset, across: str, names: list[str], text: str) -> None:
    """Draw variables over another one, in the units of papers; contact ends where force does."""
    largest = max(names, key=lambda name: float(np.abs(run[name]).max()))
    x, y = display(run[across]), display(run[largest])
    for name, color in zip(names, style.COLOURS, strict=False):
        axes.plot(x(run[across]), y(run[name]), color=color, label=_DISPLACEMENTS.get(name))
    quantity = str(run[across].attrs["long_name"]).partition(" (")[0]
    axes.set_xlabel(labels.axis(quantity, x.symbol))
    axes.set_ylabel(labels.axis(text, y.symbol))
    scales.linear(axes, "xy")
    axes.margins(x=0.0)


def _quantity(scalar: xr.DataArray) -> str:
    unit = display(scalar)
    return f"{labels.number(unit(scalar).item(), 3)} {unit.symbol}".rstrip()
