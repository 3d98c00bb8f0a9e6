"""What accuracy costs: error in space and time against the work of a run."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, curves, refinement, responses_grid, scales, style
from impactlab.model.cost import node_steps
from impactlab.solver import BEAM_MODELS, SCHEMES

TITLE = "Cost against error"
_AXIS = refinement.Refined("nodes", "nodes", ("scheme", "courant", "velocity"), most=6)
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
_TOLERANCE = 0.01


def applies(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    """Whether the nodes are refined and all runs are of beams whose cost is known."""
    known = _AXIS.applies(runs) and all(name in runs.coords for name in _INPUTS)
    return known and set(np.ravel(runs["beam_model"].values).tolist()) <= set(BEAM_MODELS)


def caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is shown, held and missing."""
    return (
        "Difference to the limit at zero spacing (Richardson's value, that of the least-squares "
        "fit, or else the finest value) against the estimated work of a run: half its nodes times "
        "its time steps. What a step costs grows with the integration points, and is larger with "
        f"the semi-implicit scheme. Grey: {100 * _TOLERANCE:g} %. "
        f"{_AXIS.plan(runs).note(runs)} {access.missing_note(runs, _AXIS.names(runs))}".strip()
    )


@style.paper
def plot(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """A panel a response, a curve for each of a few other settings."""
    selected, work = _AXIS.plan(runs), cost(runs)
    figure, axes = responses_grid.panels(_AXIS.names(runs), height=40)
    for name, ax in axes.items():
        difference = refinement.relative_difference(runs, analysis, _AXIS, name)
        for curve, errors in refinement.drawn(difference, selected):
            where = {d: at for d, at in (selected.held | curve.where).items() if d in work.dims}
            ax.plot(
                work.isel(where).values,
                errors,
                label=curve.label or "_only",
                **curves.marked(curve),
            )
        _finish(ax)
    figure.supxlabel("Work (node-steps)")
    figure.supylabel("Relative difference (–)")
    style.legend(figure, selected.title(), selected.labels())
    return figure


def cost(runs: xr.Dataset) -> xr.DataArray:
    """Node-steps of every run, on the dimensions that they depend on."""
    inputs = xr.broadcast(*(_coded(runs[name]) for name in _INPUTS))
    steps = node_steps({name: field.values for name, field in zip(_INPUTS, inputs, strict=True)})
    return xr.DataArray(steps, dims=inputs[0].dims)


def _coded(parameter: xr.DataArray) -> xr.DataArray:
    """Words as the kernels' switches."""
    words = {"beam_model": BEAM_MODELS, "scheme": SCHEMES}.get(str(parameter.name))
    if words is None:
        return parameter.reset_coords(drop=True)
    codes = np.array([words.index(str(word)) for word in np.ravel(parameter.values)])
    return xr.DataArray(codes.reshape(parameter.shape), dims=parameter.dims)


def _finish(ax: Axes) -> None:
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
    scales.logarithmic(ax, "y", [*errors, _TOLERANCE])
    ax.axhline(_TOLERANCE, label="_guide", linestyle="--", **style.GUIDE)
