"""Sobol indices of first, second and total order from Saltelli's sample."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    AfterValidator,
    Field,
    PlainValidator,
    StrictBool,
    ValidationInfo,
    model_validator,
)

from impactlab.methods.record import (
    BY_SAMPLES,
    PAIR,
    Family,
    IndexVariable,
    Indices,
    Measure,
    SensitivityVerdict,
    of_orders,
    still,
)
from impactlab.methods.runs import Sample, half_width
from impactlab.methods.saltelli import REPLICATES, Outputs, estimates, saltelli, step
from impactlab.methods.sampling import MOST_RUNS, Grouped
from impactlab.types import Floats
from impactlab.validation.fields import FileSection, Names, Number, Whole, at_key
from impactlab.verdicts import ROUND_OFF

_FEWEST_TO_GROW = 64
"""Base samples from which on intervals are good enough to decide on growth."""
HALVINGS = 5  # number of halvings of the sample that show how its indices settle: from N/32 on
FEWEST = 8  # base samples below which halves are not shown
CHANCE = 0.001  # of independent base samples whose correlation exceeds its noise
JANON = (
    "Janon et al. (2014), ESAIM Probab. Stat. 18, 342, eq. 6, with the covariance of both base "
    "samples as control variate"
)
JANSEN = "Jansen (1999), Comput. Phys. Commun. 117, 35, with the variance of the same runs"
_NESTED = "from the first base samples alone, which are a smaller sample of the same kind"
_VARIABLES = {
    "first_order": IndexVariable("first-order Sobol index", JANON),
    "total_order": IndexVariable("total-order Sobol index", JANSEN),
    "second_order": IndexVariable("second-order Sobol index", JANON, PAIR),
    "first_order_by_samples": IndexVariable(
        "first-order Sobol index by base samples", JANON, BY_SAMPLES, comment=_NESTED
    ),
    "total_order_by_samples": IndexVariable(
        "total-order Sobol index by base samples", JANSEN, BY_SAMPLES, comment=_NESTED
    ),
    "base_correlation": IndexVariable(
        "correlation of the response between the two base samples, A and B",
        "Pearson, with the mean and the variance of both",
        (),
        interval=False,
        comment="it enters every first-order index, and is 0 for independent base samples",
    ),
    "base_correlation_noise": IndexVariable(
        f"magnitude that the correlation exceeds by chance in {CHANCE:.1%} of samples",
        "jackknife over the replicates, with Student's t",
        (),
        interval=False,
    ),
}
FAMILY = Family(
    "sobol_indices",
    "Sobol indices",
    (Measure("first_order", "first order"), Measure("total_order", "total order", optional=True)),
    "Share of the variance (–)",
    "Share of the variance of each response that comes from a parameter alone (first order) and "
    "with all its interactions (total order), over the ranges of this study.",
    ranking="total_order",
)


def check(sample: Sample) -> None:
    """Raise ValueError where the sample has no replicates, or another number of runs."""
    if "replicates" not in sample.settings:
        raise ValueError(
            f"{sample.study} has a sample of an earlier version of impactlab, whose first-order "
            "indices may be wrong by more than their intervals: draw it again with `impactlab "
            "design`, then solve it"
        )
    base, factors = sample.number("base_samples"), len(sample.factors)
    size = f"{base} base samples of {factors} {'groups' if sample.groups else 'parameters'}"
    sample.expect(base * step(sample), size)


def base_samples(sample: Sample) -> list[int]:
    """Return the sizes of the nested samples, up to the whole one."""
    largest = sample.number("base_samples")
    sizes = [largest >> halving for halving in range(HALVINGS, 0, -1)]
    return [size for size in sizes if size >= FEWEST] + [largest]


def varying(outputs: Floats, sample: Sample) -> list[Floats]:
    """Return the outputs that have to vary: the variance comes from the two base samples."""
    size = step(sample)
    return [np.concatenate([outputs[::size], outputs[size - 1 :: size]])]


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    series = [_of_first(size, outputs, sample) for size in base_samples(sample)]
    indices, gap = dict(series[-1]), np.full(len(sample.factors), np.nan)
    for order in ("first_order", "total_order"):
        for ending in ("", "_interval"):
            values = [part.get(f"{order}{ending}", gap) for part in series]
            indices[f"{order}_by_samples{ending}"] = np.stack(values)
    return indices


def _of_first(size: int, outputs: Floats, sample: Sample) -> dict[str, Floats]:
    """Return the indices on the first base samples; none where these do not vary."""
    start, factors = outputs[: size * step(sample)], len(sample.factors)
    if still(start, varying(start, sample)):
        return {}
    interactions = start.size == outputs.size  # pairs have no indices by samples
    replicated = leaving_out(start, sample, interactions)
    indices = {name: values[0] for name, values in replicated.items()}
    for name in replicated.keys() - {"base_correlation"}:
        indices[f"{name}_interval"] = half_width(replicated[name][1:], sample.confidence)
    indices["base_correlation_noise"] = half_width(replicated["base_correlation"][1:], 1 - CHANCE)
    for name in {"second_order", "second_order_interval"} & indices.keys():
        indices[name] = _matrix(indices[name], factors)
    return indices


def leaving_out(outputs: Floats, sample: Sample, interactions: bool = False) -> dict[str, Floats]:
    """Return indices of all outputs (runs,), then without each replicate: (1 + replicates, ...)."""
    means = Outputs.of(outputs, sample).means(interactions)
    return estimates(means, len(sample.factors))


def _matrix(values: Floats, factors: int) -> Floats:
    """Return values of pairs as a symmetric matrix, NaN on its diagonal."""
    matrix = np.full((factors, factors), np.nan)
    matrix[np.triu_indices(factors, 1)] = values
    return np.where(np.isnan(matrix), matrix.T, matrix)


def _judge(indices: Mapping[str, Floats]) -> list[SensitivityVerdict]:
    noise = max(float(indices["base_correlation_noise"]), ROUND_OFF)
    dependent = abs(float(indices["base_correlation"])) > noise
    return of_orders(indices) + [SensitivityVerdict.DEPENDENT_BASES] * dependent


INDICES = Indices("sobol", _VARIABLES, FAMILY, check, _estimate, _judge, varying)


class Until(FileSection):
    """The key `until`: the sample is doubled until its intervals are narrow enough.

    interval: largest half-width of the interval of a first or total-order index. runs: largest
    number of runs. responses: those whose indices count; None: all.
    """

    interval: Annotated[Number, Field(ge=0.001, le=0.5)]
    runs: Annotated[Whole, Field(ge=1, le=MOST_RUNS)]
    responses: Names | None = None


def _power_of_two(value: int) -> int:
    if value & (value - 1):
        below = 1 << (value.bit_length() - 1)
        raise ValueError(f"must be a power of two, such as {below} or {2 * below}")
    return value


def _read_until(data: Any, info: ValidationInfo) -> Until:
    return Until.model_validate(data, context=info.context)


@dataclass(frozen=True, kw_only=True)
class Sobol(Grouped):
    """Saltelli's sample for Sobol indices of first, second and total order.

    D parameters take `base_samples` (2 D + 2) runs, without indices of second order
    `base_samples` (D + 2).

    Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter.
    seed : int, default 1
        Equal seeds give equal runs.
    base_samples : int
        Number of base samples, a power of two, at least 4.
    second_order : bool, default True
        True to estimate indices of second order.
    groups : mapping of str to sequence of str, optional
        Parameters that get one index together, by name of the group.
    until : mapping, optional
        `{"interval": 0.05, "runs": 100_000}` doubles the sample until no interval is wider than
        ± `interval`, or the next sample would exceed `runs`.

    References
    ----------
    Saltelli et al. (2010), Comput. Phys. Commun. 181, 259, Table 2 (b) and (f); Saltelli (2002),
    Comput. Phys. Commun. 145, 280, Theorem 2.

    Examples
    --------
    >>> depth, stress = il.Uniform("26 mm", "29 mm"), il.Normal("345 MPa", "20 MPa")
    >>> sample = il.Sobol(
    ...     base_samples=1024, seed=1,
    ...     parameters={"beam_depth": depth, "beam_yield_stress": stress, "contact": "hertz"})
    """

    records = (INDICES,)
    allows_ties = True
    label = "Sobol sample"
    even = True
    blocks = "base_samples"
    base_samples: Annotated[Whole, Field(ge=4, le=MOST_RUNS), AfterValidator(_power_of_two)]
    second_order: StrictBool = True
    until: Annotated[Any, PlainValidator(_read_until)] = None

    @property
    def pairs(self) -> bool:
        """True where second-order indices are drawn: a single parameter has none."""
        return self.second_order and self.group_count > 1

    @property
    def runs(self) -> int:
        """Saltelli's number of runs."""
        return self.base_samples * ((2 if self.pairs else 1) * self.group_count + 2)

    @property
    def runs_at_most(self) -> int:
        """The most runs that are solved, where the sample grows."""
        return max(self.runs, self.until.runs) if self.until else self.runs

    @model_validator(mode="after")
    def _check_until(self) -> Self:
        if self.until and self.base_samples < _FEWEST_TO_GROW:
            reason = "with until: the intervals of fewer cannot be trusted"
            raise at_key("base_samples", f"must be at least {_FEWEST_TO_GROW} {reason}")
        if self.until and self.until.runs < self.runs:
            raise at_key("until.runs", f"must be at least the first sample's {self.runs:,} runs")
        return self

    @property
    def settings(self) -> dict[str, Any]:
        """The attributes of a design that describe its draws."""
        settings = super().settings | {"second_order": int(self.pairs), "replicates": REPLICATES}
        if not (until := self.until):
            return settings
        limits = {"until_interval": until.interval, "until_runs": until.runs}
        responses = {"until_responses": list(until.responses)} if until.responses else {}
        return settings | limits | responses

    def draws(self, start: int = 0, stop: int | None = None) -> Floats:
        """Draw base samples one after the other, see `saltelli`."""
        size = self.runs // self.base_samples
        stop = self.runs if stop is None else stop
        first, last = start // size, -(-stop // size)
        groups = list(self.group_of.values())
        runs = saltelli(groups, self.base_samples, self.pairs, self.seed, first, last)
        return runs[start - first * size : stop - first * size]

    @staticmethod
    def independent(sample: Sample) -> NDArray[np.int64]:
        """Return the numbers of the runs at A and at B."""
        rows = np.arange(sample.size)
        size = sample.size // sample.number("base_samples")
        return np.concatenate([rows[::size], rows[size - 1 :: size]])
