"""Sensitivity indices of a sample; where runs failed, a surrogate supplies their values."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.analysis import regimes
from impactlab.analysis.surrogate.chaos import drawn, fewest_runs
from impactlab.analysis.surrogate.from_runs import GOOD, Divided
from impactlab.methods import INDICES, indices_of, sobol, verdict_name
from impactlab.methods.record import (
    BY_SAMPLES,
    PAIR,
    IndexVariable,
    Indices,
    SensitivityVerdict,
    of_outputs,
    remarks,
)
from impactlab.methods.runs import Sample, correlations, labels, listed, usable
from impactlab.types import Floats
from impactlab.verdicts import flagged

MOST_IMPUTED = 0.2  # largest share of runs that may be supplied
FEWEST_PER_PARAMETER = 10  # good runs that a surrogate needs per parameter
_FEWEST_TESTS = 20
_AT_ONCE = 100_000  # runs that are predicted together


@dataclass(frozen=True)
class Imputation:
    """Outputs (runs,), complete unless the study wants none supplied or there is a refusal.

    share: of runs whose value a surrogate supplied. missed: the share of the variance that this
    surrogate misses, near the failed runs or elsewhere, whichever is more.
    """

    outputs: Floats
    refusal: SensitivityVerdict | None = None
    share: float = 0.0
    missed: float = 0.0

    @property
    def half_width(self) -> float:
        """Part of the half-width of an index that is a share, for the errors of supplied values.

        By the inequality of Cauchy and Schwarz, an index changes in proportion to the root of the
        variance of these errors over all runs.
        """
        return float(np.sqrt(self.share * self.missed))


def imputed(outputs: Floats, sample: Sample, response: str) -> Imputation:
    """Return outputs (runs,) with a surrogate's predictions in the place of NaN.

    They are returned as they are where none is NaN or the study does not ask for it
    (`failed_runs: impute`), and where too few runs are left or the surrogate misses more than a
    tenth of the variance. A mean would take away variance.
    """
    gaps = np.isnan(outputs)
    if not gaps.any() or sample.settings.get("failed_runs") != "impute":
        return Imputation(outputs)
    if sample.words or correlations(sample.runs):
        kind = f"words ({', '.join(sample.words)})" if sample.words else "correlated parameters"
        raise ValueError(
            f"{sample.study}: no surrogate is fitted over {kind}, so it cannot supply "
            "values: set failed_runs: fail"
        )
    parameters, number = len(sample.parameters), int(np.count_nonzero(~gaps))
    share = float(gaps.mean())
    if number < FEWEST_PER_PARAMETER * parameters or share > MOST_IMPUTED:
        return Imputation(outputs, SensitivityVerdict.TOO_FEW_RUNS)
    seed = int(sample.rng("surrogate", response).integers(1, 2**31))
    divided = Divided.of(sample.runs)
    tests = _tests(gaps, divided, seed)
    training = ~gaps
    training[np.concatenate(tests)] = False
    if np.count_nonzero(training) < fewest_runs(parameters):
        return Imputation(outputs, SensitivityVerdict.TOO_FEW_RUNS)
    chaos, _ = divided.fit(outputs, training, seed)
    variance = float(np.var(outputs[~gaps]))
    square = max(float(np.mean((chaos(divided.inputs(t)) - outputs[t]) ** 2)) for t in tests)
    missed = square / variance if variance > 0 else 0.0
    if not missed <= 1 - GOOD:
        return Imputation(outputs, SensitivityVerdict.POOR_SURROGATE)
    chaos, _ = divided.fit(outputs, ~gaps, seed)
    filled, failed = outputs.copy(), np.flatnonzero(gaps)
    for start in range(0, failed.size, _AT_ONCE):
        rows = failed[start : start + _AT_ONCE]
        filled[rows] = chaos(sample.rows(rows))
    return Imputation(filled, None, share, missed)


def _tests(gaps: NDArray[np.bool_], divided: Divided, seed: int) -> list[NDArray[np.int64]]:
    """Return positions of runs to test a surrogate on: those most like the failed, and a part.

    A surrogate reaches into a region where every run fails from outside of it. So do tests on runs
    at its rim, as many as failed: those for which a chaos of the failures predicts most.
    """
    rim, _ = divided.fit(gaps.astype(float), np.ones(gaps.size, bool), seed)
    good = np.flatnonzero(~gaps)
    good = np.random.default_rng(seed).permutation(good)[: drawn(good.size, seed).size]
    count = max(_FEWEST_TESTS, round(good.size * float(gaps.mean())))
    nearest = np.argsort(-rim(divided.inputs(good)), kind="stable")[:count]
    part = np.flatnonzero(~gaps & (divided.part == 0))
    return [np.sort(good[nearest]), part[drawn(part.size, seed)]]


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Return sensitivity indices of every response, by the methods the sample was drawn for.

    Returns their indices, on (response, *dims), with <name>_interval, the half-width of the
    interval; sensitivity_verdict, the worst verdict on the indices that the study names first;
    sensitivity_remarks, all on these; <name of the indices>_verdict, where there are several; and
    imputed_share (response).
    `parameter` holds the varied parameters, or their groups. Indices are NaN where the verdict
    gives none. Raises ValueError when the runs are not the sample that their attributes describe.
    """
    sample, records = Sample.of(runs), indices_of(runs.attrs)
    for record in records:
        record.check(sample)
    answers = [_answer(name, sample, records) for name in listed(runs, "responses")]
    verdicts, shares, rows = zip(*answers, strict=True)
    indices = {
        name: index
        for record in records
        for name, index in record.variables.items()
        if index.dims != PAIR or sample.number("second_order")
    }
    factors, coordinates = list(sample.factors), labels(runs)
    long_name = "group of varied parameters" if sample.groups else "varied parameter"
    coordinates["parameter"] = ("parameter", factors, {"long_name": long_name})
    dims = {index.dims for index in indices.values()}
    if PAIR in dims:
        coordinates[PAIR[1]] = (PAIR[1], factors, {"long_name": f"the other {long_name}"})
    if BY_SAMPLES in dims:
        attrs = {"long_name": "base samples used, the first of the sample", "units": "1"}
        coordinates[BY_SAMPLES[0]] = (BY_SAMPLES[0], sobol.base_samples(sample), attrs)
    variables = _variables(rows, indices, sample, coordinates)
    supplied = {"long_name": "share of runs whose value a surrogate supplied", "units": "1"}
    first = [entry[0] for entry in verdicts]
    variables |= {
        "sensitivity_verdict": _worst(first, "the sensitivity indices"),
        "sensitivity_remarks": remarks(first),
        "imputed_share": ("response", list(shares), supplied),
    }
    for number, record in enumerate(records if len(records) > 1 else ()):
        judged = _worst([entry[number] for entry in verdicts], f"the indices {record.name}")
        variables[f"{record.name}_verdict"] = judged
    return xr.Dataset(variables, coordinates)


