"""Sobol indices of histories at each time, and generalised indices of whole histories.

At each time the estimators are those of the scalar responses. A generalised index is the integral
over time of the numerator of an index, divided by the integral of its denominator: the mean of the
indices, weighted by the variance. Lamboni et al. (2011), Reliab. Eng. Syst. Saf. 96, 450, define it
for outputs on a grid of times; Gamboa et al. (2014), Electron. J. Stat. 8, 575 (arXiv:1311.1797),
for functions. (Of both, no more than abstracts was read; R's sensitivity::sobolMultOut has the
same.)

The histories of all runs need not fit into memory: sums over the replicates of the sample are
kept, which is all that indices and intervals need, for as many times together as a bound on memory
allows.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.analysis.sensitivity.indices import MOST_IMPUTED
from impactlab.methods.record import WIDE, SensitivityVerdict, inconsistent
from impactlab.methods.runs import Sample, half_width, leave_one_out
from impactlab.methods.saltelli import ratios, statistics, step
from impactlab.methods.sobol import FEWEST, JANON, JANSEN, Sobol, check
from impactlab.types import Floats
from impactlab.variables import attributes, status_bits
from impactlab.verdicts import ROUND_OFF, Verdict, flagged

SHOWN = ("contact_force", "midspan_deflection")  # the histories that get indices
ROWS = 512  # base samples that are read together
CELLS = 4_000_000
"""Numbers of an array in memory, 32 MB: it bounds the times that are treated together."""
_2014 = "Gamboa et al. (2014), Electron. J. Stat. 8, 575"
_ORDERS = {"first_order": ("first-order", JANON), "total_order": ("total", JANSEN)}


class HistoryVerdict(Verdict):
    """Verdicts on the generalised indices of a history; the worst counts."""

    USABLE = True, "every run has its history, and the history varies"
    WIDE_INTERVALS = False, SensitivityVerdict.WIDE_INTERVALS.meaning
    INCONSISTENT = False, SensitivityVerdict.INCONSISTENT.meaning
    RUNS_LEFT_OUT = False, "runs failed: their base samples are left out"
    CONSTANT = False, "the history is the same in all runs: indices are undefined"
    TOO_FEW_RUNS = False, "too many runs failed: no index is given"


class TimeVerdict(Verdict):
    """Verdicts on the indices at one time."""

    GIVEN = True, "the runs differ at this time"
    NO_INTERVAL = False, "so few runs differ at this time that no interval can be given"
    CONSTANT = False, "all runs have the same value at this time: indices are undefined"
    TOO_FEW_RUNS = False, "too many runs failed: no index is given"


def histories(runs: xr.Dataset) -> list[str]:
    """Return the histories of runs that get indices: those stored of a Sobol sample."""
    of_sample = runs.attrs.get("method") == Sobol.name()
    return [name for name in SHOWN if of_sample and name in runs and "time" in runs[name].dims]


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Return the indices of contact force and deflection on `time`, and their generalised indices.

    Returns first_order_over_time and total_order_over_time (history, time, parameter),
    generalised_first_order and generalised_total_order (history, parameter), all with <name>
    _interval, the half-width of the interval; time_verdict (history, time) and
    history_verdict (history), which say why there is none; history_mean and history_deviation
    (history, time), in the unit of each history; and base_samples_left_out (history), those with a
    failed run. `parameter` holds the varied parameters, or their groups. Nothing of other runs than
    a Sobol sample with stored histories.

    Raises ValueError when the runs are not the sample that their attributes describe.
    """
    if not (names := histories(runs)):
        return xr.Dataset()
    sample = Sample.of(runs)
    check(sample)
    rows = [_of_history(sample, name) for name in names]
    values = {key: np.stack([row[key] for row in rows]) for key in rows[0]}
    factor_label = "group of varied parameters" if sample.groups else "varied parameter"
    metadata = [attributes(name) for name in names]
    coordinates: dict[str, Any] = {
        "parameter": ("parameter", list(sample.factors), {"long_name": factor_label}),
        "time": runs["time"].variable,
        "history": ("history", names, {"long_name": "history"}),
        "history_units": ("history", [entry["units"] for entry in metadata]),
        "history_long_name": ("history", [entry["long_name"] for entry in metadata]),
    }
    variables: dict[str, Any] = {}
    for place, (order, (label, source)) in enumerate(_ORDERS.items()):
        at_time, of_all = f"{label} Sobol index at each time", f"generalised {label} Sobol index"
        for name, key, along, long_name, estimator in (
            (f"{order}_over_time", "over_time", ("time",), at_time, source),
            (f"generalised_{order}", "generalised", (), of_all, f"{_2014}; {source}"),
        ):
            attrs = {"long_name": long_name, "units": "1", "estimator": estimator}
            width = f"half-width of the {100 * sample.confidence:g} % interval of the {long_name}"
            margin = attrs | {"long_name": width, "confidence": sample.confidence}
            for ending, about in (("", attrs), ("_interval", margin)):
                column = values[f"{key}{ending}"][..., place, :]
                variables[f"{name}{ending}"] = ("history", *along, "parameter"), column, about
    for name, (dims, attrs) in _BESIDE.items():
        variables[name] = dims, values[name], attrs
    dataset = xr.Dataset(variables, coordinates)
    for name, (dims, kind, subject) in _VERDICTS.items():
        codes = xr.DataArray(values[name], dims=dims)
        dataset[name] = flagged(codes, kind, f"verdict on the {subject}")
    return dataset


