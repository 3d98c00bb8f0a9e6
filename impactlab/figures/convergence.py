"""Figures of convergence in space, time and integration points, and of its cost."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as MplFigure

from impactlab.figures import access, curves, labels, refinement, responses_grid, scales, style
from impactlab.figures.access import known, responses
from impactlab.figures.curves import Plan, plan
from impactlab.figures.labels import display
from impactlab.figures.record import Figure
from impactlab.model.cost import node_steps
from impactlab.model.impact import SOLID
from impactlab.model.parameters import ELEMENTS
from impactlab.solver import BEAM_MODELS, SCHEMES

_NODES = refinement.Refined("nodes", "nodes", ("velocity", "points"))
_TIME_STEP = refinement.Refined("time_step", "courant", ("scheme", "nodes", "velocity"))
_POINTS_TOLERANCE = 1.0
"""Error that the analysis asks for, in %."""
_COST = refinement.Refined("nodes", "nodes", ("scheme", "courant", "velocity"), most=6)
_INPUTS = (
    "beam_span",
    "beam_depth",
    "beam_density",
    "beam_youngs_modulus",
    "beam_model",
    "scheme",
    "nodes",
    "courant",
    "duration",
)
_COST_TOLERANCE = 0.01


def _nodes_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the grid has at least three numbers of nodes."""
    return _NODES.applies(runs)


def _nodes_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        f"{refinement.CAPTION} {_NODES.plan(runs).note(runs)} "
        f"{access.missing_note(runs, _NODES.names(runs))}".strip()
    )


@style.paper
def _plot_nodes(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response, a curve for each of a few other settings."""
    return refinement.draw(runs, analysis, _NODES, *_spacing(runs))


def _spacing(runs: xr.Dataset) -> tuple[refinement.Array, str]:
    """Return the spacing of the nodes and its label; over the span where that is varied."""
    relative = 1.0 / (runs["nodes"].values - 1.0)
    if runs["beam_span"].ndim:
        return relative, "Spacing of the nodes over the span (–)"
    spacing = (runs["beam_span"] * xr.DataArray(relative)).assign_attrs(units="m").rename("spacing")
    unit = display(spacing)
    return unit(spacing), labels.axis("spacing of the nodes", unit.symbol)


NODES = Figure(
    "nodes_convergence",
    "Convergence in nodes",
    _nodes_applies,
    _plot_nodes,
    _nodes_caption,
)


def _time_step_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the grid has at least three values of courant."""
    return _TIME_STEP.applies(runs)


def _time_step_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "The nodes of a curve stay the same: its limit is the answer of these nodes. "
        f"{refinement.CAPTION} {_TIME_STEP.plan(runs).note(runs)} "
        f"{access.missing_note(runs, _TIME_STEP.names(runs))}".strip()
    )