def _worst(verdicts: Sequence[Sequence[SensitivityVerdict]], subject: str) -> xr.DataArray:
    codes = [int(max(entry, default=SensitivityVerdict.USABLE)) for entry in verdicts]
    array = xr.DataArray(codes, dims="response")
    return flagged(array, SensitivityVerdict, f"verdict on {subject}")


def _answer(
    response: str, sample: Sample, records: Sequence[Indices]
) -> tuple[list[list[SensitivityVerdict]], float, dict[str, Floats]]:
    """Return verdicts on each record's indices of a response, share supplied, and the indices."""
    outputs = usable(sample.runs, response).values[0]
    filled = imputed(outputs, sample, response)
    if filled.refusal is not None:
        return [[filled.refusal]] * len(records), 0.0, {}
    complete = filled.outputs
    varying = [part for record in records for part in record.varying(complete, sample)]
    verdicts = of_outputs(complete, varying, filled.share)
    if (
        max(verdicts, default=0) < SensitivityVerdict.CONSTANT
        and regimes.of_sample(sample, outputs).size
    ):
        verdicts.append(SensitivityVerdict.SEVERAL_REGIMES)
    if verdicts and max(verdicts) >= SensitivityVerdict.CONSTANT:
        return [verdicts] * len(records), 0.0, {}
    judgements = []
    indices: dict[str, Floats] = {}
    for record in records:
        estimates = record.estimate(complete, sample, response)
        for name, index in record.variables.items():
            if (key := f"{name}_interval") in estimates:
                # Of an index with a unit, such as a mean effect, the largest is the scale; else 1.
                scale = 1.0 if index.units else np.abs(estimates[name]).max()
                estimates[key] = estimates[key] + filled.half_width * scale
        indices |= estimates
        judgements.append(verdicts + record.judge(estimates))
    return judgements, filled.share, indices


