"""Sensitivity indices of the runs of a sample, as a dataset and as a table."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.analysis.responses import Sample, correlations, labels, listed, usable
from impactlab.analysis.sensitivity import delta, fast, morris, pawn, regression, sobol, verdict
from impactlab.analysis.sensitivity.method import BY_SAMPLES, PAIR, Index, Method
from impactlab.analysis.sensitivity.verdict import SensitivityVerdict
from impactlab.analysis.surrogate import fit
from impactlab.analysis.surrogate.chaos import drawn
from impactlab.analysis.verdicts import flagged
from impactlab.types import Floats

METHODS: Mapping[str, Method] = {
    module.METHOD.name: module.METHOD for module in (sobol, morris, fast, delta, pawn, regression)
}
"""By their names in study files."""


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Return sensitivity indices of every response, by the method the sample was drawn for.

    Returns the indices of the method, on (response, *dims), with <name>_interval, the half-width
    of the bootstrap interval; sensitivity_verdict, the worst verdict; sensitivity_remarks, all of
    them; and imputed_share (response).
    `parameter` holds the varied parameters, or their groups. Indices are NaN where the verdict
    gives none. Raises ValueError when the runs are not the sample that their attributes describe.
    """
    sample, method = Sample.of(runs), METHODS[str(runs.attrs["method"])]
    method.check(sample)
    answers = [_answer(name, sample, method) for name in listed(runs, "responses")]
    verdicts, shares, rows = zip(*answers, strict=True)
    wanted = {
        name: index
        for name, index in method.indices.items()
        if index.dims != PAIR or sample.number("second_order")
    }
    factors, coordinates = list(sample.factors), labels(runs)
    what = "group of varied parameters" if sample.groups else "varied parameter"
    coordinates["parameter"] = ("parameter", factors, {"long_name": what})
    dims = {index.dims for index in wanted.values()}
    if PAIR in dims:
        coordinates[PAIR[1]] = (PAIR[1], factors, {"long_name": f"the other {what}"})
    if BY_SAMPLES in dims:
        attrs = {"long_name": "base samples used, the first of the sample", "units": "1"}
        coordinates[BY_SAMPLES[0]] = (BY_SAMPLES[0], sobol.base_samples(sample), attrs)
    variables = _variables(rows, wanted, sample, coordinates)
    worst = [max(entry, default=SensitivityVerdict.USABLE) for entry in verdicts]
    codes = xr.DataArray([int(judgement) for judgement in worst], dims="response")
    supplied = {"long_name": "share of runs whose value a surrogate supplied", "units": "1"}
    judged = flagged(codes, SensitivityVerdict, "verdict on the sensitivity indices")
    variables |= {
        "sensitivity_verdict": judged,
        "sensitivity_remarks": verdict.remarks(verdicts),
        "imputed_share": ("response", list(shares), supplied),
    }
    return xr.Dataset(variables, coordinates)


def _answer(
    response: str, sample: Sample, method: Method
) -> tuple[list[SensitivityVerdict], float, dict[str, Floats]]:
    """Return verdicts, share of runs that a surrogate supplied, and indices of a response."""
    outputs = usable(sample.runs, response).values[0]
    complete = imputed(outputs, sample, response)
    if complete is None:
        return [SensitivityVerdict.TOO_FEW_RUNS], 0.0, {}
    share = 0.0 if complete is outputs else float(np.isnan(outputs).mean())
    verdicts = verdict.of_outputs(complete, method.varying(complete, sample), share)
    if verdicts and max(verdicts) >= SensitivityVerdict.CONSTANT:
        return verdicts, 0.0, {}
    found = method.estimate(complete, sample, response)
    return verdicts + verdict.of_indices(found), share, found


def _variables(
    rows: Sequence[Mapping[str, Floats]],
    wanted: Mapping[str, Index],
    sample: Sample,
    coordinates: Mapping[str, Any],
) -> dict[str, Any]:
    """Return indices and half-widths from one mapping per response; an empty one is NaN."""
    settings = {"confidence": sample.confidence, "resamples": sample.resamples}
    variables: dict[str, Any] = {}
    for name, index in wanted.items():
        attrs = {"long_name": index.long_name, "estimator": index.estimator}
        attrs |= {"units": index.units} if index.units else {}
        attrs |= {"comment": index.comment} if index.comment else {}
        words = f"{100 * sample.confidence:g} % interval of the {index.long_name}"
        margin = attrs | {"long_name": f"half-width of the {words}"} | settings
        gap = np.full([len(coordinates[dim][1]) for dim in index.dims], np.nan)
        for key, own in ((name, attrs), (f"{name}_interval", margin))[: 1 + index.interval]:
            stacked = np.array([row[key] if row else gap for row in rows], float)
            variables[key] = (("response", *index.dims), stacked, own)
    return variables


