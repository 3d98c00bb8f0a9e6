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

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis.sensitivity.imputation import MOST_IMPUTED
from impactlab.methods.estimators import half_width, leave_one_out
from impactlab.methods.runs import Sample
from impactlab.methods.saltelli import ratios, statistics, step
from impactlab.methods.sobol import FEWEST, JANON, JANSEN, Sobol, check
from impactlab.methods.verdict import WIDE, SensitivityVerdict, inconsistent
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


def applies(runs: xr.Dataset) -> bool:
    """Return True for a Sobol sample that stores histories."""
    return bool(histories(runs))


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Return the indices of contact force and deflection on `time`, and their generalised indices.

    Returns first_order_over_time and total_order_over_time (history, time, parameter),
    generalised_first_order and generalised_total_order (history, parameter), all with <name>
    _interval, the half-width of the interval; time_verdict (history, time) and
    history_verdict (history), which say why there is none; history_mean and history_deviation
    (history, time), in the unit of each history; and base_samples_left_out (history), those with a
    failed run. `parameter` holds the varied parameters, or their groups.

    Raises ValueError when the runs are not the sample that their attributes describe.
    """
    sample, names = Sample.of(runs), histories(runs)
    check(sample)
    answers = [_of_history(sample, name) for name in names]
    factors = list(sample.factors)
    factor_label = "group of varied parameters" if sample.groups else "varied parameter"
    metadata = [attributes(name) for name in names]
    coordinates: dict[str, Any] = {
        "parameter": ("parameter", factors, {"long_name": factor_label}),
        "time": runs["time"].variable,
        "history": ("history", names, {"long_name": "history"}),
        "history_units": ("history", [entry["units"] for entry in metadata]),
        "history_long_name": ("history", [entry["long_name"] for entry in metadata]),
    }
    variables: dict[str, Any] = {
        key: (dims, np.stack([answer[key] for answer in answers]), attrs)
        for key, (dims, attrs) in _described(sample).items()
    }
    dataset = xr.Dataset(variables, coordinates)
    for key, dims, kind, label in (
        ("time_verdict", ("history", "time"), TimeVerdict, "indices at each time"),
        ("history_verdict", ("history",), HistoryVerdict, "generalised indices"),
    ):
        codes = xr.DataArray(np.stack([answer[key] for answer in answers]), dims=dims)
        dataset[key] = flagged(codes, kind, f"verdict on the {label}")
    return dataset


def _described(sample: Sample) -> dict[str, tuple[tuple[str, ...], dict[str, Any]]]:
    """Return dimensions and attributes of all variables but the verdicts."""
    settings = {"confidence": sample.confidence}
    variables: dict[str, tuple[tuple[str, ...], dict[str, Any]]] = {}
    for order, (label, source) in _ORDERS.items():
        over = ("history", "time", "parameter"), f"{label} Sobol index at each time", source
        generalised = (
            ("history", "parameter"),
            f"generalised {label} Sobol index",
            f"{_2014}; {source}",
        )
        names = f"{order}_over_time", f"generalised_{order}"
        for name, (dims, long_name, estimator) in zip(names, (over, generalised), strict=True):
            attrs = {"long_name": long_name, "units": "1", "estimator": estimator}
            width = f"half-width of the {100 * sample.confidence:g} % interval of the {long_name}"
            variables[name] = dims, attrs
            variables[f"{name}_interval"] = dims, attrs | {"long_name": width} | settings
    by_time = ("history", "time")
    comment = "in the unit that history_units states"
    for name, label in (
        ("history_mean", "mean over the runs of the two base samples, A and B"),
        ("history_deviation", "standard deviation over the runs of A and B"),
    ):
        variables[name] = by_time, {"long_name": label, "comment": comment}
    left = {"long_name": "base samples left out, for a run of theirs failed", "units": "1"}
    return variables | {"base_samples_left_out": (("history",), left)}


@dataclass(frozen=True)
class Sums:
    """Sums over the replicates of the sample, at some times.

    Values are counted from `origin` (time,), one run's, so that their squares do not cancel.
    replicates: (replicate, column, time): the number of base samples, then sobol.statistics.
    """

    replicates: Floats
    origin: Floats

    def parts(self, factors: int) -> tuple[Parts, Floats, Floats]:
        """Return the parts of the indices, mean and number of base samples (time,).

        The parts have an axis in front: of all base samples, then without each replicate.
        """
        sums = leave_one_out(self.replicates)
        number = sums[0, 0]
        with np.errstate(invalid="ignore", divide="ignore"):  # no base sample at all: NaN
            means = np.moveaxis(sums[:, 1:] / sums[:, :1], 1, -1)
        mean = self.origin + (means[0, :, 0] + means[0, :, 1]) / 2
        return Parts.of(means, factors, self.origin), mean, number


@dataclass(frozen=True)
class Parts:
    """Numerators and denominators of first and total orders, and variances over A and B.

    numerators, denominators: (..., time, 2 factors). variance: (..., time), and where it is more
    than round-off.
    """

    numerators: Floats
    denominators: Floats
    variance: Floats
    varies: Any

    @classmethod
    def of(cls, means: Floats, factors: int, origin: Floats) -> Parts:
        """Return the parts from means of the statistics, (..., time, column)."""
        a, b, squared_a, squared_b = (means[..., column] for column in range(4))
        squares = (squared_a + squared_b) / 2
        variance = squares - ((a + b) / 2) ** 2
        level = ROUND_OFF**2 * (origin + (a + b) / 2) ** 2
        varies = variance > np.maximum(level, ROUND_OFF * squares)
        return cls(*ratios(means, factors), variance, varies)

    def at_times(self) -> Floats:
        """Return the indices at each time, (..., time, 2 factors); NaN where nothing varies."""
        denominators = np.where(self.varies[..., None], self.denominators, np.nan)
        return np.asarray(self.numerators / denominators)


def trapezoid(times: Floats) -> Floats:
    """Return the weights of the trapezoidal rule, (time,)."""
    steps = np.diff(times)
    return np.asarray(0.5 * (np.append(steps, 0.0) + np.append(0.0, steps)))


def sums(sample: Sample, name: str, good: Any, times: slice, most: int | None = None) -> Sums:
    """Return the sums of a history at some times, read block by block.

    good: base samples without a failed run, (base samples,). most: base samples that are read
    together; the sums do not depend on it.
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
    return Sums(total[np.bincount(place, good) > 0], origin)


