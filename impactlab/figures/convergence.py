"""Figures of convergence in space, time and integration points, and of its cost."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.figures import access, curves, labels, record, scales, style
from impactlab.figures.access import known, responses, usable
from impactlab.figures.curves import Plan, Selection, plan
from impactlab.figures.labels import display
from impactlab.figures.measures import analysed
from impactlab.figures.needs import needed
from impactlab.model.cost import node_steps
from impactlab.model.parameters import REFINEMENTS
from impactlab.solver import AXIAL_SUPPORTS, BEAM_MODELS, SCHEMES, SUPPORTS
from impactlab.types import Floats
from impactlab.verdicts import ROUND_OFF, TOLERANCE

_DIFFERENCE = "Relative difference (–)"
_FEWEST = 3
CAPTION = (
    "Difference to the limit, relative to it: Richardson's value, or where there is none that of "
    "the least-squares fit, or else the finest value. Thin dashes: the order p of that limit, over "
    "the curves (in brackets where it is assumed, not observed). The bar at the finest value "
    "reaches up to its numerical uncertainty; an open marker is this uncertainty where the finest "
    "value is itself the limit. What has no limit by design is drawn as it is."
)
_DASHED: dict[str, Any] = {"linestyle": (0, (2, 1.5)), "linewidth": 0.6}
_BEAM = ("beam_span", "beam_width", "beam_depth", "beam_density", "beam_youngs_modulus")
_INPUTS = (*_BEAM, "beam_model", "scheme", "nodes", "courant", "duration")
_WORDS = {"beam_model": BEAM_MODELS, "scheme": SCHEMES}
_WORDS |= dict.fromkeys(("support_left", "support_right"), SUPPORTS)


@dataclass(frozen=True)
class Refined:
    """An axis of refinement. name: prefix of the analysis's variables; dim: of the runs.

    prefer: dimensions that get curves first; most: the largest number of curves.
    """

    name: str
    dim: str
    prefer: tuple[str, ...]
    most: int = 4

    def names(self, runs: xr.Dataset) -> list[str]:
        """Return the responses that vary on it."""
        return [name for name in responses(runs) if self.dim in runs[name].dims]

    def plan(self, runs: xr.Dataset) -> Plan:
        """Return the plan of the curves."""
        first = self.names(runs)[0]
        return plan(runs, first, along=[self.dim], prefer=self.prefer, most=self.most)

    def applies(self, runs: xr.Dataset, analysis: xr.Dataset) -> bool:
        """Return whether the grid has at least three values on it."""
        return runs.sizes.get(self.dim, 0) >= _FEWEST and bool(self.names(runs))

    def sentences(self, runs: xr.Dataset, analysis: xr.Dataset) -> tuple[str, ...]:
        """Return a caption's sentences on what converges, is shown, held and missing."""
        names = self.names(runs)
        return (
            enough(runs, analysis),
            _verdicts(runs, analysis, self.name, names),
            self.plan(runs).note(runs),
            access.missing_note(runs, names),
        )


_NODES = Refined("nodes", "nodes", ("velocity", "points"))
_TIME_STEP = Refined("time_step", "courant", ("scheme", "nodes", "velocity"))
_POINTS = Refined("points", "points", ("rule", "velocity"), most=6)
_COST = Refined("nodes", "nodes", ("scheme", "courant", "velocity"), most=6)


