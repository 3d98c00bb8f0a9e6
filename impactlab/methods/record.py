"""Records of indices: their variables, how they are estimated and shown, and verdicts on them.

The verdicts are those of a sceptical reader.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import xarray as xr

from impactlab.methods.runs import Sample
from impactlab.types import Floats
from impactlab.verdicts import ROUND_OFF, Verdict, distinct

MOSTLY = 0.9
"""Share of runs with one and the same value from which on a response is mostly constant."""
FEW_VALUES = 10  # distinct values up to which a response moves in jumps
TAIL, TAIL_SHARE = 0.01, 0.5
"""The share of runs that may not carry more than this share of the variance."""
WIDE = 0.1
"""Half-width from which on an interval is wide: of an index that is a share, or, of a mean
elementary effect, relative to the largest one."""


class SensitivityVerdict(Verdict):
    """Verdicts on the indices of a response; the worst counts. From CONSTANT on, there are none."""

    USABLE = (
        True,
        "every run answered, the response has one regime, and no interval is wider than 0.1 to "
        "either side, nor the numerical error where it was estimated",
    )
    JUMPS = False, "the response takes ten values or fewer: its indices are those of jumps"
    FEW_RUNS_CARRY_IT = False, "one run in a hundred carries more than half of the variance"
    WIDE_INTERVALS = (
        False,
        "the sample is small: an interval is wider than 0.1 to either side, or cannot be given",
    )
    NUMERICAL_ERROR = False, "the numerical error of an index may be larger than 0.1"
    NOT_LINEAR = (
        False,
        "linear regression explains less than 70 % of the variance, on values and on ranks",
    )
    INCONSISTENT = (
        False,
        "the sample is too small: by more than their intervals, first-order indices add up to "
        "more than 1, are below zero, or exceed their total",
    )
    DEPENDENT_BASES = (
        False,
        "the response correlates between the two base samples by more than chance: first-order "
        "indices are wrong (see base_correlation)",
    )
    IMPUTED = False, "runs failed, and a surrogate supplied their values (see imputed_share)"
    MOSTLY_CONSTANT = (
        False,
        "nine runs in ten share one value: the indices depend on the remaining runs",
    )
    NO_DENSITY = (
        False,
        "a class of a parameter's values holds one value of the response alone: it has no density, "
        "and no delta is given (use pawn)",
    )
    NO_LIMIT = (
        False,
        "the response has no limit, or all runs lie on one side of it: no target index is given",
    )
    CONSTANT = False, "the response does not vary: indices are undefined"
    SEVERAL_REGIMES = (
        False,
        "the response lies in separate ranges with none between: no index is given (a limit "
        "between two of them tells which parameters decide)",
    )
    FAILED_RUNS = False, "runs are missing: no index is given"
    TOO_FEW_RUNS = (
        False,
        "too many runs are missing for a surrogate to supply their values: no index is given",
    )
    POOR_SURROGATE = (
        False,
        "runs are missing, and a surrogate of the others misses more than a tenth of the variance: "
        "no index is given",
    )


def of_outputs(
    outputs: Floats, varying: Sequence[Floats], imputed: float
) -> list[SensitivityVerdict]:
    """Return the verdicts on one response before its indices are known; empty for the best.

    outputs: (runs,); varying: parts of them, each of which has to vary; imputed: share of runs
    whose value a surrogate supplied.
    """
    if not np.isfinite(outputs).all():
        return [SensitivityVerdict.FAILED_RUNS]
    if still(outputs, varying):
        return [SensitivityVerdict.CONSTANT]
    values, most = distinct(outputs)
    holds = {
        SensitivityVerdict.MOSTLY_CONSTANT: most >= MOSTLY * outputs.size,
        SensitivityVerdict.IMPUTED: imputed > 0,
        SensitivityVerdict.FEW_RUNS_CARRY_IT: tail(outputs) > TAIL_SHARE,
        SensitivityVerdict.JUMPS: values <= min(FEW_VALUES, outputs.size // 2),
    }
    return [verdict for verdict, held in holds.items() if held]


def still(outputs: Floats, varying: Sequence[Floats]) -> bool:
    """Return True if a part does not vary, for its size or beside the variance of the whole."""
    largest = max(outputs.max(), -outputs.min())
    smallest, least = ROUND_OFF * largest, ROUND_OFF * np.var(outputs)
    return any(np.ptp(part) <= smallest or np.var(part) <= least for part in varying)


def tail(outputs: Floats) -> float:
    """Return the share of the variance that comes from the runs farthest from the mean."""
    squares = outputs - outputs.mean()
    squares *= squares  # in place, as the next: a copy may be gigabytes
    squares.sort()
    return float(squares[-max(1, round(TAIL * squares.size)) :].sum() / squares.sum())


def wide(*margins: Floats) -> list[SensitivityVerdict]:
    """Return the verdict on half-widths of intervals of shares: empty unless one is wide."""
    narrow = all((margin <= WIDE).all() for margin in margins)
    return [] if narrow else [SensitivityVerdict.WIDE_INTERVALS]


def by_width(name: str) -> Callable[[Mapping[str, Floats]], list[SensitivityVerdict]]:
    """Return what judges an index that is a share by the width of its interval alone."""
    return lambda indices: wide(indices[f"{name}_interval"])


def of_orders(indices: Mapping[str, Floats]) -> list[SensitivityVerdict]:
    """Return the verdicts on first and total orders and their intervals."""
    first, total = "first_order", "total_order"
    values = [indices[f"{order}{end}"] for order in (first, total) for end in ("", "_interval")]
    contradiction = [SensitivityVerdict.INCONSISTENT] * inconsistent(*values)
    return wide(values[1], values[3]) + contradiction


def inconsistent(first: Floats, first_margin: Floats, total: Floats, total_margin: Floats) -> bool:
    """Return True where indices (parameter,) contradict each other by more than their intervals."""
    # By twice the interval: of many that are zero, or equal, some lie outside of it once.
    return bool(
        first.sum() - 1 > first_margin.sum()
        or (first < -2 * first_margin).any()
        or (first - total > 2 * (first_margin + total_margin)).any()
    )


def remarks(verdicts: Sequence[Sequence[SensitivityVerdict]]) -> xr.DataArray:
    """Return all verdicts on each response, (response,): bits of `flag_masks`, 0 for none."""
    masks = {kind: 1 << bit for bit, kind in enumerate(list(SensitivityVerdict)[1:])}
    codes = [sum(masks[kind] for kind in entry) for entry in verdicts]
    attrs = {
        "long_name": "all that is to be said of the sensitivity indices, beside the verdict",
        "flag_masks": np.array(list(masks.values()), np.int32),
        "flag_meanings": " ".join(kind.name.lower() for kind in masks),
    }
    return xr.DataArray(np.array(codes, np.int32), dims="response", attrs=attrs)


def with_numerical_error(analysis: xr.Dataset) -> xr.Dataset:
    """Return an analysis whose verdicts know the numerical error of its indices."""
    names = [f"{order}_numerical" for order in ("first_order", "total_order")]
    errors = [analysis[name].max("parameter") for name in names if name in analysis]
    if "sensitivity_verdict" not in analysis or not errors:
        return analysis
    large = np.fmax.reduce(errors) > WIDE
    verdicts, bits = analysis["sensitivity_verdict"], analysis["sensitivity_remarks"]
    worst = verdicts.clip(min=SensitivityVerdict.NUMERICAL_ERROR).where(large, verdicts)
    bit = 1 << (SensitivityVerdict.NUMERICAL_ERROR - 1)
    return analysis.assign(
        sensitivity_verdict=worst.astype(verdicts.dtype).assign_attrs(verdicts.attrs),
        sensitivity_remarks=xr.where(large, bits | bit, bits).assign_attrs(bits.attrs),
    )


PAIR = ("parameter", "other_parameter")
BY_SAMPLES = ("base_samples", "parameter")


@dataclass(frozen=True)
class IndexVariable:
    """One index of a response, as a variable of the analysis.

    estimator: its source, with the equation; dims: those beside `response`; units: None where it
    has the unit of its response; interval: whether it comes with one; comment: what a reader of
    the number has to know.
    """

    long_name: str
    estimator: str
    dims: tuple[str, ...] = ("parameter",)
    units: str | None = "1"
    interval: bool = True
    comment: str = ""

    @classmethod
    def of_dummy(cls, long_name: str, estimator: str) -> Self:
        """Return the index of a dummy parameter, see `runs.dummy_column`."""
        return cls(long_name, estimator, (), comment="of a random column that the model never saw")


@dataclass(frozen=True)
class Measure:
    """A variable of the analysis on (response, parameter), and its name in words.

    optional: shown where it is given.
    """

    name: str
    label: str
    optional: bool = False


_OVERLAP = "the index of each includes what it shares with the others, and indices overlap"


@dataclass(frozen=True)
class Family:
    """Measures that are shown side by side, in one figure and in tables.

    figure: name of their figure; title: heads it and the tables. axis: label of their axis.
    meaning: of the numbers, in a sentence or two. shares: True for shares of a whole. ranking: the
    measure that ranks the parameters where it is given; the first one otherwise. explained:
    variable with the share of the variance that they tell of, if they are coefficients of a fit.
    if_correlated: what the numbers mean where parameters are correlated.
    """

    figure: str
    title: str
    measures: tuple[Measure, ...]
    axis: str
    meaning: str
    shares: bool = True
    ranking: str = ""
    explained: str = ""
    if_correlated: str = _OVERLAP

    def given(self, analysis: xr.Dataset) -> bool:
        """Return whether the analysis has every measure that is not optional."""
        return all(measure.name in analysis for measure in self.measures if not measure.optional)

    def measures_in(self, analysis: xr.Dataset) -> list[Measure]:
        """Return the measures that the analysis has."""
        return [measure for measure in self.measures if measure.name in analysis]

    def ranked_by(self, analysis: xr.Dataset) -> Measure:
        """Return the measure that ranks the parameters."""
        measures = self.measures_in(analysis)
        return next((entry for entry in measures if entry.name == self.ranking), measures[0])


@dataclass(frozen=True)
class Indices:
    """The indices that one method estimates.

    name: as in study files. variables: by name. family: how they are shown. check: raises
    ValueError where the runs are not the sample that their attributes describe. estimate: from
    finite and varying outputs (runs,), the sample and the response's name to indices and
    half-widths, by variable name. judge: from these to verdicts, empty for the best. varying: the
    parts of the outputs each of which has to vary. fewest: least number of runs. most: largest
    number of parameters, 0 for any. of_limits: whether they need a limit of a response. order: why
    the values need an order, which words have not; "" where they do not.
    """

    name: str
    variables: Mapping[str, IndexVariable]
    family: Family
    check: Callable[[Sample], None]
    estimate: Callable[[Floats, Sample, str], dict[str, Floats]]
    judge: Callable[[Mapping[str, Floats]], list[SensitivityVerdict]]
    varying: Callable[[Floats, Sample], list[Floats]] = lambda outputs, sample: [outputs]
    fewest: int = 1
    most: int = 0
    of_limits: bool = False
    order: str = ""
