"""The cheapest discretisation that is fine enough, from pilot runs on the study's corner cases.

The uncertainties of the three axes are found separately and added: that of the nodes (at the
study's courant, so that the time step shrinks with the spacing), that of the points and that of the
time step (both at the fewest nodes that suffice by themselves).

Corner cases are the numbers of a study at their extremes. With more than four numbers all corners
would be too many. Then the columns of a Hadamard matrix and their negatives are taken (a two-level
design of resolution IV: any three parameters meet in all eight combinations of their extremes; Box,
Hunter and Hunter (2005), Statistics for Experimenters, ch. 6), and the case in the middle.
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial, reduce
from itertools import product
from operator import add
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.linalg import hadamard

from impactlab.analysis.convergence import points
from impactlab.analysis.convergence.axes import NODES, without_limit
from impactlab.analysis.convergence.judgement import numerical_uncertainty
from impactlab.methods.distributions import Choice
from impactlab.methods.entries import Distribution
from impactlab.methods.runs import usable
from impactlab.model.case_table import case_table
from impactlab.model.cost import node_steps
from impactlab.model.discretisation import Discretisation
from impactlab.model.parameters import Value, flatten, with_values
from impactlab.provenance import provenance
from impactlab.solver.jit import SOURCES_HASH
from impactlab.study.design import series_sizes
from impactlab.study.engine import Engine
from impactlab.study.execute import execute
from impactlab.study.schema.declarations import Auto, ImpactStudy
from impactlab.study.store import locked
from impactlab.types import Floats
from impactlab.validation.errors import Problem, StudyError
from impactlab.variables import described

AXES = ("nodes", "points", "courant")
_ALL = 4  # most numbers of which all corners are taken
_TAIL = 0.005
"""Probability of either tail of a distribution without end, whose quantiles are its extremes."""
Levels = Mapping[str, tuple[float, ...]]
"""Refinement levels of each axis, in order of rising cost."""
Pilots = Callable[[str, tuple[float, ...], Discretisation], tuple[xr.DataArray, xr.DataArray]]
"""solve_along of one study: takes axis, levels and discretisation."""
FLOOR = 0.1
"""Uncertainties are relative to the value, or to this share of the largest over the cases."""
_SPACINGS = {"leapfrog": (50, 800), "modal": (36, 432)}
"""Spacings over the span, coarsest and finest, by scheme: the finer the last level, the smaller the
error that remains."""
_POINTS = (3, 5, 7, 9, 13, 17, 25)
_COURANTS = (0.9, 0.45, 0.225)
_FIRST_COURANT = {"leapfrog": 0.9, "modal": 0.45}
"""Of the runs on which the nodes are judged, by scheme, where the discretisation is to be found."""
_POINT_COST = 0.05
"""Cost of one more integration point, relative to the node-steps of a run where fibres yield;
measured on the paper's beam at 15 and 20 m/s (tests/benchmarks/kernel.py)."""


def recommend(
    study: ImpactStudy, folder: Path, engine: Engine, wishes: Auto | None = None
) -> xr.Dataset:
    """Return the recommended discretisation and its evidence, from pilot runs on corner cases.

    folder: for the shards of the pilot runs. wishes: tolerance, and the responses that have to meet
    it; by default the study's own, or else 1 % for all.

    For each axis (nodes, points, courant), <axis>_value and <axis>_uncertainty are on (response,
    case, axis) in the unit of the response, infinite where unknown. All combinations of levels are
    as `_grid_options` returns them. `asked` (response) is True for requested responses;
    `recommended` is the cheapest candidate that meets the tolerance for every requested response
    for which any candidate does, -1 where there is none. check_difference (response, case) lies
    between the recommended candidate and the last level of all axes at once: an independent check
    of the sum. grid_uncertainty (response, case) and grid_relative (response) belong to the study's
    grid, the recommended one where it is to be found; attributes grid_nodes, grid_points and
    grid_courant name it. Raises OSError when the disk is full, no scheduler answers, or another
    process works in `folder`.
    """
    wishes = wishes or study.auto or Auto()
    impact, grid = with_values(study.impact, study.discretisation, study.sampling.fixed)
    if study.auto:
        grid = replace(grid, courant=_FIRST_COURANT[grid.scheme])
    study = replace(study, impact=impact, discretisation=grid)
    cases = corner_cases(study)
    pilots = partial(solve_along, study, cases, folder, engine)
    with locked(folder):  # over all pilot runs
        evidence = _evidence(study, pilots, wishes.tolerance, wishes.responses or study.responses)
    attrs: dict[str, Any] = {"study": study.name, "study_sha256": study.sha256}
    attrs |= {"kernels_sha256": SOURCES_HASH, "tolerance": wishes.tolerance}
    chosen = recommended_grid(evidence, grid) if study.auto else grid
    if chosen is not None:
        levels = {axis: getattr(chosen, axis) for axis in AXES}
        parts = (
            evidence[f"{axis}_uncertainty"].sel({axis: levels[axis]}, drop=True) for axis in AXES
        )
        amount = reduce(add, parts)
        share = relative(amount, evidence["nodes_value"].isel(nodes=-1, drop=True)).max("case")
        evidence = evidence.assign(grid_uncertainty=amount, grid_relative=share)
        attrs |= {f"grid_{axis}": level for axis, level in levels.items()}
    labels = {name: ("case", np.array(values)) for name, values in cases.items()}
    return evidence.assign_coords(labels).assign_attrs(attrs | provenance())