def _variables(
    rows: Sequence[Mapping[str, Floats]],
    indices: Mapping[str, IndexVariable],
    sample: Sample,
    coordinates: Mapping[str, Any],
) -> dict[str, Any]:
    """Return indices and half-widths from one mapping per response; an empty one is NaN."""
    settings: dict[str, Any] = {"confidence": sample.confidence}
    if "replicates" not in sample.settings:
        settings["resamples"] = sample.resamples
    variables: dict[str, Any] = {}
    for name, index in indices.items():
        attrs = {"long_name": index.long_name, "estimator": index.estimator}
        attrs |= {"units": index.units} if index.units else {}
        attrs |= {"comment": index.comment} if index.comment else {}
        interval = f"{100 * sample.confidence:g} % interval of the {index.long_name}"
        margin = attrs | {"long_name": f"half-width of the {interval}"} | settings
        gap = np.full([len(coordinates[dim][1]) for dim in index.dims], np.nan)
        for key, metadata in ((name, attrs), (f"{name}_interval", margin))[: 1 + index.interval]:
            stacked = np.array([row[key] if row else gap for row in rows], float)
            variables[key] = (("response", *index.dims), stacked, metadata)
    return variables


_BESIDE = ("sensitivity_verdict", "sensitivity_remarks", "imputed_share")
_HISTORIES = "history"  # the dimension of the indices of histories, which have no response
_LABELS = ("response", "parameter", "other_parameter", "base_samples")
COLUMNS = (*_LABELS, "index", "value", "low", "high", "units", "verdict")
"""Of the table. low, high: ends of the interval of the value. units: of all three."""


def sensitivity_variables(analysis: xr.Dataset) -> xr.Dataset:
    """Return the sensitivity variables of an analysis: indices, intervals and verdicts."""
    names = [
        name
        for name, array in analysis.items()
        if name in (*_BESIDE, *(f"{record}_verdict" for record in INDICES))
        or _HISTORIES in array.dims
        or (
            {"response"} <= set(array.dims) <= set(_LABELS)
            and ("estimator" in array.attrs or "parameter" in array.dims)
        )
    ]
    return analysis[names]


def _verdict_of(name: str, analysis: xr.Dataset) -> str:
    return verdict_name(analysis, lambda record: name in record.variables)


def table_rows(analysis: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield every index of every response by COLUMNS; that of a pair of parameters once.

    A history stands in the column of the responses; of it the table has the generalised indices
    alone. Columns that have no meaning for an index are left out; low and high are NaN without
    interval.
    """
    for name, index in sensitivity_variables(analysis).items():
        of_history = _HISTORIES in index.dims
        if str(name).endswith(("_interval", "_verdict")) or name in _BESIDE:
            continue
        if of_history and ("time" in index.dims or "parameter" not in index.dims):
            continue
        margin = analysis.get(f"{name}_interval", xr.full_like(index, np.nan))
        judged = analysis["history_verdict" if of_history else _verdict_of(str(name), analysis)]
        columns = {
            "value": index,
            "low": index - margin,
            "high": index + margin,
            "units": index.attrs.get("units", analysis.get("response_units", "")),
            "verdict": (judged.dims, np.array(judged.attrs["flag_meanings"].split())[judged]),
        }
        frame = xr.Dataset(columns).to_dataframe([str(dim) for dim in index.dims])
        order = analysis.get("parameter", analysis["response"]).values.tolist()
        table = frame.reset_index().rename(columns={_HISTORIES: "response"})
        for row in table.to_dict("records"):
            if "other_parameter" not in row or (
                order.index(row["parameter"]) < order.index(row["other_parameter"])
            ):
                yield {"index": name} | row
