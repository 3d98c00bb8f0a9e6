"""From runs.nc to analysis.nc: every analysis that applies, and what the grid does to indices.

The numerical uncertainty of an index is a variable beside it. It is measured where the first base
samples of a Sobol sample were solved again on other grids. All grids see the same points of the
sample, so that the sampling error of an index nearly cancels in its change from grid to grid; the
replicates of the sample tell what is left of it. Elsewhere it is bounded by the uncertainty of the
responses, as if none of it were common to all runs.
"""

from collections.abc import Mapping
from pkgutil import resolve_name
from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis import ANALYSES
from impactlab.analysis.convergence import points
from impactlab.analysis.convergence.extrapolation import SAFETY_CREDIBLE, SAFETY_DOUBTFUL, estimate
from impactlab.analysis.sensitivity.indices import imputed
from impactlab.methods import sobol
from impactlab.methods.record import still, tail, with_numerical_error
from impactlab.methods.runs import Sample, half_width, in_order, labels, listed, usable
from impactlab.methods.saltelli import Outputs, estimates
from impactlab.types import Floats
from impactlab.variables import of_function
from impactlab.verdicts import ROUND_OFF, Verdict, flagged

ORDERS = ("first_order", "total_order")
_MEASURED = (
    "change of the index with half the spacing and with more points, on the first {} base samples, "
    "extrapolated to the limit, where numerical_from says so; elsewhere "
)
_BOUND = "2 e sqrt(S) + e^2 of an index S, with e^2 the numerical_share"


class NumericalFrom(Verdict):
    """The basis of the numerical uncertainty of a response's indices."""

    MEASURED = True, "the change of the indices themselves on finer grids"
    BOUND = True, "a cautious bound from the error of the response in corner cases"
    NOTHING = False, "nothing tells what the discretisation does to the indices"


def numerical(
    runs: xr.Dataset,
    analysis: xr.Dataset,
    resolution: xr.Dataset | None = None,
    refinement: xr.Dataset | None = None,
) -> xr.Dataset:
    """Return the numerical uncertainty of each response, and of its indices; no unit.

    runs: a sample or a grid; analysis: of them; resolution, refinement: see
    adaptive.recommendation and adaptive.sobol, of the same study.

    Returns of a resolution numerical_uncertainty (response), relative, the worst over the corner
    cases, and of a sample numerical_share (response), (u/sigma)^2 with u the root mean square of
    the uncertainty over the corner cases and sigma the standard deviation over the runs; of a
    refinement <order>_change (response, parameter) and its interval, see `measured`. Of either
    <order>_numerical (response, parameter), by how much the first_order and the total_order may be
    off, and numerical_from (response). An index S lies between 0 and 1: it is off by no more than
    the larger of S and 1 - S, whatever bounds the error or not. Raises ValueError when resolution
    or refinement is not of these runs.

    The bound: an index is the square of the length of a projection of the response over that of
    the response, and an error of relative length e moves either length by no more than e, so that
    an index S is moved by no more than about 2 e sqrt(S) + e^2.
    """
    variables = {} if resolution is None else _of_responses(runs, resolution)
    changed, estimator = xr.Dataset(), _BOUND
    if refinement is not None:
        _check_refinement(runs, refinement)
        changed = measured(refinement)
        estimator = _MEASURED.format(refinement.attrs["base_samples"]) + _BOUND
    nothing = xr.full_like(analysis["response"], np.inf, dtype=float).reset_coords(drop=True)
    share = variables.get("numerical_share", nothing)
    orders = [order for order in ORDERS if order in analysis]
    for order in orders:
        index = analysis[order]
        bound = 2.0 * share**0.5 * index.clip(min=0.0) ** 0.5 + share
        distance = changed.get(order, xr.full_like(bound, np.nan))
        amount = xr.where(distance.notnull(), distance, bound)
        most = (1.0 - index).where(index < 0.5, index)
        amount = amount.where(amount < most, most).where(index.notnull())
        variables[f"{order}_numerical"] = amount.transpose(*index.dims).assign_attrs(
            long_name=f"how far the {order.replace('_', '-')} index may be off numerically",
            units="1",
            estimator=estimator,
        )
    if orders:
        refined = changed[orders[0]].notnull().any("parameter") if changed else share.isnull()
        otherwise = xr.where(np.isfinite(share), NumericalFrom.BOUND, NumericalFrom.NOTHING)
        variables["numerical_from"] = flagged(
            xr.where(refined, NumericalFrom.MEASURED, otherwise),
            NumericalFrom,
            "what the numerical uncertainty of the indices rests on",
        )
    parts = xr.Dataset(variables), changed.drop_vars(ORDERS, errors="ignore")
    return xr.merge(parts, join="exact", compat="equals").reset_coords(drop=True)


