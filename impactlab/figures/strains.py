"""Figures of the equivalent plastic strain along the beam and over its depth."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as MplFigure

from impactlab.figures import access, curves, labels, scales, style
from impactlab.figures.access import design_dims, usable
from impactlab.figures.labels import display
from impactlab.figures.record import Figure

_STRAIN = "equivalent_plastic_strain"
_LOWEST = 1e-3
"""Smallest strain on an axis, in %."""
_PAPER_LIMIT = 0.2
"""The plastic strain that the paper compares with, in %."""


def _has_profiles(runs: xr.Dataset, analysis: xr.Dataset) -> bool:
    return _STRAIN in runs


def _plastic(runs: xr.Dataset) -> xr.Dataset:
    """Return the runs at the velocities with a plastic strain in some run; all if none has."""
    if "velocity" not in runs[_STRAIN].dims:
        return runs
    some = _largest(runs) > 0
    kept = some.any([dim for dim in some.dims if dim != "velocity"])
    return runs.isel(velocity=kept.values.nonzero()[0]) if bool(kept.any()) else runs


def _note(runs: xr.Dataset) -> str:
    """Return what a caption says of the curves, the elastic velocities and the missing runs."""
    parts = (
        curves.note(_plastic(runs), _STRAIN),
        _elastic(runs),
        access.missing_note(runs, [_STRAIN]),
    )
    return " ".join(filter(None, parts))


def _depth_marks(run: xr.Dataset) -> list[float]:
    """Return x one beam depth from mid-span, m; none where depth or span is not one number."""
    if run["beam_depth"].ndim or run["beam_span"].ndim:
        return []
    middle, depth = float(run["beam_span"]) / 2, float(run["beam_depth"])
    return [middle - depth, middle + depth]


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


def _largest(runs: xr.Dataset) -> xr.DataArray:
    """Return the largest PEEQ of each run."""
    strain = usable(runs, _STRAIN)
    return strain.max([dim for dim in strain.dims if dim not in design_dims(runs, strain.dims)])


def _along_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "Equivalent plastic strain (PEEQ) along the beam at the end of the run, the largest over "
        "the depth at each place. Dotted: one beam depth from the impact; dashed: the paper's "
        f"{_PAPER_LIMIT} %. {_note(runs)}"
    )


@style.paper
def _plot_along(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a curve per run; zeros, which a logarithmic axis cannot show, leave a gap."""
    kept = _plastic(runs)
    strain, place = display(kept[_STRAIN]), display(kept["x"])

    def line(run: xr.Dataset) -> curves.Points:
        largest = run[_STRAIN].max("z").dropna("x")
        return place(largest["x"]), strain(largest.where(largest > 0))

    figure, axes = curves.draw(kept, _STRAIN, line)
    curves.label(
        axes, labels.axis("distance from the left support", place.symbol), labels.axis("PEEQ", "%")
    )
    marks = [place.scale * mark for mark in _depth_marks(kept)]
    for ax in axes:
        _finish(ax, marks)
    return curves.finish(figure, kept, _STRAIN)


def _finish(ax: Axes, marks: list[float]) -> None:
    values = [value for line in ax.lines for value in np.asarray(line.get_ydata())]
    scales.linear(ax, "x")
    if np.isfinite(values).any():
        top = 2 * max(float(np.nanmax(values)), _PAPER_LIMIT)
        scales.logarithmic(ax, "y", [_LOWEST, top])
        ax.set_ylim(_LOWEST, top)
    elif ax.lines:
        style.remark(ax, "no plastic strain")
    for mark in marks:
        ax.axvline(mark, linestyle=":", label="_guide", **style.GUIDE)
    ax.axhline(_PAPER_LIMIT, linestyle="--", label="_guide", **style.GUIDE)


PLASTIC_STRAIN = Figure(
    "plastic_strain",
    "Equivalent plastic strain along the beam",
    _has_profiles,
    _plot_along,
    _along_caption,
)


def _over_depth_caption(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    return (
        "Equivalent plastic strain (PEEQ) over the depth in the section that it is largest in, at "
        f"the end of the run; a marker is an integration point; "
        f"zeros have no place on the logarithmic axis. {_note(runs)}"
    )


@style.paper
def _plot_over_depth(runs: xr.Dataset, analysis: xr.Dataset) -> MplFigure:
    """Draw a curve per run, the depth downwards as in the beam."""
    kept = _plastic(runs)
    strain, depth = display(kept[_STRAIN]), display(kept["z"])

    def line(run: xr.Dataset) -> curves.Points:
        section = run[_STRAIN].isel(x=int(np.argmax(run[_STRAIN].max("z").fillna(-1.0).values)))
        return scales.positive(strain(section)), depth(section["z"])

    figure, axes = curves.draw(kept, _STRAIN, line, markers=True)
    curves.label(
        axes,
        labels.axis("PEEQ", strain.symbol),
        labels.axis("distance below the axis", depth.symbol),
    )
    for ax in axes:
        values = [value for line in ax.lines for value in np.asarray(line.get_xdata())]
        if np.isfinite(values).any():
            limits = _LOWEST, 2.0 * float(np.nanmax(values))
            scales.logarithmic(ax, "x", limits)
            ax.set_xlim(limits)
        elif ax.lines:
            style.remark(ax, "no plastic strain")
        scales.linear(ax, "y")
    axes[0].set_ylim(*sorted(axes[0].get_ylim(), reverse=True))
    return curves.finish(figure, kept, _STRAIN)


PLASTIC_STRAIN_DEPTH = Figure(
    "plastic_strain_depth",
    "Equivalent plastic strain over the depth",
    _has_profiles,
    _plot_over_depth,
    _over_depth_caption,
)