@style.paper
def _plot_time_step(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response, a curve for each of a few other settings."""
    label = labels.axis(labels.parameter("courant"), "")
    return refinement.draw(runs, analysis, _TIME_STEP, runs["courant"].values.astype(float), label)


TIME_STEP = Figure(
    "time_step_convergence",
    "Convergence in the time step",
    _time_step_applies,
    _plot_time_step,
    _time_step_caption,
)


def _element_size_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the grid has at least three sizes of solid elements."""
    return _element_axis(runs).applies(runs) and SOLID in runs["beam_model"].values


def _element_size_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    chosen, axis = _solid(runs), _element_axis(runs)
    return (
        "Three-dimensional model alone; elements beyond the contact keep their largest size. "
        f"{refinement.CAPTION} {axis.plan(chosen).note(chosen)} "
        f"{access.missing_note(runs, axis.names(chosen))}".strip()
    )


@style.paper
def _plot_element_size(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response, a curve for each of a few other settings."""
    axis = _element_axis(runs)
    values = runs[axis.dim].values
    if axis.dim == "element_size":
        unit = display(runs[axis.dim])
        sizes, label = unit(values), labels.axis("element size", unit.symbol)
    else:
        sizes = np.round(100.0 / values, 1)
        label = labels.axis("element size over expected contact radius", "%")
    return refinement.draw(_solid(runs), _solid(analysis), axis, sizes, label)


def _element_axis(runs: xr.Dataset) -> refinement.Refined:
    dim = next((name for name in ELEMENTS if name in runs.dims), ELEMENTS[0])
    return refinement.Refined("element_size", dim, ("velocity", "beam_yield_stress"))


def _solid(dataset: xr.Dataset) -> xr.Dataset:
    """Return the runs of the 3-D model, which do not depend on the nodes."""
    if "beam_model" in dataset.dims:
        dataset = dataset.sel(beam_model=SOLID)
    return dataset.isel(nodes=0) if "nodes" in dataset.dims else dataset


ELEMENT_SIZE = Figure(
    "element_size_convergence",
    "Convergence in the size of the solid elements",
    _element_size_applies,
    _plot_element_size,
    _element_size_caption,
)


def _points_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the analysis has errors in points, for responses of these runs."""
    return (
        "points_error" in analysis and "points" in runs.dims and bool(_points_names(runs, analysis))
    )


def _points_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    names = _points_names(runs, analysis)
    return (
        "Difference to the value with the most integration points over the depth (which is left "
        f"out, being its own reference), relative to it. Grey: {_POINTS_TOLERANCE:g} %. A verdict "
        "is the worst over the whole grid, also over what is not drawn. "
        f"{_plan_points(runs, names).note(runs)} {access.missing_note(runs, names)}".strip()
    )


@style.paper
def _plot_points(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response, a curve per rule (and velocity)."""
    names = _points_names(runs, analysis)
    selected, points = _plan_points(runs, names), analysis["points"].values
    figure, axes = responses_grid.panels(names, height=40)
    for name, ax in axes.items():
        responses_grid.write_verdict(ax, analysis, "points_summary", name)
        error = 100.0 * abs(analysis["points_error"].sel(response=name)).transpose("points", ...)
        for curve in selected.curves:
            values = scales.positive(
                error.isel(selected.held | curve.where), above=100 * responses_grid.ROUND_OFF
            )
            if np.isfinite(values).any():
                ax.plot(points, values, label=curve.label or "_only", **curves.marked(curve))
        _finish_points(ax, points, error)
    figure.supxlabel(labels.axis(labels.parameter("points"), ""))
    figure.supylabel("Error (%)")
    style.legend(figure, selected.title(), selected.labels())
    return figure


def _points_names(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    named = (name for name in responses(runs) if known(analysis, name))
    return [name for name in named if "points" in runs[name].dims]


def _plan_points(runs: xr.Dataset, names: list[str]) -> Plan:
    return plan(runs, names[0], along=["points"], prefer=["rule", "velocity"])


def _finish_points(ax: Axes, points: np.ndarray, error: xr.DataArray) -> None:
    """Scale the axes: ticks at the numbers of points, logarithmic errors."""
    if not ax.lines:
        enough = bool((error.count("points") > 1).any())
        responses_grid.empty(ax, "same for every number" if enough else "too few values")
        return
    drawn = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in ax.lines])
    scales.logarithmic(ax, "x", points)
    scales.at(ax, "x", points)
    scales.logarithmic(ax, "y", [*drawn, _POINTS_TOLERANCE])
    ax.set_xlim(0.9 * points.min(), 1.1 * points.max())
    ax.axhline(_POINTS_TOLERANCE, label="_guide", linestyle="--", **style.GUIDE)


POINTS = Figure(
    "points_convergence",
    "Convergence in integration points",
    _points_applies,
    _plot_points,
    _points_caption,
)


def _cost_applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Return whether the nodes are refined and all runs are of beams whose cost is known."""
    known = _COST.applies(runs) and all(name in runs.coords for name in _INPUTS)
    return known and set(np.ravel(runs["beam_model"].values).tolist()) <= set(BEAM_MODELS)


def _cost_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "Difference to the limit at zero spacing (Richardson's value, that of the least-squares "
        "fit, or else the finest value) against the estimated work of a run: half its nodes times "
        "its time steps. What a step costs grows with the integration points, and is larger with "
        f"the semi-implicit scheme. Grey: {100 * _COST_TOLERANCE:g} %. "
        f"{_COST.plan(runs).note(runs)} {access.missing_note(runs, _COST.names(runs))}".strip()
    )


@style.paper
def _plot_cost(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a panel per response, a curve for each of a few other settings."""
    selected, work = _COST.plan(runs), _work(runs)
    figure, axes = responses_grid.panels(_COST.names(runs), height=40)
    for name, ax in axes.items():
        difference = refinement.relative_difference(runs, analysis, _COST, name)
        for curve, errors in refinement.drawn(difference, selected):
            where = {d: at for d, at in (selected.held | curve.where).items() if d in work.dims}
            ax.plot(
                work.isel(where).values,
                errors,
                label=curve.label or "_only",
                **curves.marked(curve),
            )
        _finish_cost(ax)
    figure.supxlabel("Work (node-steps)")
    figure.supylabel("Relative difference (–)")
    style.legend(figure, selected.title(), selected.labels())
    return figure


def _work(runs: xr.Dataset) -> xr.DataArray:
    """Return the node-steps of every run, on the dimensions that they depend on."""
    inputs = xr.broadcast(*(_coded(runs[name]) for name in _INPUTS))
    steps = node_steps({name: field.values for name, field in zip(_INPUTS, inputs, strict=True)})
    return xr.DataArray(steps, dims=inputs[0].dims)


def _coded(parameter: xr.DataArray) -> xr.DataArray:
    """Return words as the integers that the kernels switch by."""
    words = {"beam_model": BEAM_MODELS, "scheme": SCHEMES}.get(str(parameter.name))
    if words is None:
        return parameter.reset_coords(drop=True)
    codes = np.array([words.index(str(word)) for word in np.ravel(parameter.values)])
    return xr.DataArray(codes.reshape(parameter.shape), dims=parameter.dims)


def _finish_cost(ax: Axes) -> None:
    if not ax.lines:
        responses_grid.empty(ax, "no error to show")
        return
    work, errors = (
        np.concatenate([np.asarray(data, dtype=float) for data in axis])
        for axis in zip(*(line.get_data() for line in ax.lines), strict=True)
    )
    decades = 10.0 ** np.arange(np.floor(np.log10(work.min())), np.ceil(np.log10(work.max())) + 1)
    scales.logarithmic(ax, "x", decades)
    scales.at(ax, "x", decades)
    ax.set_xlim(decades[0], decades[-1])
    scales.logarithmic(ax, "y", [*errors, _COST_TOLERANCE])
    ax.axhline(_COST_TOLERANCE, label="_guide", linestyle="--", **style.GUIDE)


COST = Figure(
    "convergence_cost",
    "Cost against error",
    _cost_applies,
    _plot_cost,
    _cost_caption,
)