def _of_responses(runs: xr.Dataset, resolution: xr.Dataset) -> dict[str, xr.DataArray]:
    """Return numerical_uncertainty and numerical_share. Raises ValueError for other runs' ones."""
    again = f"make it again (impactlab recommend studies/{runs.attrs.get('study', 'NAME')}.yaml)"
    for name in ("nodes", "points", "courant"):
        used, expected = runs[name].values, resolution.attrs.get(f"grid_{name}")
        if used.ndim or used != expected:
            raise ValueError(
                f"the resolution was found for {name} = {expected}, the runs have {used}: {again}"
            )
    if runs.attrs.get("study_sha256") != resolution.attrs.get("study_sha256"):
        raise ValueError(f"the resolution was found for another text of the study file: {again}")
    names = listed(runs, "responses")
    requested = resolution.sel(response=names).reset_coords(drop=True)
    long_name = "relative numerical uncertainty, the worst of the corner cases"
    relative = requested["grid_relative"].assign_attrs(long_name=long_name, units="1")
    if "run" not in runs.dims:
        return {"numerical_uncertainty": relative}
    deviations = [usable(runs, name).std(set(runs["status"].dims)) for name in names]
    deviation = xr.concat(deviations, "response", coords="minimal", compat="override")
    squares = (requested["grid_uncertainty"] ** 2).mean("case")
    share = (squares / deviation.where(deviation > 0) ** 2).where(squares > 0, 0.0)
    meaning = "share of the variance that may be numerical error"
    share = share.fillna(np.inf).reset_coords(drop=True).assign_attrs(long_name=meaning, units="1")
    return {"numerical_uncertainty": relative, "numerical_share": share}


USED, FINER, COARSER, MORE_POINTS = "used", "finer", "coarser", "more_points"
TAIL_SHARE = 0.25
"""Largest share of the variance that one run in a hundred may carry (normal response: 0.09).

Above, single runs decide, such as those in which a further impact falls into the first contact:
which of them another grid moves, and whether it moves one, so few base samples cannot tell.
"""
_TO_LIMIT = 2.0  # distance to the limit over change, where each refinement takes half of the error


def _check_refinement(runs: xr.Dataset, refinement: xr.Dataset) -> None:
    """Raise ValueError unless the used grid of the refinement gives what the runs give."""
    refined, ordered = usable(refinement).sel(grid=USED), in_order(runs)
    numbers, refined_numbers = ordered["run"].values, refined["run"].values
    places = np.searchsorted(numbers, refined_numbers).clip(max=numbers.size - 1)
    original = usable(ordered.isel(run=places)).transpose(*refined.dims)
    same = np.allclose(original, refined, rtol=ROUND_OFF, atol=0.0, equal_nan=True)
    if not same or (numbers[places] != refined_numbers).any():
        raise ValueError(
            "the refinement was made from other runs: make it again (impactlab refine "
            f"results/{runs.attrs.get('study', 'NAME')}/runs.nc)"
        )


def measured(refinement: xr.Dataset) -> xr.Dataset:
    """Return how far the indices of the used grid may lie from those in the limit.

    Returns for each of ORDERS, on (response, parameter) and without unit: <order>, that distance;
    <order>_change, from the used to the finer grid, and <order>_change_interval, the half-width of
    its interval. NaN where a grid gives no index, and where few runs carry the variance
    (TAIL_SHARE). Raises ValueError when the runs are not the sample that their attributes describe.

    The distance is the change to the finer grid and as much again from there to the limit (first
    order) times SAFETY_DOUBTFUL, or SAFETY_CREDIBLE where the coarser grid, too, shows that the
    changes fall to a half or less; and points.SAFETY times the change with more points (both as for
    responses, see analysis.convergence). Each change is known to within its half-width, and the
    limit is twice as far off.
    """
    sample = Sample.of(refinement)
    sobol.check(sample)
    values = usable(refinement).sortby("run").transpose("response", "grid", "run")
    nodes = refinement["nodes"].values.astype(float)
    spacings = dict(zip(refinement["grid"].values.tolist(), 1.0 / (nodes - 1.0), strict=True))
    names = [str(name) for name in values["response"].values]
    pairs = zip(names, values.values, strict=True)
    rows = [_of_response(name, outputs, spacings, sample) for name, outputs in pairs]
    gap = np.full(len(sample.factors), np.nan)
    used = f"on the first {refinement.attrs['base_samples']} base samples"
    dataset = xr.Dataset(coords={"response": names, "parameter": list(sample.factors)})
    for order in ORDERS:
        description = f"change of the {order.replace('_', '-')} index with half the spacing, {used}"
        change = {"long_name": description, "units": "1"}
        width = change | {"long_name": f"half-width of the interval of the {description}"}
        for ending, attrs in (("", {}), ("_change", change), ("_change_interval", width)):
            stacked = [row.get(f"{order}{ending}", gap) for row in rows]
            dataset[f"{order}{ending}"] = (("response", "parameter"), stacked, attrs)
    return dataset