def grid_uncertainty(
    study: ImpactStudy, cases: Mapping[str, Sequence[Value]], folder: Path, engine: Engine
) -> xr.DataArray:
    """Return the numerical uncertainty of a study's grid, (response, case), infinite where unknown.

    cases: values of its varied parameters. folder: for the shards of the pilot runs. Raises OSError
    as `recommend`.
    """
    impact, grid = with_values(study.impact, study.discretisation, study.sampling.fixed)
    study = replace(study, impact=impact, discretisation=grid)
    levels = _refinement_levels(grid, auto=False)
    pilots = partial(solve_along, study, cases, folder, engine)
    parts = (
        _axis(pilots, axis, levels, grid)[f"{axis}_uncertainty"].sel(
            {axis: getattr(grid, axis)}, drop=True
        )
        for axis in AXES
    )
    return reduce(add, parts)


def recommended_grid(evidence: xr.Dataset, base: Discretisation) -> Discretisation | None:
    """Return the base with nodes, points and courant of the recommended candidate, or None."""
    best = int(evidence["recommended"])
    if best < 0:
        return None
    nodes, points, courant = (evidence[f"candidate_{axis}"].values[best].item() for axis in AXES)
    return replace(base, nodes=int(nodes), points=int(points), courant=courant)


def relative(amount: xr.DataArray, value: xr.DataArray) -> xr.DataArray:
    """Return amounts over values, these at least FLOOR of the largest; 0 over 0 is 0."""
    size = abs(value)
    floor = FLOOR * size.max("case")
    scale = size.where(size > floor, floor)
    share = (amount / scale.where(scale > 0)).where(amount != 0, 0.0)
    return share.fillna(np.inf)


def _evidence(
    study: ImpactStudy, pilots: Pilots, tolerance: float, responses: Collection[str]
) -> xr.Dataset:
    grid = study.discretisation
    levels = _refinement_levels(grid, study.auto is not None)
    evidence = xr.Dataset(_axis(pilots, "nodes", levels, grid))
    requested = evidence["response"].isin(list(responses))
    # the fewest nodes that suffice for all requested responses for which any do
    meets = _worst(evidence, "nodes") <= tolerance
    enough = (meets | ~meets.any("nodes") | ~requested).all("response")
    fewest = int(evidence["nodes"].values[np.argmax(enough.values)])
    middle = replace(grid, nodes=fewest)
    evidence = evidence.assign(_axis(pilots, "points", levels, middle))
    evidence = evidence.assign(_axis(pilots, "courant", levels, middle)).assign(asked=requested)
    evidence = evidence.assign(_grid_options(evidence, study, tolerance))
    # the first candidate that is fine enough for all requested responses that any is for
    attainable = requested & evidence["reached"]
    fine = ((evidence["candidate_uncertainty"] <= tolerance) | ~attainable).all("response").values
    best = int(np.argmax(fine)) if attainable.any() and fine.any() else -1
    evidence = evidence.assign(recommended=best)
    chosen = recommended_grid(evidence, grid)
    if chosen is None:
        difference = xr.full_like(evidence["nodes_value"].isel(nodes=0, drop=True), np.nan)
    else:
        last = replace(grid, points=int(levels["points"][-1]), courant=levels["courant"][-1])
        ours, _ = pilots("nodes", (chosen.nodes,), chosen)
        theirs, _ = pilots("nodes", levels["nodes"][-1:], last)
        difference = abs(ours.isel(nodes=0, drop=True) - theirs.isel(nodes=0, drop=True))
    return evidence.assign(check_difference=difference)


