"""Figures of a study with 3-D runs: models against velocity, their differences, convergence.

Each model is taken on its finest grid, with its uncertainty.
"""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from impactlab.fem3d.wing import MODEL, SIZES, SOLID
from impactlab.figures import access, labels, record, scales, style
from impactlab.figures.access import known, usable
from impactlab.figures.convergence import CAPTION, Refined, draw, enough
from impactlab.figures.data import name_places
from impactlab.figures.labels import display
from impactlab.types import Floats

AXES = {"nodes": np.argmax, "element_size": np.argmin, "elements_per_radius": np.argmax}
"""Refinements, and the function that finds the finest grid on each."""
_FEWEST = 3


class Side(NamedTuple):
    """A response of one model: value and half-width, (velocities,), SI; the latter NaN if unknown.

    Where nothing bounds the error, the half-width is infinite.
    """

    value: Floats
    uncertainty: Floats


def differ(runs: xr.Dataset) -> bool:
    """Return whether a grid has the 3-D FE model beside others at three velocities or more."""
    if "beam_model" not in runs.dims or runs.sizes.get("velocity", 0) < _FEWEST:
        return False
    rest = set(runs.dims) - {"time", "x", "z", "velocity", "beam_model", *AXES}
    return SOLID in runs["beam_model"].values and runs.sizes["beam_model"] > 1 and not rest


def models(runs: xr.Dataset) -> list[str]:
    """Return the 3-D FE model first, then the others in the study's order."""
    listed = [str(name) for name in runs["beam_model"].values]
    return [SOLID, *(name for name in listed if name != SOLID)]


def finest(runs: xr.Dataset) -> dict[str, int]:
    """Return the index of the finest grid, by dimension."""
    return {
        dim: int(finest_of(runs[dim].values)) for dim, finest_of in AXES.items() if dim in runs.dims
    }


def side(runs: xr.Dataset, analysis: xr.Dataset, name: str, model: str) -> Side:
    """Return a response of one model against the velocity, in the order of the runs."""
    values = usable(runs, name).sel(beam_model=model).isel(finest(runs), missing_dims="ignore")
    response = values.values.astype(float)
    variable = f"{'element_size' if model == SOLID else 'nodes'}_uncertainty"
    if variable not in analysis or not known(analysis, name):
        return Side(response, np.full(response.shape, np.nan))
    share = analysis[variable].sel(response=name, beam_model=model)
    share = share.isel(dict.fromkeys(AXES, 0), missing_dims="ignore")
    return Side(response, abs(response) * share.values.astype(float))