def _of_response(
    name: str, outputs: Floats, spacings: Mapping[str, float], sample: Sample
) -> dict[str, Floats]:
    """Analyse one response; empty where a grid gives no index. outputs: (grid, run)."""
    replicated, factors = [], len(sample.factors)
    for row in outputs:
        complete = imputed(row, sample, name).outputs
        if not np.isfinite(complete).all():
            return {}
        if still(complete, sobol.varying(complete, sample)) or tail(complete) > TAIL_SHARE:
            return {}
        replicated.append(estimates(Outputs.of(complete, sample).means(), factors))
    answer: dict[str, Floats] = {}
    for order in ORDERS:
        indices = {
            grid: estimate[order] for grid, estimate in zip(spacings, replicated, strict=True)
        }
        changes = {grid: values - indices[USED] for grid, values in indices.items()}
        change = {grid: values[0] for grid, values in changes.items()}
        width = {
            grid: half_width(values[1:], sample.confidence) for grid, values in changes.items()
        }
        by_spacing = (1.0 + _safety(change, spacings)) * abs(change[FINER])
        by_points = points.SAFETY * abs(change[MORE_POINTS])
        by_chance = _TO_LIMIT * (width[FINER] + width[MORE_POINTS])
        answer |= {
            order: by_spacing + by_points + by_chance,
            f"{order}_change": change[FINER],
            f"{order}_change_interval": width[FINER],
        }
    return answer


def _safety(change: Mapping[str, Floats], spacings: Mapping[str, float]) -> Floats:
    """Return safety factors beyond the finer grid; both they and the changes are (factor,)."""
    if COARSER not in change:
        return np.full_like(change[FINER], SAFETY_DOUBTFUL)
    steps = [spacings[grid] for grid in (FINER, USED, COARSER)]
    changes = zip(change[FINER], change[USED], change[COARSER], strict=True)
    triples = [estimate(three, steps) for three in changes]
    falling = [triple.credible and triple.order >= 1.0 for triple in triples]
    return np.where(falling, SAFETY_CREDIBLE, SAFETY_DOUBTFUL)


def analyse(
    runs: xr.Dataset, resolution: xr.Dataset | None = None, refinement: xr.Dataset | None = None
) -> xr.Dataset:
    """Return convergence, sensitivity and distributions of a study, whichever apply.

    Parameters
    ----------
    runs : xarray.Dataset
        Solved study as in runs.nc, in SI units. Its attribute `analyses` lists the requested
        analyses (impactlab.analysis.ANALYSES); without it, all are.
    resolution : xarray.Dataset, optional
        Result of `Study.recommend` for this study: adds the numerical uncertainty of the responses.
    refinement : xarray.Dataset, optional
        Result of `Study.refine` for this study: adds the measured change of the indices.

    Returns
    -------
    xarray.Dataset
        Variables of the analyses that apply, on `response` and the dimensions that they leave, with
        the attributes of the runs; without any, the coordinates of the responses alone.

    Raises
    ------
    ValueError
        If the runs are not a study's, or contradict their attributes.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Ishigami", function="ishigami", sampling=il.Sobol(base_samples=256, parameters={
    ...         name: il.Uniform("-3.14", "3.14") for name in ("x1", "x2", "x3")}))
    >>> indices = il.analyse(study.run(workers=1))
    >>> indices.total_order.sel(response="value", parameter=["x2", "x3"]).round(1).values
    array([0.5, 0.2])
    """
    if "responses" not in runs.attrs:
        raise ValueError(
            "the runs are not those of a study: analyse what il.Study(...).run() gives"
        )
    names = {str(name) for name in np.atleast_1d(runs.attrs.get("analyses", list(ANALYSES)))}
    axes = {} if of_function(runs) else runs.sizes  # a function has no discretisation
    plan: Any = runs.attrs.get("method"), axes, True
    entries = [ANALYSES[name] for name in ANALYSES if name in names]
    parts = [resolve_name(entry.place).analysis(runs) for entry in entries if entry.possible(*plan)]
    requested = xr.Dataset(coords=labels(runs))
    merged = xr.merge([requested, *parts], join="exact", compat="equals", combine_attrs="override")
    if "parameter" in merged.coords:
        long_names = [_long_name(runs, str(name)) for name in merged["parameter"].values]
        merged = merged.assign_coords(parameter_long_name=("parameter", long_names))
    if resolution is not None or refinement is not None:
        merged = merged.merge(numerical(runs, merged, resolution, refinement), join="exact")
        merged = with_numerical_error(merged)
    return merged.assign_attrs(runs.attrs).drop_encoding()


def _long_name(runs: xr.Dataset, factor: str) -> str:
    """Return the meaning of a parameter, or the name of a group of them in words."""
    attrs = runs[factor].attrs if factor in runs.coords else {}
    return str(attrs.get("long_name", factor.replace("_", " ")))