def _refinement_levels(grid: Discretisation, auto: bool) -> Levels:
    """Return the levels to try for a study of this discretisation.

    Spacings are halved, with one level about half-way between. The study's own spacing, half of it
    and a quarter are levels, too, even beyond the finest: finer levels show its error. auto: it has
    none of its own.
    """
    study_spans = () if auto else tuple((grid.nodes - 1) * factor for factor in (1, 2, 4))
    span, finest = _SPACINGS[grid.scheme]
    spans, most = {*study_spans}, max(finest, *study_spans, 0)
    while span <= finest:
        spans |= {span, 3 * span // 4 * 2}
        span *= 2
    courants = {grid.courant / factor for factor in (1, 2, 4)} | {*_COURANTS}
    return {
        "nodes": tuple(sorted(intervals + 1 for intervals in spans if intervals <= most)),
        "points": tuple(sorted({*_POINTS, grid.points})),
        "courant": tuple(sorted(courants, reverse=True)),
    }


def _axis(
    pilots: Pilots, axis: str, levels: Levels, grid: Discretisation
) -> dict[str, xr.DataArray]:
    """Return the values on all levels of an axis, and their uncertainty, infinite where unknown.

    Points and time step are judged by the differences to the costliest level: once fibres yield,
    the error is no power of the points; and changes with the time step at fixed nodes are too small
    (about 1e-6) and too irregular for one.
    """
    values, without_limit = pilots(axis, levels[axis], grid)
    finest_first = values.isel({axis: slice(None, None, -1)})
    spacings = 1.0 / (finest_first["nodes"].values.astype(float) - 1.0) if axis == "nodes" else None

    def judge(row: Floats) -> Floats:
        if spacings is None:
            return points.numerical_uncertainty(row)
        return numerical_uncertainty(row, spacings)[0]

    uncertainties: xr.DataArray = xr.apply_ufunc(
        judge, finest_first, input_core_dims=[[axis]], output_core_dims=[[axis]], vectorize=True
    )
    amounts = uncertainties.isel({axis: slice(None, None, -1)}).fillna(np.inf)
    return {f"{axis}_value": values, f"{axis}_uncertainty": amounts.where(~without_limit, np.inf)}


def _grid_options(
    evidence: xr.Dataset, study: ImpactStudy, tolerance: float
) -> dict[str, xr.DataArray]:
    """Return all combinations of the levels of `evidence`, the cheapest first.

    Variables on (candidate): candidate_nodes, candidate_points, candidate_courant and
    candidate_cost, relative to the study's own discretisation; candidate_uncertainty (response,
    candidate), relative, the worst over the cases; reached (response), whether one meets the
    tolerance.
    """
    levels = np.array(list(product(*(evidence[axis].values for axis in AXES))), dtype=float)
    grid = study.discretisation
    together = np.vstack([levels, [grid.nodes, grid.points, grid.courant]])
    varied = dict(zip(AXES, together.T, strict=True))
    cases = case_table(study.impact, grid, duration=study.duration, varied=varied)
    *prices, ours = node_steps(cases) * (1.0 + _POINT_COST * cases["points"])
    price = np.array(prices) / ours
    order = np.argsort(price, kind="stable")
    sorted_levels = zip(AXES, levels[order].T, strict=True)
    columns = {axis: xr.DataArray(column, dims="candidate") for axis, column in sorted_levels}
    parts = (_worst(evidence, axis).sel({axis: columns[axis]}).drop_vars(axis) for axis in AXES)
    worst = reduce(add, parts).transpose("response", "candidate")
    return {f"candidate_{axis}": column for axis, column in columns.items()} | {
        "candidate_cost": xr.DataArray(price[order], dims="candidate"),
        "candidate_uncertainty": worst,
        "reached": (worst <= tolerance).any("candidate"),
    }


def _worst(evidence: xr.Dataset, axis: str) -> xr.DataArray:
    reference = evidence["nodes_value"].isel(nodes=-1, drop=True)
    return relative(evidence[f"{axis}_uncertainty"], reference).max("case")


def apply_recommendation(study: ImpactStudy, evidence: xr.Dataset) -> ImpactStudy:
    """Return a study that is `auto` with its recommended discretisation (see `recommend`).

    Raises StudyError where no discretisation meets the tolerance for a requested response, naming
    the nearest.
    """
    auto = study.auto
    assert auto is not None
    least = evidence["candidate_uncertainty"].min("candidate")
    missed = []
    for name, share in least[(evidence["asked"] & ~evidence["reached"]).values].to_series().items():
        best = f"{100 * share:.2g} % at best" if np.isfinite(share) else "nothing bounds its error"
        missed.append(f"{name} ({best})")
    if missed:
        most, listed = int(evidence["nodes"].max()), ", ".join(missed)
        reason = (
            f"no discretisation up to {most} nodes meets {100 * auto.tolerance:g} % for {listed}: "
            "raise tolerance, or list other responses under discretisation.auto.responses"
        )
        raise StudyError(Problem(str(study.path), "discretisation.auto", reason))
    grid = recommended_grid(evidence, study.discretisation)
    assert grid is not None  # some response is requested, and all are reached
    return replace(study, discretisation=grid, auto=None)


def solve_along(
    study: ImpactStudy,
    cases: Mapping[str, Sequence[Value]],
    folder: Path,
    engine: Engine,
    axis: str,
    levels: Sequence[float],
    grid: Discretisation,
) -> tuple[xr.DataArray, xr.DataArray]:
    """Solve the corner cases of a study with these values of nodes, points or courant.

    folder: for the shards. levels: the values; the other two are those of `grid`. Returns values on
    (response, case, axis), NaN where a run failed, in SI units; and on (response, case), True where
    the model itself does not converge along this axis. Raises OSError when the disk is full or no
    scheduler answers.
    """
    fixed = flatten(study.impact, grid) | {"duration": study.duration}
    varied: dict[str, Any] = {name: ("case", np.array(values)) for name, values in cases.items()}
    varied["case"] = np.arange(len(next(iter(cases.values()))))
    varied[axis] = axis, np.array(levels)
    scalars = {name: ((), value) for name, value in fixed.items() if name not in varied}
    attrs: dict[str, Any] = {"study": study.name, "varied": [*cases, axis]}
    attrs["responses"] = list(study.responses)
    attrs |= {"histories": 0, "profiles": 0, "history_samples": study.store.samples}
    attrs |= series_sizes(study)
    if study.python:
        attrs["solver"] = resolve_name("impactlab.study.solvers.own:solver_name")(study)
    runs = execute(described(xr.Dataset(coords=scalars | varied, attrs=attrs)), folder, engine)
    values = usable(runs).transpose("response", "case", axis)
    coordinates = set(values.coords) - {*values.dims, "response_units", "response_long_name"}
    return values.drop_vars(coordinates), without_limit(
        runs, values, NODES.growth if axis == "nodes" else None, axis
    )


def corner_cases(study: ImpactStudy) -> dict[str, list[Value]]:
    """Return one value per parameter and case: numbers at extremes and middle, and all words.

    A grid's words come in all combinations. Those that a sample draws take turns: every word meets
    every corner, beside another word in each.

    Nodes, points and courant are not varied. Where nothing else is, the study's own impact is the
    one case.
    """
    varied = study.sampling.varied.items()
    ends = {name: _ends(entry) for name, entry in varied if name not in AXES}
    choices = {name: values for name, values in ends.items() if isinstance(values[0], str)}
    numbers = {name: values for name, values in ends.items() if name not in choices}
    signs, listed = corners(len(numbers)).tolist(), list(choices.values())
    pairs: Iterable[tuple[Iterable[Value], list[int]]] = product(product(*listed), signs)
    if study.sampling.words:
        pairs = [
            (
                [
                    options[(turn + index * corner) % len(options)]
                    for index, options in enumerate(listed)
                ],
                row,
            )
            for corner, row in enumerate(signs)
            for turn in range(max(map(len, listed)))
        ]
    rows = []
    for combination, row in pairs:
        levels = [values[1 + sign] for values, sign in zip(numbers.values(), row, strict=True)]
        rows.append((*combination, *levels))
    if not ends:
        return {"velocity": [study.impact.velocity]}
    return {name: [row[index] for row in rows] for index, name in enumerate([*choices, *numbers])}


def corners(count: int) -> NDArray[np.int64]:
    """Return the signs (cases, count) of all or some corners of a cube; the middle (0) is last."""
    middle = np.zeros((1, count), dtype=np.int64)
    if count == 0:
        return middle
    if count <= _ALL:
        signs = np.array(list(product((-1, 1), repeat=count)))
    else:
        half = hadamard(1 << (count - 1).bit_length())[:, :count]
        signs = np.concatenate([half, -half])
    return np.concatenate([signs, middle])


def _ends(entry: Any) -> Sequence[Any]:
    """Return (least, middle, greatest) of a varied number, or all words."""
    if isinstance(entry, Distribution):
        low, middle, high = entry.quantile(np.array([_TAIL, 0.5, 1.0 - _TAIL])).tolist()
        bounds = entry.bounds()
        return bounds.get("low", low), middle, bounds.get("high", high)
    entry = entry.values if isinstance(entry, Choice) else entry
    if isinstance(entry[0], str):
        return tuple(entry)
    ordered = sorted(entry)
    return ordered[0], ordered[len(ordered) // 2], ordered[-1]
