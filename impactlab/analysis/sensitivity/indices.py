"""Sensitivity indices of the runs of a sample, as a dataset and as a table."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Mapping
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.stats import rankdata

from impactlab.analysis.responses import usable
from impactlab.analysis.sensitivity import delta, fast, morris, pawn, regression, sobol, verdict
from impactlab.analysis.sensitivity.method import (
    BY_SAMPLES,
    PAIR,
    Array,
    Index,
    Sample,
    SensitivityMethod,
    index_variables,
)
from impactlab.analysis.sensitivity.verdict import SensitivityVerdict
from impactlab.analysis.surrogate import fit
from impactlab.analysis.verdicts import flagged

METHODS: Mapping[str, SensitivityMethod] = {
    method.name: method
    for method in (
        sobol.METHOD,
        morris.METHOD,
        fast.METHOD,
        delta.METHOD,
        pawn.METHOD,
        regression.METHOD,
    )
}
"""By their names in study files."""

Answer = tuple[list[SensitivityVerdict], float, dict[str, Array]]
"""Verdicts on a response, share of its runs that a surrogate supplied, and indices if any."""


def applies(runs: xr.Dataset) -> bool:
    """Return True if the runs are a sample of one of the methods."""
    return runs.attrs.get("method") in METHODS


def analysis(runs: xr.Dataset, fit: Fit = fit) -> xr.Dataset:
    """Return sensitivity indices of every response, by the method the sample was drawn for.

    fit: makes the surrogate that supplies failed runs where the study asks for it
    (`failed_runs: impute`).

    Returns the indices of the method, on (response, *dims), with <name>_interval, the half-width
    of the bootstrap interval; sensitivity_verdict, the worst verdict; sensitivity_remarks, all of
    them; and imputed_share (response).
    `parameter` holds the varied parameters, or their groups. Indices are NaN where the verdict
    gives none. Raises ValueError when the runs are not the sample that their attributes describe.
    """
    sample, method = Sample.of(runs), METHODS[str(runs.attrs["method"])]
    method.check(sample)
    values = usable(runs).sortby("run").transpose("response", "run")
    names = [str(name) for name in values["response"].values]
    answers = [
        _answer(name, row, sample, method, fit)
        for name, row in zip(names, values.values, strict=True)
    ]
    verdicts, shares, rows = zip(*answers, strict=True)
    wanted = method.indices(sample)
    coordinates = _coordinates(values, sample, wanted)
    sizes = {name: len(entry[1]) for name, entry in coordinates.items()}
    worst = [max(entry, default=SensitivityVerdict.USABLE) for entry in verdicts]
    codes = xr.DataArray([int(judgement) for judgement in worst], dims="response")
    return xr.Dataset(index_variables(rows, wanted, sample, sizes), coords=coordinates).assign(
        sensitivity_verdict=flagged(
            codes, SensitivityVerdict, "verdict on the sensitivity indices"
        ),
        sensitivity_remarks=verdict.remarks(verdicts),
        imputed_share=("response", np.array(shares), _IMPUTED),
    )


_IMPUTED = {"long_name": "share of runs whose value a surrogate supplied", "units": "1"}


def _answer(
    response: str, outputs: Array, sample: Sample, method: SensitivityMethod, fit: Fit
) -> Answer:
    """Analyse one response; outputs: (runs,), NaN where a run failed."""
    share = 0.0
    if np.isnan(outputs).any() and sample.policy == "impute":
        if not can_impute(outputs, sample):
            return [SensitivityVerdict.TOO_FEW_RUNS], share, {}
        share = float(np.isnan(outputs).mean())
        outputs = imputed(outputs, sample, fit, response)
    verdicts = verdict.of_outputs(outputs, method.varying(outputs, sample), share)
    if set(verdicts) & set(verdict.NO_INDEX):
        return verdicts, 0.0, {}
    found = method.estimate(outputs, sample, response)
    return verdicts + verdict.of_indices(found), share, found


def _coordinates(
    values: xr.DataArray, sample: Sample, wanted: Mapping[str, Index]
) -> dict[str, tuple[Any, ...]]:
    factors = list(sample.factors)
    what = "group of varied parameters" if sample.groups else "varied parameter"
    coordinates: dict[str, tuple[Any, ...]] = {
        str(name): ("response", array.values, array.attrs)
        for name, array in values.coords.items()
        if array.dims == ("response",)
    }
    coordinates["parameter"] = ("parameter", factors, {"long_name": what})
    dims = {index.dims for index in wanted.values()}
    if PAIR in dims:
        coordinates[PAIR[1]] = (PAIR[1], factors, {"long_name": f"the other {what}"})
    if BY_SAMPLES in dims:
        attrs = {"long_name": "base samples used, the first of the sample", "units": "1"}
        coordinates[BY_SAMPLES[0]] = (BY_SAMPLES[0], sobol.base_samples(sample), attrs)
    return coordinates


Predict = Callable[[Array], Array]
"""From places (runs, parameters) in the unit cube to values (runs,)."""
Fit = Callable[[Array, Array, int], Predict]
"""From places (runs, parameters) in the unit cube, values (runs,), and a seed to a surrogate."""

MOST_IMPUTED = 0.2
"""Largest share of runs that may be supplied."""
FEWEST_PER_PARAMETER = 10
"""Good runs that a surrogate needs per parameter."""


def can_impute(outputs: Array, sample: Sample) -> bool:
    """Return True if enough runs are left to supply the others."""
    gaps = int(np.isnan(outputs).sum())
    good = outputs.size - gaps
    return gaps <= MOST_IMPUTED * outputs.size and good >= FEWEST_PER_PARAMETER * len(
        sample.parameters
    )


def imputed(outputs: Array, sample: Sample, fit: Fit, response: str) -> Array:
    """Return outputs (runs,) with the surrogate's predictions in the place of NaN.

    A mean would take away variance; the share of supplied runs is stored beside the indices.
    """
    gaps = np.isnan(outputs)
    if not gaps.any():
        return outputs
    places = unit_ranks(sample.inputs)
    seed = int(sample.rng("surrogate", response).integers(1, 2**31))
    predict = fit(places[~gaps], outputs[~gaps], seed)
    filled = outputs.copy()
    filled[gaps] = predict(places[gaps])
    return filled


def unit_ranks(inputs: Array) -> Array:
    """Return places (runs, parameters) in the open unit cube: the share of runs below each value.

    In a sample as even as those of sensitivity analyses, this is the probability to 1/runs,
    whatever the distribution.
    """
    return np.asarray((rankdata(inputs, axis=0) - 0.5) / len(inputs))


_OF = ("parameter", "other_parameter", "base_samples")
_BESIDE = ("sensitivity_verdict", "sensitivity_remarks", "imputed_share")


@dataclass(frozen=True)
class Row:
    """One index. low, high: ends of its interval; NaN where there is none. units: of all three."""

    response: str
    parameter: str
    other_parameter: str
    base_samples: str
    index: str
    value: float
    low: float
    high: float
    units: str
    verdict: str


def sensitivity_variables(analysis: xr.Dataset) -> xr.Dataset:
    """Return the sensitivity variables of an analysis: indices, intervals and verdicts."""
    wanted = [name for name in analysis.data_vars if _is_index(analysis[name]) or name in _BESIDE]
    return analysis[wanted]


def table_rows(analysis: xr.Dataset) -> Iterator[Row]:
    """Yield every index of every response; that of a pair of parameters once."""
    for name, array in sensitivity_variables(analysis).data_vars.items():
        if not str(name).endswith("_interval") and name not in _BESIDE:
            yield from _rows(analysis, array)


def write_csv(analysis: xr.Dataset, path: Path) -> None:
    """Write the rows under their names, in UTF-8; missing values are empty cells."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(field.name for field in fields(Row))
        writer.writerows(map(_cells, table_rows(analysis)))