def _columns(sample: Sample) -> int:
    return 6 + 4 * len(sample.factors) * (1 + sample.number("second_order"))


def _statistics(block: Floats, good: Any, sample: Sample) -> Floats:
    """Return the columns of `Sums`, (base samples, column, time), 0 of those to leave out."""
    # block: (base samples, runs of one, time), in the order of the sample
    complete = np.isfinite(block).all(axis=1) & good[:, None]
    block = np.where(complete[:, None], block, 0.0)
    columns = statistics(block, len(sample.factors), bool(sample.number("second_order")))
    return np.concatenate([complete[:, None], columns], axis=1)


def _of_history(sample: Sample, name: str) -> dict[str, Any]:
    """Return the variables of one history, by name."""
    runs, factors = sample.runs, len(sample.factors)
    failed = (runs["status"].values & status_bits([])) != 0
    good = ~failed.reshape(-1, step(sample)).any(axis=1)
    times = np.asarray(runs["time"].values, float)
    size, columns = len(times), _columns(sample)
    variables: dict[str, Any] = {
        "at_times": np.full((size, 2 * factors), np.nan),
        "at_times_interval": np.full((size, 2 * factors), np.nan),
        "history_mean": np.full(size, np.nan),
        "history_deviation": np.full(size, np.nan),
    }
    weights, numbers = trapezoid(times), np.zeros(size)
    integrals = np.zeros((1, 2, 2 * factors))  # (1 + replicates, part, 2 factors)
    together = max(1, CELLS // (columns * min(ROWS, len(good))))
    for start in range(0, size if good.any() else 0, together):
        part = slice(start, min(start + together, size))
        parts, mean, numbers[part] = sums(sample, name, good, part).parts(factors)
        at_times = parts.at_times()
        variables["at_times"][part] = at_times[0]
        margins = half_width(at_times[1:], sample.confidence)
        variables["at_times_interval"][part] = np.where(np.isnan(at_times[0]), np.nan, margins)
        deviation = np.sqrt(np.where(parts.varies[0], parts.variance[0], 0.0))
        variables["history_mean"][part], variables["history_deviation"][part] = mean, deviation
        integrals = integrals + _integrated(parts, weights[part])
    left_out = len(good) - int(numbers.min())
    return _named(variables, integrals, left_out, sample)


def _integrated(parts: Parts, weights: Floats) -> Floats:
    """Return integrals over time of numerators and denominators, (..., 2, 2 factors)."""
    together = np.stack([parts.numerators, parts.denominators], axis=-3)
    varying = np.where(parts.varies[..., None, :, None], together, 0.0)
    return np.asarray(np.einsum("...tf,t->...f", varying, weights))


def _named(
    variables: dict[str, Any], integrals: Floats, left_out: int, sample: Sample
) -> dict[str, Any]:
    """Return the variables of a history, with their verdicts."""
    base, factors = sample.number("base_samples"), len(sample.factors)
    few = base - left_out < FEWEST or left_out > MOST_IMPUTED * base
    numerators, denominators = integrals[:, 0], integrals[:, 1]
    indices = numerators / np.where(denominators > 0, denominators, np.nan)  # NaN: nothing varies
    generalised, margins = indices[0], half_width(indices[1:], sample.confidence)
    at_times, at_margins = variables["at_times"], variables["at_times_interval"]
    if few:
        for array in (generalised, margins, at_times, at_margins, variables["history_mean"]):
            array[...] = np.nan
        variables["history_deviation"][...] = np.nan
    undefined = np.isnan(at_times).any(axis=1)
    codes = np.where(np.isnan(at_margins).any(axis=1), TimeVerdict.NO_INTERVAL, TimeVerdict.GIVEN)
    codes = np.where(undefined, TimeVerdict.CONSTANT, codes)
    holds = {
        HistoryVerdict.WIDE_INTERVALS: not (margins <= WIDE).all(),
        HistoryVerdict.INCONSISTENT: inconsistent(
            generalised[:factors], margins[:factors], generalised[factors:], margins[factors:]
        ),
        HistoryVerdict.RUNS_LEFT_OUT: left_out > 0,
        HistoryVerdict.CONSTANT: np.isnan(generalised).any(),
        HistoryVerdict.TOO_FEW_RUNS: few,
    }
    named: dict[str, Any] = {
        "history_mean": variables["history_mean"],
        "history_deviation": variables["history_deviation"],
        "base_samples_left_out": left_out,
        "time_verdict": np.full_like(codes, TimeVerdict.TOO_FEW_RUNS) if few else codes,
        "history_verdict": max((kind for kind, held in holds.items() if held), default=0),
    }
    for position, order in enumerate(_ORDERS):
        columns = slice(position * factors, (position + 1) * factors)
        named[f"{order}_over_time"] = at_times[:, columns]
        named[f"{order}_over_time_interval"] = at_margins[:, columns]
        named[f"generalised_{order}"] = generalised[columns]
        named[f"generalised_{order}_interval"] = margins[columns]
    return named
