"""From the runs of a sample study to its indices, with a verdict on each response."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis.responses import usable
from impactlab.analysis.sensitivity import imputation, sobol, verdict
from impactlab.analysis.sensitivity.imputation import Fit
from impactlab.analysis.sensitivity.index import BY_SAMPLES, PAIR, Index, stored
from impactlab.analysis.sensitivity.methods import METHODS, Method
from impactlab.analysis.sensitivity.sample import Array, Sample
from impactlab.analysis.sensitivity.verdict import SensitivityVerdict
from impactlab.analysis.surrogate import fit
from impactlab.analysis.verdicts import flagged

Answer = tuple[list[SensitivityVerdict], float, dict[str, Array]]
"""What is said of a response, share of its runs that a surrogate supplied, and indices if any."""


def applies(runs: xr.Dataset) -> bool:
    """Whether the runs are a sample of one of the methods."""
    return runs.attrs.get("method") in METHODS


def analysis(runs: xr.Dataset, fit: Fit = fit) -> xr.Dataset:
    """Sensitivity indices of every response, by the method that the sample was drawn for.

    fit: makes the surrogate that supplies failed runs where the study asks for it
    (`failed_runs: impute`).

    Returns what the method's module lists, on (response, *dims), with <name>_interval, the
    half-width of the bootstrap interval; sensitivity_verdict, the worst that is to be said;
    sensitivity_remarks, all of it; and imputed_share (response).
    `parameter` holds the varied parameters, or their groups. Indices are NaN where the verdict
    gives none. Raises ValueError when the runs are not the sample that their attributes tell of.
    """
    sample, method = Sample.of(runs), METHODS[str(runs.attrs["method"])]
    method.check(sample)
    values = usable(runs).sortby("run").transpose("response", "run")
    names = [str(name) for name in values["response"].values]
    answers = [
        _answer(name, row, sample, method, fit)
        for name, row in zip(names, values.values, strict=True)
    ]
    said, shares, rows = zip(*answers, strict=True)
    wanted = method.indices(sample)
    coordinates = _coordinates(values, sample, wanted)
    sizes = {name: len(entry[1]) for name, entry in coordinates.items()}
    worst = [max(entry, default=SensitivityVerdict.USABLE) for entry in said]
    codes = xr.DataArray([int(judgement) for judgement in worst], dims="response")
    return xr.Dataset(stored(rows, wanted, sample, sizes), coords=coordinates).assign(
        sensitivity_verdict=flagged(
            codes, SensitivityVerdict, "verdict on the sensitivity indices"
        ),
        sensitivity_remarks=verdict.remarks(said),
        imputed_share=("response", np.array(shares), _IMPUTED),
    )


_IMPUTED = {"long_name": "share of runs whose value a surrogate supplied", "units": "1"}


def _answer(response: str, outputs: Array, sample: Sample, method: Method, fit: Fit) -> Answer:
    """Of one response; outputs: (runs,), NaN where a run failed."""
    share = 0.0
    if np.isnan(outputs).any() and sample.policy == "impute":
        if not imputation.possible(outputs, sample):
            return [SensitivityVerdict.TOO_FEW_RUNS], share, {}
        share = float(np.isnan(outputs).mean())
        outputs = imputation.completed(outputs, sample, fit, response)
    said = verdict.of_outputs(outputs, method.varying(outputs, sample), share)
    if set(said) & set(verdict.NO_INDEX):
        return said, 0.0, {}
    found = method.estimate(outputs, sample, response)
    return said + verdict.of_indices(found), share, found


def _coordinates(
    values: xr.DataArray, sample: Sample, wanted: dict[str, Index]
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