@record.figure("Convergence in nodes", CAPTION, _NODES.applies, _NODES.sentences)
def nodes_convergence(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw against the spacing of the nodes, over the span where that is varied."""
    spacing, label = 1.0 / (runs["nodes"].values - 1.0), "Spacing of the nodes over the span (–)"
    if not runs["beam_span"].ndim:
        metres = runs["beam_span"].values * spacing
        unit = display(xr.DataArray(metres, attrs={"units": "m"}, name="spacing"))
        spacing, label = unit(metres), labels.axis("spacing of the nodes", unit.symbol)
    return draw(runs, analysis, _NODES, spacing, label)


@record.figure(
    "Convergence in the time step",
    f"The nodes of a curve stay the same: its limit is the answer of these nodes. {CAPTION}",
    _TIME_STEP.applies,
    _TIME_STEP.sentences,
)
def time_step_convergence(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw against the Courant number."""
    label = labels.axis(labels.parameter(runs["courant"]), "")
    return draw(runs, analysis, _TIME_STEP, runs["courant"].values.astype(float), label)


def draw(
    runs: xr.Dataset, analysis: xr.Dataset, axis: Refined, spacing: Floats, label: str
) -> Figure:
    """Draw a panel per response over the spacing of the runs, in the unit of the label."""
    selected, needs = axis.plan(runs), needed(runs, analysis)
    figure, axes = style.response_panels(axis.names(runs), height=44)
    for name, ax in axes.items():
        style.write_verdict(ax, needs.verdict(axis.name, name) if needs else None)
        verdicts = access.occurring(_of(analysis, f"{axis.name}_verdict", name))
        if any(verdict.flag == "not_convergent_by_design" for verdict in verdicts):
            _draw_values(ax, runs, name, spacing, selected)
            continue
        difference = _relative_difference(runs, analysis, axis, name)
        for curve, errors in _above_round_off(difference, selected):
            curves.add(ax, spacing, errors, curve)
            _draw_trend(ax, spacing, errors, partial(_read, analysis, axis.name, name, curve.where))
        if not ax.lines:
            enough = bool((difference.count(axis.dim) > 1).any())
            style.empty(ax, "same on every grid" if enough else "too few values")
            continue
        ends = np.array([spacing.min(), spacing.max()])
        guide = 1.6 * np.nanmax(scales.drawn(ax, "y")) * (ends / ends[1]) ** 2  # above the curves
        ax.plot(ends, guide, label="_guide: second order", linestyle="-", **style.GUIDE)
        scales.logarithmic(ax, "y", scales.drawn(ax, "y"))
        _scale_spacing(ax, spacing)
        corner: dict[str, Any] = {"xycoords": "axes fraction", "ha": "right"}
        text = _orders(analysis, axis.name, name, selected)
        style.note(ax, text, (0.99, 0.04), (0, 0), warning=False, **corner)
    return selected.finish(figure, label, _DIFFERENCE)


def _orders(analysis: xr.Dataset, axis: str, name: str, selected: Plan) -> str:
    """Return the range of the curves' orders, and in brackets that of assumed ones: "p = 2 [1]"."""
    orders: dict[bool, list[str]] = {True: [], False: []}
    for curve in selected.curves:
        order, is_observed = _order(partial(_read, analysis, axis, name, curve.where))
        if np.isfinite(order):
            orders[is_observed].append(f"{order:.2f}" if is_observed else f"{order:g}")
    observed, assumed = (
        " to ".join(dict.fromkeys((min(texts), max(texts)))) if texts else ""
        for texts in orders.values()
    )
    text = " ".join(filter(None, (observed, f"[{assumed}]" if assumed else "")))
    return f"p = {text}" if text else ""


def _draw_values(ax: Axes, runs: xr.Dataset, name: str, spacing: Floats, selected: Plan) -> None:
    """Draw a response that has no limit to differ from."""
    values, label = style.in_display_units(runs, name)
    for curve in selected.curves:
        y = values.isel(curve.where).values
        if (y > 0).any():
            curves.add(ax, spacing, y, curve)
    ax.set_ylabel(label)
    scales.fit(ax, "y", scales.drawn(ax, "y"))
    if ax.get_yscale() == "linear":
        ax.set_ylim(0.0, None)
    _scale_spacing(ax, spacing)


def _verdicts(runs: xr.Dataset, analysis: xr.Dataset, axis: str, names: list[str]) -> str:
    """Return sentences on the grid of the verdicts, and how many cases of each are a warning.

    Of several cases the one with the largest uncertainty is named.
    """
    needs = needed(runs, analysis)
    if needs is None or f"{axis}_verdict" not in needs.analysis:
        return ""
    beside = needs.beside(axis)
    sentences = [f"The verdicts are those of {beside}."] if beside else []
    places: dict[str, list[str]] = {}
    for name in names:
        flags = _of(needs.analysis, f"{axis}_verdict", name)
        warnings = [verdict.value for verdict in access.occurring(flags) if not verdict.sound]
        warned = flags.isin(warnings)
        count = int(warned.sum())
        if not count:
            continue
        uncertainty = _of(needs.analysis, f"{axis}_uncertainty", name).fillna(np.inf)
        worst = uncertainty.where(warned, -1.0).argmax(...)
        text = ", ".join(labels.value(runs[dim], int(worst[dim])) for dim in flags.dims)
        if count == flags.size > 1:
            text = "every case"
        elif count > 1:
            text = f"{count} of {flags.size} cases, the worst at {text}"
        place = f" ({text})" if text else ""
        places.setdefault(place, []).append(labels.response(name))
    entries = [labels.listing(listed) + place for place, listed in places.items()]
    if entries:
        sentences.append(f"Not converged on the finest grid: {'; '.join(entries)}.")
    return " ".join(sentences)


def enough(runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """Return a sentence on the grid that each response needs, as the answer of the report."""
    needs = needed(runs, analysis)
    if needs is None:
        return ""
    grids: dict[str, list[str]] = {}
    for name in needs.errors:
        need = needs.grids.get(name)
        where = f"from {needs.words(need)}" if need else "on no grid of this study"
        grids.setdefault(where, []).append(labels.response(name))
    places = "; ".join(f"{labels.listing(names)} {where}" for where, names in grids.items())
    share = labels.percent(TOLERANCE)
    return f"Within {share} of the finest grid, uncertainty included: {places}."


def _above_round_off(
    difference: xr.DataArray, selected: Plan
) -> Iterator[tuple[Selection, Floats]]:
    """Yield each curve that has an error above round-off, with its errors along the axis."""
    for curve in selected.curves:
        errors = scales.positive(difference.isel(curve.where), above=ROUND_OFF)
        if np.isfinite(errors).any():
            yield curve, errors


def _relative_difference(
    runs: xr.Dataset, analysis: xr.Dataset, axis: Refined, name: str
) -> xr.DataArray:
    """Return |f - f0|/|f0| on (axis, ...), NaN where the limit f0 is 0."""
    values = access.bare(usable(runs, name))
    finest = REFINEMENTS[axis.dim].finest_first(runs[axis.dim].values)[0]
    reference = values.isel({axis.dim: int(finest)}, drop=True)  # without a limit
    for kind in ("fit_extrapolated", "extrapolated"):
        limit = access.bare(_of(analysis, f"{axis.name}_{kind}", name))
        reference = limit.where(np.isfinite(limit), reference)
    ratio = abs(values - reference) / abs(reference).where(reference != 0)
    return ratio.where((values != 0) | (reference != 0), 0.0).transpose(axis.dim, ...)


def _of(analysis: xr.Dataset, variable: str, name: str) -> xr.DataArray:
    """Return a variable of one response; NaN where the analysis does not have it."""
    if variable not in analysis or not known(analysis, name):
        return xr.DataArray(np.nan)
    return analysis[variable].sel(response=name, drop=True)


def _read(analysis: xr.Dataset, axis: str, name: str, where: dict[str, int], key: str) -> float:
    """Return a number of the analysis of one curve; NaN where there is none."""
    values = _of(analysis, f"{axis}_{key}", name)
    return float(values.isel(where, missing_dims="ignore"))


def _order(read: Callable[[str], float]) -> tuple[float, bool]:
    """Return the order of the limit, NaN without one, and whether it was observed, not assumed."""
    if np.isfinite(read("extrapolated")):
        return read("observed_order"), True
    return read("fit_order"), read("fit_expansion") == 0


def _draw_trend(ax: Axes, spacing: Floats, errors: Floats, read: Callable[[str], float]) -> None:
    """Draw the order through the three finest errors, and the finest's bar."""
    order, _ = _order(read)
    near, line, uncertainty = np.argsort(spacing)[:_FEWEST], ax.lines[-1], read("uncertainty")
    colour, marker = line.get_color(), line.get_marker()
    scale = np.log(errors[near]) - order * np.log(spacing[near])
    if np.isfinite(scale).any():
        ends = np.array([spacing.min(), spacing.max()])
        power = np.exp(np.nanmedian(scale)) * ends**order
        ax.plot(ends, power, color=colour, label="_order", **_DASHED)
    if np.isfinite(uncertainty) and uncertainty > ROUND_OFF:
        position, low = spacing[near[0]], errors[near[0]]
        look: dict[str, Any] = {"marker": "_", "markersize": 6}
        if np.isfinite(low):
            ax.plot(
                [position, position], [low, uncertainty], color=colour, linewidth=0.8, label="_bar"
            )
        else:  # no cap without its marker
            look = {"marker": marker, "markerfacecolor": "white"}
        ax.plot(position, uncertainty, color=colour, linestyle="", label="_bar", **look)


def _scale_spacing(ax: Axes, spacing: Floats) -> None:
    scales.logarithmic(ax, "x", spacing)
    if spacing.size <= 5:
        scales.at(ax, "x", scales.apart(spacing))
    ax.set_xlim(0.85 * spacing.min(), 1.18 * spacing.max())


@record.figure(
    "Convergence in integration points",
    "Difference to the value with the most integration points over the depth (which is left "
    "out, being its own reference), relative to it. A response has converged where three times "
    "that of the second most points is within 1 %.",
    lambda runs, analysis: "points" in runs.dims and bool(analysed(runs, analysis, "points_error")),
    lambda runs, analysis: _POINTS.sentences(runs, analysis)[1:],  # there is no limit to judge by
)
def points_convergence(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a panel per response, a curve per rule (and velocity)."""
    selected, points = _POINTS.plan(runs), analysis["points"].values
    needs = needed(runs, analysis)
    figure, axes = style.response_panels(_POINTS.names(runs), height=40)
    for name, ax in axes.items():
        style.write_verdict(ax, needs.verdict("points", name) if needs else None)
        error = abs(analysis["points_error"].sel(response=name)).transpose("points", ...)
        for curve, values in _above_round_off(error, selected):
            curves.add(ax, points, values, curve)
        if not ax.lines:
            enough = bool((error.count("points") > 1).any())
            style.empty(ax, "same for every number" if enough else "too few values")
            continue
        scales.logarithmic(ax, "x", points)
        scales.at(ax, "x", points)
        ax.set_xlim(0.9 * points.min(), 1.1 * points.max())
        _draw_tolerance(ax)
    return selected.finish(figure, labels.axis(labels.parameter(runs["points"]), ""), _DIFFERENCE)


def _draw_tolerance(ax: Axes) -> None:
    """Make the vertical axis logarithmic, to hold a line at the tolerance."""
    scales.logarithmic(ax, "y", [*scales.drawn(ax, "y"), TOLERANCE])
    ax.axhline(TOLERANCE, label=f"_guide: tolerance {TOLERANCE}", linestyle="--", **style.GUIDE)


@record.figure(
    "Cost against error",
    "Difference to the limit at zero spacing (Richardson's value, that of the least-squares "
    "fit, or else the finest value) against the estimated work of a run: its nodes (of a "
    "symmetric impact half of them) times its time steps. What a step costs grows with the "
    "integration points, and depends on the scheme.",
    lambda runs, analysis: (
        _COST.applies(runs, analysis)
        and all(name in runs.coords for name in _INPUTS)
        and bool(runs["beam_model"].isin(BEAM_MODELS).all())  # the cost of others is not known
    ),
    lambda runs, analysis: (enough(runs, analysis), *_COST.sentences(runs, analysis)[2:]),
)
def convergence_cost(runs: xr.Dataset, analysis: xr.Dataset) -> Figure:
    """Draw a panel per response, a curve for each of a few other settings."""
    selected = _COST.plan(runs)
    given = {name: runs[name].reset_coords(drop=True) for name in _INPUTS}
    others = {"support_left": "pinned", "support_right": "pinned", "strike_position": 0.5}
    ends = (runs.get(f"support_{side}", xr.DataArray("pinned")) for side in ("left", "right"))
    held = (end.isin(AXIAL_SUPPORTS) for end in ends)
    given |= dict(zip(("axis_held_left", "axis_held_right"), held, strict=True))
    others |= {"stiffness_damping": 0.0, "foundation_stiffness": 0.0, "strikes": 1}
    others |= {"strike_interval": 0.0, "further": 0}
    others |= {
        f"{kind}stiffness_{side}": 0.0 for kind in ("", "rotational_") for side in ("left", "right")
    }
    given |= {name: runs.get(name, xr.DataArray(plain)) for name, plain in others.items()}
    for name, words in _WORDS.items():
        given[name] = xr.apply_ufunc(np.vectorize(words.index), given[name])
    work = node_steps(dict(zip(given, xr.broadcast(*given.values()), strict=True)))
    figure, axes = style.response_panels(_COST.names(runs), height=40)
    for name, ax in axes.items():
        difference = _relative_difference(runs, analysis, _COST, name)
        for curve, errors in _above_round_off(difference, selected):
            x = work.isel(curve.where, missing_dims="ignore").values
            curves.add(ax, x, errors, curve)
        if not ax.lines:
            style.empty(ax, "no error to show")
            continue
        powers = np.log10(scales.drawn(ax, "x"))
        decades = 10.0 ** np.arange(np.floor(powers.min()), np.ceil(powers.max()) + 1)
        scales.logarithmic(ax, "x", decades)
        scales.at(ax, "x", decades)
        ax.set_xlim(decades[0], decades[-1])
        _draw_tolerance(ax)
    return selected.finish(figure, "Work (node-steps)", _DIFFERENCE)