def difference(over: list[Side], under: list[Side]) -> Side:
    """Return product over product, minus one, with the uncertainties of all; NaN over 0."""
    below = np.prod([entry.value for entry in under], axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.prod([entry.value for entry in over], axis=0) / np.where(below, below, np.nan)
        share = sum(abs(entry.uncertainty / entry.value) for entry in (*over, *under))
    return Side(ratio - 1.0, abs(ratio) * share)


EULER, TIMOSHENKO = "euler_bernoulli", "timoshenko"
NAMES = ("peak_force", "contact_duration")
_YIELD = "beam_yield_stress"

EFFECTS = {
    "shear": "shear and rotary inertia",
    "flexibility": "3-D elasticity of the contact",
    "law": "contact law in yielding",
    "all": "all together",
}
"""Each effect in words."""


def separable(runs: xr.Dataset) -> bool:
    """Return whether a grid varies only the three models and two yield stresses."""
    if "beam_model" not in runs.dims or runs.sizes.get(_YIELD, 0) != 2:
        return False
    rest = set(runs.dims) - {"time", "beam_model", _YIELD, *AXES}
    complete = {EULER, TIMOSHENKO, SOLID} <= set(runs["beam_model"].values.tolist())
    return complete and not rest and all(name in runs for name in NAMES)


def effects(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> dict[str, Side]:
    """Return the share by which each effect changes a response, by the keys of EFFECTS.

    Each is of shape (). With E, T and S the response of the Euler-Bernoulli beam, the Timoshenko
    beam and the 3-D FE model, and e for the runs in which nothing yields: shear T/E - 1,
    flexibility Se/Te - 1, law (S/Se)/(T/Te) - 1, all S/E - 1. One plus the last is the product of
    one plus each other.
    """
    soft, hard = np.argsort(runs[_YIELD].values)
    curves = [side(runs, analysis, name, model) for model in (EULER, TIMOSHENKO, SOLID)]
    (e, _), (t, te), (s, se) = (
        [Side(curve.value[index], curve.uncertainty[index]) for index in (soft, hard)]
        for curve in curves
    )
    return {
        "shear": difference([t], [e]),
        "flexibility": difference([se], [te]),
        "law": difference([s, te], [se, t]),
        "all": difference([s], [e]),
    }


_SHOWN = (
    *("peak_force", "contact_duration", "maximum_deflection"),
    *("permanent_indentation", "maximum_indentation"),
)
"""Responses to draw, most important first."""
_MOST = 3
_LEAST, _ROOM = 2.0, 2.0
"""Least half-height of a panel of differences in %; its largest, over the largest difference."""


@record.figure(
    "The beam models and the 3-D FE model",
    "Above: each model on its finest grid. Below: its difference from the 3-D "
    "finite-element model, in parts of that; bars: the numerical uncertainty of both models "
    "together, left out where nothing bounds it and cut at the panel's edge. Markers below are "
    "drawn a little beside their velocity, not to hide each other.",
    lambda runs, analysis: differ(runs) and bool(_drawn(runs)),
    lambda runs, analysis: (*findings(runs, analysis), access.missing_note(runs, _drawn(runs))),
)
def witness(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw one column per response: values above, differences from the 3-D FE model below."""
    names = _drawn(runs)
    figure, axes = style.panels(2 * len(names), columns=len(names), height=52)
    for column, name in enumerate(names):
        above, below = axes[column], axes[column + len(names)]
        _values(above, runs, analysis, name)
        _differences(below, runs, analysis, name)
        for ax in (above, below):
            scales.logarithmic(ax, "x", runs["velocity"].values)
            scales.at(ax, "x", runs["velocity"].values)
        below.set_xlim(0.85 * runs["velocity"].values.min(), 1.18 * runs["velocity"].values.max())
        below.set_xlabel(labels.axis(labels.parameter(runs["velocity"]), "m/s"))
    axes[len(names)].set_ylabel(labels.wrapped_axis("difference from the 3-D FE model", "%", 24))
    style.legend(figure, "Model of the beam", [labels.beam_model(name) for name in models(runs)])
    return figure


def _drawn(runs: xr.Dataset) -> list[str]:
    return [name for name in _SHOWN if name in access.responses(runs)][:_MOST]


def _look(position: int, model: str) -> dict[str, Any]:
    """Return label and style: 3-D black, others as in all figures, one marker each."""
    look = {
        "color": style.COLOURS[position - 1] if position else "black",
        "label": labels.beam_model(model),
    }
    return look | {"marker": style.MARKERS[position], "linestyle": style.LINES[position]}


def _values(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str) -> None:
    unit = display(usable(runs, name))
    for position, model in enumerate(models(runs)):
        values = unit(side(runs, analysis, name, model).value)
        if np.isfinite(values).any():
            ax.plot(runs["velocity"].values, values, **_look(position, model))
    ax.set_title(labels.title(name), loc="left")
    ax.set_ylabel(labels.axis(labels.response(name), unit.symbol))
    if not ax.lines:
        style.remark(ax)
        return
    shown = scales.drawn(ax, "y")
    if np.nanmin(shown) > 0:
        scales.logarithmic(ax, "y", shown)


def _differences(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset, name: str) -> None:
    first, *beams = models(runs)
    against = side(runs, analysis, name, first)
    speeds = runs["velocity"].values
    ends: list[float] = []
    for position, model in enumerate(beams, 1):
        gap = difference([side(runs, analysis, name, model)], [against])
        bars = np.where(np.isfinite(gap.uncertainty), 100.0 * gap.uncertainty, np.nan)
        # beside its velocity, in the picture alone
        points = 2.2 * (position - 0.5 * (len(beams) + 1))
        shift = ScaledTranslation(points / 72.0, 0.0, ax.figure.dpi_scale_trans)
        if np.isfinite(gap.value).any():
            look = _look(position, model) | {"elinewidth": 0.8, "transform": ax.transData + shift}
            ax.errorbar(speeds, 100.0 * gap.value, yerr=bars, **look)
            reach = np.nan_to_num(bars)
            ends += [*(100.0 * gap.value - reach), *(100.0 * gap.value + reach)]
    ax.set_title(f"Δ {labels.response(name)}", loc="left")  # as short as its column is wide
    if not ax.containers:
        style.remark(ax)
        return
    ax.axhline(0.0, label="_guide", **style.GUIDE)
    scales.linear(ax, "y")
    room = _ROOM * max(_LEAST, float(np.nanmax(abs(scales.drawn(ax, "y")))))
    low, high = float(np.nanmin([0.0, *ends])), float(np.nanmax([0.0, *ends]))
    ax.set_ylim(max(1.1 * low, -room), min(1.1 * high, room))


_HISTORIES = ("contact_force", "indentation")
_LABELS = {TIMOSHENKO: "contact law (Timoshenko beam)", SOLID: "3-D FE model"}


@record.figure(
    "Where the 3-D FE model differs from the paper's beam",
    "Left: force against indentation (to mid-depth) as the contact law has it and as the 3-D "
    "solid answers, elastic and yielding. Right: by how much each effect changes the answer of "
    "the paper's beam (Euler-Bernoulli); bars: the numerical uncertainty of all runs that it "
    "is made of, left out where nothing bounds it. Shear and rotary inertia: Timoshenko's beam "
    "over Euler-Bernoulli's. 3-D elasticity of the contact: the elastic solid over the elastic "
    "Timoshenko beam under Hertz's law; what the local compliance through the depth and the "
    "waves in the sphere do. Contact law in yielding: what yielding does to the solid over "
    "what it does under the contact law.",
    lambda runs, analysis: separable(runs) and all(name in runs for name in _HISTORIES),
    lambda runs, analysis: (*findings(runs, analysis), access.missing_note(runs, NAMES)),
)
def witness_parts(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw force against indentation on the left, the effects on the right."""
    figure, (left, right) = style.panels(2, columns=2, height=72)
    _curves(left, runs)
    _effects(right, runs, analysis)
    style.legend(figure)
    return figure


def _curves(ax: Axes, runs: xr.Dataset) -> None:
    chosen = xr.Dataset({name: usable(runs, name) for name in _HISTORIES}).isel(finest(runs))
    force, depth = (display(runs[name]) for name in _HISTORIES)
    softest = float(runs["beam_yield_stress"].min())
    for position, (model, label) in enumerate(_LABELS.items()):
        for stress in np.sort(runs["beam_yield_stress"].values):
            run = chosen.sel(beam_model=model, beam_yield_stress=stress)
            pushed = np.flatnonzero(run["contact_force"].values > 0.0)
            if not pushed.size:
                continue
            first = slice(0, int(pushed[-1]) + 2)
            behaviour = "yielding" if stress == softest else "elastic"
            ax.plot(
                depth(run["indentation"].values[first]),
                force(run["contact_force"].values[first]),
                color=style.COLOURS[0] if position == 0 else "black",
                linestyle=style.LINES[0 if stress == softest else 1],
                label=f"{label}, {behaviour}",
            )
    if not ax.lines:
        style.remark(ax)
    ax.set_xlabel(labels.axis("indentation", depth.symbol))
    ax.set_ylabel(labels.axis("contact force", force.symbol))
    scales.linear(ax, "xy")


def _effects(ax: Axes, runs: xr.Dataset, analysis: xr.Dataset) -> None:
    for position, name in enumerate(NAMES):
        sides = effects(runs, analysis, name).values()
        shares, widths = np.array(list(sides), dtype=float).T
        places = np.flatnonzero(np.isfinite(shares))
        bars = np.where(np.isfinite(widths), widths, np.nan)
        ax.errorbar(
            100.0 * shares[places],
            places + 0.24 * (position - 0.5),
            xerr=100.0 * bars[places],
            linestyle="",
            color=style.COLOURS[1 + position],
            marker=style.MARKERS[1 + position],
            label=labels.response(name),
        )
    ax.axvline(0.0, label="_guide", **style.GUIDE)
    name_places(ax, "y", list(EFFECTS.values()))
    ax.invert_yaxis()
    ax.set_xlabel(labels.axis("change of the beam's answer", "%"))
    scales.linear(ax, "x")


def _of_effects(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """Return one sentence per response on the shares of effects; EFFECTS ends with all together."""
    sentences = []
    for name in NAMES:
        shares = [
            float(effect_side.value) for effect_side in effects(runs, analysis, name).values()
        ]
        if np.isfinite(shares).all():
            *parts, total = (f"{labels.number(100.0 * share, 2)} %" for share in shares)
            pairs = zip(parts, EFFECTS.values(), strict=False)
            listed = labels.listing([f"{part} by the {effect}" for part, effect in pairs])
            sentences.append(f"The {labels.response(name)} changes by {listed}; together {total}.")
    return sentences


def _of_models(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """Return one sentence per response on the differences of the beam models, over velocities."""
    sentences, speeds = [], runs["velocity"].values
    between = f"between {labels.number(speeds.min(), 3)} and {labels.number(speeds.max(), 3)} m/s"
    for name in _drawn(runs):
        solid, *beams = (side(runs, analysis, name, model) for model in models(runs))
        gaps = [difference([beam], [solid]) for beam in beams]
        parts = [
            f"{labels.span(shares[np.isfinite(shares)], 2)} % with {labels.beam_model(model)}"
            for shares, model in zip(
                (100.0 * gap.value for gap in gaps), models(runs)[1:], strict=True
            )
            if np.isfinite(shares).any()
        ]
        if parts:
            head = f"Difference of the {labels.response(name)} from the {MODEL.label} {between}"
            sentences.append(f"{head}: {labels.listing(parts)}{_doubt(gaps)}.")
    return sentences


def _doubt(gaps: list[Side]) -> str:
    """Return the largest numerical uncertainty of differences, "" where it is not known."""
    widths = np.concatenate([gap.uncertainty for gap in gaps])
    largest = 100.0 * float(np.max(widths, initial=0.0, where=~np.isnan(widths)))
    if largest == np.inf:
        return " (numerically without a bound in part)"
    return f" (numerically ± {labels.number(largest, 2)} % or less)" if largest else ""


def findings(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """Return what a study finds beside the 3-D FE model in sentences; none of other studies."""
    if separable(runs):
        return _of_effects(runs, analysis)
    return _of_models(runs, analysis) if differ(runs) else []


def _refined(runs: xr.Dataset) -> Refined:
    dim = next((name for name in SIZES if name in runs.dims), SIZES[0])
    return Refined(MODEL.axis, dim, ("velocity", "beam_yield_stress"))


def _solid(dataset: xr.Dataset) -> xr.Dataset:
    """Return the runs of the 3-D model, which do not depend on the nodes."""
    if "beam_model" in dataset.dims:
        dataset = dataset.sel(beam_model=SOLID)
    return dataset.isel(nodes=0) if "nodes" in dataset.dims else dataset


@record.figure(
    MODEL.axis_title,
    "Three-dimensional model alone; elements beyond the contact keep their largest size. "
    f"{CAPTION}",
    lambda runs, analysis: (
        _refined(runs).applies(runs, analysis) and SOLID in runs["beam_model"].values
    ),
    lambda runs, analysis: (
        enough(runs, analysis),
        *_refined(runs).sentences(_solid(runs), _solid(analysis))[1:],
    ),
)
def element_size_convergence(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw against the size of the elements, or over the radius that the contact is to have."""
    axis = _refined(runs)
    values = runs[axis.dim].values
    if axis.dim == "element_size":
        unit = display(runs[axis.dim])
        sizes, label = unit(values), labels.axis("element size", unit.symbol)
    else:
        sizes = np.round(100.0 / values, 1)
        label = labels.axis("element size over expected contact radius", "%")
    return draw(_solid(runs), _solid(analysis), axis, sizes, label)


FIGURES = {figure.name: figure for figure in (witness, witness_parts, element_size_convergence)}
"""Figures of a study, by name, in the order of the report."""