def _rows(analysis: xr.Dataset, array: xr.DataArray) -> Iterator[Row]:
    margins = analysis.get(f"{array.name}_interval", xr.full_like(array, np.nan))
    margins = margins.transpose(*array.dims)
    verdicts = _verdicts(analysis["sensitivity_verdict"])
    units = analysis.get("response_units", xr.full_like(analysis["response"], ""))
    for place in np.ndindex(array.shape):
        at = dict(zip(map(str, array.dims), place, strict=True))
        if "other_parameter" in at and at["parameter"] >= at["other_parameter"]:
            continue
        labels = {dim: str(array[dim].values[at[dim]]) if dim in at else "" for dim in _OF}
        value, margin, response = float(array[at]), float(margins[at]), at["response"]
        yield Row(
            response=str(array["response"].values[response]),
            index=str(array.name),
            value=value,
            low=value - margin,
            high=value + margin,
            units=str(array.attrs.get("units", units.values[response])),
            verdict=verdicts[response],
            **labels,
        )


def _is_index(array: xr.DataArray) -> bool:
    known = set(array.dims) <= {"response", *_OF} and "response" in array.dims
    return known and ("estimator" in array.attrs or "parameter" in array.dims)


def _verdicts(array: xr.DataArray) -> list[str]:
    flags = np.atleast_1d(array.attrs["flag_values"]).tolist()
    names = dict(zip(flags, str(array.attrs["flag_meanings"]).split(), strict=True))
    return [names[code] for code in array.values.tolist()]


def _cells(row: Row) -> list[str]:
    cells = astuple(row)
    return ["" if isinstance(cell, float) and np.isnan(cell) else str(cell) for cell in cells]