_IN_UNITS = "in the unit that history_units states"
_BESIDE: dict[str, tuple[tuple[str, ...], dict[str, str]]] = {
    "history_mean": (
        ("history", "time"),
        {"long_name": "mean over the runs of the two base samples, A and B", "comment": _IN_UNITS},
    ),
    "history_deviation": (
        ("history", "time"),
        {"long_name": "standard deviation over the runs of A and B", "comment": _IN_UNITS},
    ),
    "base_samples_left_out": (
        ("history",),
        {"long_name": "base samples left out, for a run of theirs failed", "units": "1"},
    ),
}
"""Variables that are no index: dimensions and attributes."""
_VERDICTS = {
    "time_verdict": (("history", "time"), TimeVerdict, "indices at each time"),
    "history_verdict": (("history",), HistoryVerdict, "generalised indices"),
}


def trapezoid(times: Floats) -> Floats:
    """Return the weights of the trapezoidal rule, (time,)."""
    steps = np.diff(times)
    return np.asarray(0.5 * (np.append(steps, 0.0) + np.append(0.0, steps)))


def sums(
    sample: Sample, name: str, good: Any, times: slice, most: int | None = None
) -> tuple[Floats, Floats]:
    """Return sums of a history over the replicates of the sample at some times, and their origin.

    Sums: (replicate, column, time), of the number of base samples, then of saltelli.statistics, of
    values less the origin (time,), one run's, so that their squares do not cancel. The history is
    read block by block. good: base samples without a failed run, (base samples,). most: base
    samples that are read together; the sums do not depend on it.
    """
    base, size = len(good), step(sample)
    column = sample.runs[name].variable.transpose("run", "time")[:, times]
    first = int(np.argmax(good)) * size
    origin = np.nan_to_num(np.asarray(column[first].values, float))
    place = np.arange(base) % sample.number("replicates")
    total = np.zeros((place.max() + 1, _columns(sample), len(origin)))
    for start in range(0, base, most or ROWS):
        end = min(start + (most or ROWS), base)
        block = np.asarray(column[start * size : end * size].values, float)
        block = block.reshape(end - start, size, -1)
        rows = _statistics(block - origin, good[start:end], sample)
        for row, replicate in zip(rows, place[start:end], strict=True):
            total[replicate] += row
    return total[np.bincount(place, good) > 0], origin


def _columns(sample: Sample) -> int:
    return 6 + 4 * len(sample.factors) * (1 + sample.number("second_order"))


def _statistics(block: Floats, good: Any, sample: Sample) -> Floats:
    """Return the columns of `sums`, (base samples, column, time), 0 of those to leave out."""
    # block: (base samples, runs of one, time), in the order of the sample
    complete = np.isfinite(block).all(axis=1) & good[:, None]
    block = np.where(complete[:, None], block, 0.0)
    columns = statistics(block, len(sample.factors), bool(sample.number("second_order")))
    return np.concatenate([complete[:, None], columns], axis=1)