MOST_IMPUTED = 0.2  # largest share of runs that may be supplied
FEWEST_PER_PARAMETER = 10  # good runs that a surrogate needs per parameter
_AT_ONCE = 100_000  # runs that are predicted together


def imputed(outputs: Floats, sample: Sample, response: str) -> Floats | None:
    """Return outputs (runs,) with a surrogate's predictions in the place of NaN.

    They are returned as they are where none is NaN or the study does not ask for it
    (`failed_runs: impute`); None where too few runs are left. A mean would take away variance; the
    share of supplied runs is stored beside the indices. The runs that the surrogate is fitted to
    are picked here: the places of all may not fit into memory.

    The surrogate's place of a value is the share of runs below it. In a sample as even as those of
    sensitivity analyses, this is the probability to 1/runs, whatever the distribution.
    """
    gaps = np.isnan(outputs)
    if not gaps.any() or sample.settings.get("failed_runs") != "impute":
        return outputs
    over = f"words ({', '.join(sample.words)})" if sample.words else ""
    if over := over or "correlated parameters" * bool(correlations(sample.runs)):
        raise ValueError(
            f"{sample.study}: no surrogate is fitted over {over}, so it cannot supply values: set "
            "failed_runs: fail"
        )
    enough = np.count_nonzero(~gaps) >= FEWEST_PER_PARAMETER * len(sample.parameters)
    if not enough or np.count_nonzero(gaps) > MOST_IMPUTED * outputs.size:
        return None
    seed = int(sample.rng("surrogate", response).integers(1, 2**31))
    good, gone = np.flatnonzero(~gaps), np.flatnonzero(gaps)
    good = good[drawn(good.size, seed)]
    places = _places(sample, np.concatenate([good, gone]))
    surrogate = fit(places[: good.size], outputs[good], seed)
    filled = outputs.copy()
    for start in range(0, gone.size, _AT_ONCE):
        part = slice(good.size + start, good.size + min(start + _AT_ONCE, gone.size))
        filled[gone[start : start + _AT_ONCE]] = surrogate(places[part])
    return filled


def _places(sample: Sample, runs: NDArray[np.int64]) -> Floats:
    """Return the share of all runs below each parameter of these, (runs, parameter)."""
    found = np.empty((runs.size, len(sample.parameters)))
    for at, name in enumerate(sample.parameters):
        column = sample.column(name)
        wanted, ordered = column[runs], np.sort(column)
        below, above = (np.searchsorted(ordered, wanted, side) for side in ("left", "right"))
        found[:, at] = ((below + above + 1) / 2 - 0.5) / column.size
    return found


_BESIDE = ("sensitivity_verdict", "sensitivity_remarks", "imputed_share")
_HISTORIES = "history"  # the dimension of the indices of histories, which have no response
_LABELS = ("response", "parameter", "other_parameter", "base_samples")
COLUMNS = (*_LABELS, "index", "value", "low", "high", "units", "verdict")
"""Of the table. low, high: ends of the interval of the value. units: of all three."""


def sensitivity_variables(analysis: xr.Dataset) -> xr.Dataset:
    """Return the sensitivity variables of an analysis: indices, intervals and verdicts."""
    wanted = [
        name
        for name, array in analysis.items()
        if name in _BESIDE
        or _HISTORIES in array.dims
        or (
            {"response"} <= set(array.dims) <= set(_LABELS)
            and ("estimator" in array.attrs or "parameter" in array.dims)
        )
    ]
    return analysis[wanted]


def table_rows(analysis: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield every index of every response by COLUMNS; that of a pair of parameters once.

    A history stands in the column of the responses; of it the table has the generalised indices
    alone. Columns that have no meaning for an index are left out; low and high are NaN without
    interval.
    """
    for name, index in sensitivity_variables(analysis).items():
        of_history = _HISTORIES in index.dims
        if str(name).endswith("_interval") or name in _BESIDE:
            continue
        if of_history and ("time" in index.dims or "parameter" not in index.dims):
            continue
        margin = analysis.get(f"{name}_interval", xr.full_like(index, np.nan))
        judged = analysis["history_verdict" if of_history else "sensitivity_verdict"]
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


def write_csv(analysis: xr.Dataset, path: Path) -> None:
    """Write the rows under their names, in UTF-8; missing values are empty cells."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        for row in table_rows(analysis):
            writer.writerow({key: "" if cell != cell else cell for key, cell in row.items()})
