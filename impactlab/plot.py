"""Plots of runs and of their analysis, on matplotlib axes: those of the reports.

As in xarray, a function that draws one panel takes `ax` (by default the current axes) and returns
it. Those of indices draw a panel per response where none is named, and return all of the axes;
indices of FAST are Sobol indices.
"""

from pathlib import Path
from typing import Any, Protocol

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from impactlab.analysis.measurements import compared
from impactlab.analysis.regimes import of_runs
from impactlab.figures import (
    access,
    animation,
    catalogue,
    grids,
    indices,
    labels,
    measures,
    samples,
    single_runs,
    style,
)
from impactlab.figures.curves import plan
from impactlab.figures.questions import FIGURES
from impactlab.methods import INDICES
from impactlab.study.schema.measurement_files import read_measurements
from impactlab.validation.errors import unknown

__all__ = [
    "animate",
    "delta",
    "figure",
    "morris",
    "pawn",
    "regression",
    "response",
    "run",
    "sobol",
    "sobol_over_time",
]


def response(
    runs: xr.Dataset,
    name: str,
    *,
    x: str | None = None,
    hue: str | None = None,
    measurements: Any = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a response against a parameter.

    Of a grid: over dimension `x`, with a curve for every value of dimension `hue`; jumps are not
    joined. Of a sample: the runs as points, with the mean of those of about the same `x`.

    Parameters
    ----------
    runs : xarray.Dataset
        Runs of `il.simulate_many` or of a study.
    name : str
        Name of the response.
    x : str, optional
        Parameter of the axis; by default the only dimension of numbers beside `hue`.
    hue : str, optional
        Dimension of a grid with a curve per value.
    measurements : str, pathlib.Path or mapping, optional
        Measurements of the response, drawn with their expanded uncertainties over a study's grid
        (see `il.compare`).
    ax : matplotlib.axes.Axes, optional
        Axes to draw on; by default the current ones.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    ValueError
        If a name is unknown, or the runs have further dimensions: select a value of each first.

    Examples
    --------
    >>> runs = il.simulate_many(
    ...     il.paper_impact(), il.Discretisation(nodes=21), duration="11 ms", combine="product",
    ...     varied={"velocity": [1, 2, 3], "contact": ["hertz", "stronge"]})
    >>> ax = il.plot.response(runs, "contact_duration", x="velocity", hue="contact")
    >>> ax.get_xlabel(), ax.get_ylabel(), len(ax.lines)
    ('Impact velocity (m/s)', 'Contact duration (ms)', 2)
    """
    _require("response", name, [key for key in runs.data_vars if key not in ("status", "remarks")])
    along, ax = runs[_across(runs, name, x, hue)], _current(ax)
    if access.is_sample(runs):
        values, label = style.in_display_units(runs, name)
        middles = labels.display(runs[name])(of_runs(runs, name))
        samples.scatter_runs(ax, along, values.values, middles)
        ax.set(xlabel=samples.axis_label(along), ylabel=label)
        return ax
    most = runs.sizes[hue] if hue else 1
    selected = plan(runs, name, along=[str(along.name)], prefer=[hue] if hue else [], most=most)
    analysis = xr.Dataset()
    if measurements is not None:
        analysis = compared(runs, analysis, read_measurements(measurements, runs))
    label = grids.response_curves(ax, runs, analysis, name, along, selected)
    if hue:
        ax.legend(title=labels.sentence(labels.parameter(runs[hue])))
    ax.set(xlabel=grids.parameter_axis(along), ylabel=label)
    return ax


def _across(runs: xr.Dataset, name: str, x: str | None, hue: str | None) -> str:
    """Return the parameter of the axis. Raises ValueError for unknown names and further dimensions.

    name: of the response. x, hue: as of `response`.
    """
    dims = [dim for dim in access.design_dims(runs, runs[name].dims) if runs.sizes[dim] > 1]
    sample = access.is_sample(runs)
    numbers = [dim for dim in dims if runs[dim].dtype.kind in "if" and dim != hue]
    x = x if x or sample or len(numbers) != 1 else numbers[0]
    coordinates = [
        str(key)
        for key, coordinate in runs.coords.items()
        if coordinate.dims == (("run",) if sample else (key,))
        and (coordinate.dtype.kind in "if" or labels.words(coordinate))
    ]
    _require("x", x, coordinates)
    if hue is not None:
        _require("hue", hue, [] if sample else dims)
    if further := [dim for dim in dims if dim not in (x, hue, "run")]:
        first = f"{further[0]}={runs[further[0]].values[0].item()!r}"
        raise ValueError(f"runs also differ in {', '.join(further)}: first runs.sel({first})")
    return str(x)


def run(data: xr.Dataset) -> Any:
    """Draw a run of `il.simulate`: force, motion, the loop of the contact and the beam at the end.

    Parameters
    ----------
    data : xarray.Dataset
        Dataset of one impact.

    Returns
    -------
    numpy.ndarray of matplotlib.axes.Axes
        The axes, shape (4,).

    Raises
    ------
    ValueError
        If the dataset has no histories and fields of one impact.

    Examples
    --------
    >>> run = il.simulate(il.paper_impact(), il.Discretisation(nodes=41), duration="6 ms")
    >>> [ax.get_ylabel() for ax in il.plot.run(run)][:2]
    ['Contact force (kN)', 'Displacement down (mm)']
    """
    if data.get("contact_force", xr.DataArray()).dims != ("time",) or "deflection" not in data:
        raise ValueError("run: expected the dataset of one impact, from il.simulate")
    with style.interactive():
        return np.array(single_runs.picture(data).axes)


def animate(
    data: xr.Dataset, path: str | Path | None = None, *, frames: int = 200
) -> animation.Animation:
    """Animate an impact: beam and sphere, plastic zone through depth and length, contact force.

    Parameters
    ----------
    data : xarray.Dataset
        Dataset of one impact, or one run of a study; without fields on `field_time` it is solved
        once more.
    path : str or pathlib.Path, optional
        File to write, see `Animation.save`.
    frames : int, default 200
        Number of frames, where `data` has no fields on `field_time`.

    Returns
    -------
    Animation
        The animation, which notebooks play.

    Raises
    ------
    ValueError
        If the dataset holds several impacts, or none of a beam model, or for another suffix.
    OSError
        If an MP4 file is asked for without ffmpeg.

    Examples
    --------
    >>> run = il.simulate(il.paper_impact(), il.Discretisation(nodes=41), duration="6 ms")
    >>> il.plot.animate(run, frames=10).frames
    10
    """
    moving = animation.animation(animation.with_fields(data, frames))
    if path is not None:
        moving.save(path)
    return moving


def sobol_over_time(analysis: xr.Dataset) -> Any:
    """Draw Sobol indices of contact force and deflection against time, above their means.

    Parameters
    ----------
    analysis : xarray.Dataset
        Result of `il.analyse` for a Sobol sample with stored histories.

    Returns
    -------
    numpy.ndarray of matplotlib.axes.Axes
        The axes, a column per history.

    Raises
    ------
    ValueError
        If the analysis has no indices over time.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Over time", impact=il.paper_impact(), discretisation=il.Discretisation(nodes=21),
    ...     duration="0.3 ms", responses=["peak_force"], store={"histories": True, "samples": 30},
    ...     sampling=il.Sobol(base_samples=8, parameters={
    ...         "velocity": il.Uniform("1 m/s", "2 m/s"),
    ...         "beam_depth": il.Uniform("26 mm", "29 mm")}))
    >>> indices = il.analyse(study.run(workers=1))
    >>> indices.first_order_over_time.dims, len(il.plot.sobol_over_time(indices))
    (('history', 'time', 'parameter'), 6)
    """
    if not measures.histories(analysis):
        raise ValueError(
            "the analysis holds no first_order_over_time: it needs a Sobol sample with "
            "store: {histories: true}"
        )
    return figure(indices.indices_over_time.name, xr.Dataset(), analysis)


def figure(name: str, runs: xr.Dataset, analysis: xr.Dataset | None = None) -> Any:
    """Draw a figure of the report.

    Parameters
    ----------
    name : str
        Name of the figure's file, such as "parameter_effects".
    runs : xarray.Dataset
        Runs of a study, or the result of `il.rare_event` ("likeliest_way"), `il.size` ("front") or
        `il.multifidelity` ("pairs").
    analysis : xarray.Dataset, optional
        Result of `il.analyse` for these runs.

    Returns
    -------
    numpy.ndarray of matplotlib.axes.Axes
        The axes.

    Raises
    ------
    ValueError
        If these datasets allow no such figure; the message lists those that they do.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Ishigami", function="ishigami", sampling=il.Sobol(base_samples=64, parameters={
    ...         name: il.Uniform("-3.14", "3.14") for name in ("x1", "x2", "x3")}))
    >>> axes = il.plot.figure("scatter_value", study.run(workers=1))
    >>> len(axes)
    3
    """
    analysis = xr.Dataset() if analysis is None else analysis
    of_event = {figure.name: figure for figure in FIGURES if figure.applies(runs, analysis)}
    figures = of_event or catalogue.applicable(runs, analysis)
    _require("figure", name, figures)
    with style.interactive():
        return np.array(figures[name].plot(runs, analysis).axes)


class _Draw(Protocol):
    def __call__(
        self, analysis: xr.Dataset, response: str | None = None, *, ax: Axes | None = None
    ) -> Any: ...


def _indices(name: str, size: str) -> _Draw:
    """Return the function that draws the indices `name`; size: of the sample in its example."""
    family = INDICES[name].family

    def draw(analysis: xr.Dataset, response: str | None = None, *, ax: Axes | None = None) -> Any:
        if not family.given(analysis):
            missing = ", ".join(measure.name for measure in family.measures if not measure.optional)
            raise ValueError(
                f"the analysis holds no {missing}: it is not of runs for {family.title}"
            )
        listed = [str(label) for label in analysis["response"].values]
        stand_ins = {
            label: ((), np.nan, analysis.attrs | {"units": str(unit)})
            for label, unit in zip(listed, analysis["response_units"].values, strict=True)
        }
        runs = xr.Dataset(stand_ins, attrs={"responses": listed})  # their names and units are used
        if response is None and ax is None:
            return figure(family.figure, runs, analysis)
        if response is None:
            raise ValueError(f"response: is needed with ax, one of {', '.join(listed)}")
        _require("response", response, listed)
        ax = _current(ax)
        ax.set_title(labels.title(response), loc="left")
        if family is measures.MORRIS:
            indices.plane(ax, runs, analysis, response)
        else:
            indices.bars(ax, analysis, family, response)
            ax.set_xlabel(family.axis)
        ax.legend()
        return ax

    draw.__name__ = draw.__qualname__ = name
    draw.__doc__ = f"""Draw "{family.title}" of `il.analyse`, with their intervals if they have any.

    Pale bars are within the noise; a verdict stands above indices that should not be trusted.

    Parameters
    ----------
    analysis : xarray.Dataset
        Result of `il.analyse`.
    response : str, optional
        Name of the response; by default all, a panel each.
    ax : matplotlib.axes.Axes, optional
        Axes to draw one response on; by default the current ones.

    Returns
    -------
    matplotlib.axes.Axes or numpy.ndarray of matplotlib.axes.Axes
        The axes of one response, or of all.

    Raises
    ------
    ValueError
        If the analysis has no such indices, or does not know the response.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Ishigami", function="ishigami", sampling=il.{name.title()}({size}, parameters={{
    ...         name: il.Uniform("-3.14", "3.14") for name in ("x1", "x2", "x3")}}))
    >>> ax = il.plot.{name}(il.analyse(study.run(workers=1)), "value")
    """
    return draw


sobol = _indices("sobol", "base_samples=64")
delta = _indices("delta", "samples=128")
pawn = _indices("pawn", "samples=128")
regression = _indices("regression", "samples=128")
morris = _indices("morris", "trajectories=16")


def _current(ax: Axes | None) -> Axes:
    from matplotlib import pyplot  # late: files of figures do without

    return pyplot.gca() if ax is None else ax


def _require(kind: str, name: str | None, names: Any) -> None:
    if name not in names:
        raise ValueError(f"{kind} = {name!r}: {unknown(kind, name, map(str, names))}")