def _of_history(sample: Sample, name: str) -> dict[str, Any]:
    """Return the values of one history by name; of indices, on (..., order, parameter)."""
    runs, factors = sample.runs, len(sample.factors)
    failed = (runs["status"].values & status_bits([])) != 0
    good = ~failed.reshape(-1, step(sample)).any(axis=1)
    times = np.asarray(runs["time"].values, float)
    weights, numbers = trapezoid(times), np.zeros(times.size)
    mean, deviation = np.full((2, times.size), np.nan)
    at_times, margins = np.full((2, times.size, 2 * factors), np.nan)
    integrals = np.zeros((1, 2, 2 * factors))  # (1 + replicates, part, 2 factors)
    together = max(1, CELLS // (_columns(sample) * min(ROWS, len(good))))
    for start in range(0, times.size if good.any() else 0, together):
        part = slice(start, min(start + together, times.size))
        total, origin = sums(sample, name, good, part)
        numbers[part] = total[:, 0].sum(axis=0)
        without = leave_one_out(total)  # of all base samples, then without each replicate
        with np.errstate(invalid="ignore", divide="ignore"):  # no base sample at all: NaN
            means = np.moveaxis(without[:, 1:] / without[:, :1], 1, -1)
        middle, variance, varies = _spread(means, origin)
        parts = np.stack(ratios(means, factors), axis=-3)  # numerators, denominators
        defined = varies[..., None] & (parts[:, 1] != 0)
        indices = parts[:, 0] / np.where(defined, parts[:, 1], np.nan)
        widths = half_width(indices[1:], sample.confidence)
        at_times[part], margins[part] = indices[0], np.where(np.isnan(indices[0]), np.nan, widths)
        mean[part] = origin + middle[0]
        deviation[part] = np.sqrt(np.where(varies[0], variance[0], 0.0))
        varying = np.where(varies[:, None, :, None], parts, 0.0)
        integrals = integrals + np.einsum("...tf,t->...f", varying, weights[part])
    denominators = integrals[:, 1]
    indices = integrals[:, 0] / np.where(denominators > 0, denominators, np.nan)  # NaN: constant
    values: dict[str, Any] = {
        "over_time": at_times.reshape(-1, 2, factors),
        "over_time_interval": margins.reshape(-1, 2, factors),
        "generalised": indices[0].reshape(2, factors),
        "generalised_interval": half_width(indices[1:], sample.confidence).reshape(2, factors),
        "history_mean": mean,
        "history_deviation": deviation,
    }
    left_out, base = len(good) - int(numbers.min()), sample.number("base_samples")
    few = base - left_out < FEWEST or left_out > MOST_IMPUTED * base
    if few:
        for array in values.values():
            array[...] = np.nan
    return values | {"base_samples_left_out": left_out} | _verdicts(values, left_out, few)


def _spread(means: Floats, origin: Floats) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Return mean less origin and variance over A and B, and where this is more than round-off.

    means: of the statistics, (..., time, column).
    """
    a, b, squared_a, squared_b = (means[..., column] for column in range(4))
    middle, squares = (a + b) / 2, (squared_a + squared_b) / 2
    variance = squares - middle**2
    level = ROUND_OFF**2 * (origin + middle) ** 2
    return middle, variance, variance > np.maximum(level, ROUND_OFF * squares)


def _verdicts(values: Mapping[str, Floats], left_out: int, few: bool) -> dict[str, Any]:
    """Return the verdicts on one history, and on its indices at each time."""
    undefined, unbounded = (
        np.isnan(values[name]).any(axis=(1, 2)) for name in ("over_time", "over_time_interval")
    )
    codes = np.where(unbounded, TimeVerdict.NO_INTERVAL, TimeVerdict.GIVEN)
    codes = np.where(undefined, TimeVerdict.CONSTANT, codes)
    (first, total), margins = values["generalised"], values["generalised_interval"]
    holds = {
        HistoryVerdict.WIDE_INTERVALS: not (margins <= WIDE).all(),
        HistoryVerdict.INCONSISTENT: inconsistent(first, margins[0], total, margins[1]),
        HistoryVerdict.RUNS_LEFT_OUT: left_out > 0,
        HistoryVerdict.CONSTANT: np.isnan(first).any() or np.isnan(total).any(),
        HistoryVerdict.TOO_FEW_RUNS: few,
    }
    return {
        "time_verdict": np.full_like(codes, TimeVerdict.TOO_FEW_RUNS) if few else codes,
        "history_verdict": max((kind for kind, held in holds.items() if held), default=0),
    }
