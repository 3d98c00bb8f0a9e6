"""Surrogates of all responses of a sample: fitted, tested on runs left out, and judged.

The tests say how much of the variance a surrogate predicts, and how its error grows outwards.
"""

from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from impactlab.analysis.regimes import of_sample
from impactlab.analysis.surrogate.chaos import (
    Chaos,
    Polynomials,
    basis,
    drawn,
    fewest_runs,
    fit,
    indices,
    influence,
    orthonormal,
)
from impactlab.methods import SAMPLES
from impactlab.methods.distributions import DISTRIBUTIONS, distribution_of
from impactlab.methods.record import MOSTLY
from impactlab.methods.runs import Sample, correlations, labels, listed, usable
from impactlab.methods.sampling import RandomSample
from impactlab.types import Floats
from impactlab.verdicts import ROUND_OFF, Verdict, distinct, flagged

_FOLDS = 5  # parts of a sample; each is predicted by a fit to the others
_FEWEST_TESTS, _MOST_TESTS = 10, 4000


def _can_be_fitted(runs: xr.Dataset) -> bool:
    """Return True if the runs are a sample of independent numbers with distributions."""
    if "run" not in runs.dims or correlations(runs):
        return False
    distributions = (runs[n].attrs if n in runs.coords else {} for n in listed(runs, "varied"))
    kinds = [DISTRIBUTIONS.get(attrs.get("distribution", "")) for attrs in distributions]
    return all(kind is not None and not kind.is_discrete for kind in kinds)


@dataclass(frozen=True)
class Divided:
    """A sample, divided into parts, each to be predicted by a fit to the others, in order of `run`.

    length: of a block of runs, which differ in few parameters. near: how many runs in a row are
    near-copies, as along a period of FAST's highest frequency. part: that of each run, (runs,), of
    _FOLDS with the same number of blocks. tests: positions of the runs of the first parts, rising:
    of as many parts as hold _MOST_TESTS, or all; of more runs, a draw of as many.
    """

    sample: Sample
    length: int
    near: int
    part: NDArray[np.int64]
    tests: NDArray[np.int64]
    _inputs: dict[bytes, Floats] = field(default_factory=dict)

    @classmethod
    def of(cls, runs: xr.Dataset) -> Self:
        """Divide runs. Raises ValueError where blocks do not fit."""
        sample = Sample.of(runs)
        name, count = str(runs.attrs.get("method")), runs.sizes["run"]
        method, length = SAMPLES.get(name, RandomSample), 1
        if method.blocks:
            length = count // max(sample.number(method.blocks), 1)
        if length < 1 or count % length:
            raise ValueError(
                f"{sample.study} has {count} runs, not a whole number of blocks of its method "
                f"{name}: solve it again"
            )
        blocks = count // length
        part = np.repeat(sample.rng("surrogate held out").permutation(blocks) % _FOLDS, length)
        tested = part < int(np.clip(np.ceil(_MOST_TESTS * _FOLDS / count), 1, _FOLDS))
        tests = sample.rng("surrogate tests").permutation(np.flatnonzero(tested))[:_MOST_TESTS]
        near = method.near_runs(sample, length)
        return cls(sample, length, near, part, np.sort(tests))

    def inputs(self, rows: NDArray[np.int64]) -> Floats:
        """Return the parameters of these runs in SI units, (runs, parameters).

        They are kept: most responses are fitted to the same runs.
        """
        if (key := rows.tobytes()) not in self._inputs:
            self._inputs[key] = self.sample.rows(rows)
        return self._inputs[key]

    @property
    def polynomials(self) -> tuple[Polynomials, ...]:
        """Polynomials of each parameter."""
        return tuple(
            orthonormal(distribution_of(self.sample.runs[n].attrs)) for n in self.sample.parameters
        )

    def fit(
        self, values: Floats, training: NDArray[np.bool_], seed: int
    ) -> tuple[Chaos, NDArray[np.int64]]:
        """Return a chaos fitted to the runs of a mask, (runs,), and the rows that it used."""
        rows = np.flatnonzero(training)
        rows = rows[drawn(rows.size, seed)]  # before the numbers of all take as much memory
        return fit(self.inputs(rows), values[rows], seed, self.polynomials), rows

    def predicted(self, values: Floats, seed: int) -> Floats:
        """Return the tested runs, (tests,), each predicted by a fit to the other parts."""
        answered, parts = np.isfinite(values), self.part[self.tests]
        predictions = np.empty(parts.size)
        for part in np.unique(parts):
            chaos, _ = self.fit(values, answered & (self.part != part), seed)
            predictions[parts == part] = chaos(self.inputs(self.tests[parts == part]))
        return predictions


GOOD = 0.9
"""Lower end of the predictivity on runs left out from which on a surrogate needs no warning."""
FEW = 20  # distinct values up to which a response jumps between levels, where each comes ten times


class SurrogateVerdict(Verdict):
    """Verdicts on the surrogate of a response."""

    USABLE = True, "it predicts at least 90 % of the variance of runs left out (lower end)"
    POOR = False, "it may miss more than a tenth of the variance of runs left out"
    JUMPS = False, "the response jumps between few values or ranges, which no polynomial follows"
    MOSTLY_CONSTANT = False, "nine runs in ten share one value: it follows the others badly"
    FAILED_RUNS = False, "runs are missing: it knows nothing of where they failed"
    TOO_FEW_RUNS = False, "too few runs answered to fit and to test one: there is none"
    CONSTANT = False, "the response does not vary: there is none"


def surrogate(values: Floats, divided: Divided) -> tuple[SurrogateVerdict, dict[str, Any]]:
    """Fit and test a surrogate of one response, (runs,), NaN where missing.

    Returns the verdict, and by name the chaos and what `analysis` tells of it; nothing where
    constant or with too few runs, and no indices of a response in several regimes. q2 and its lower
    end are -inf where the tested values are all equal.
    """
    sample, answered = divided.sample, np.isfinite(values)
    tested = answered[divided.tests]
    parts = np.bincount(divided.part[answered], minlength=_FOLDS)
    few = parts.sum() - parts.max() < fewest_runs(len(sample.parameters))
    if few or np.count_nonzero(tested) < _FEWEST_TESTS:
        return SurrogateVerdict.TOO_FEW_RUNS, {}
    present = values if answered.all() else values[answered]
    if np.ptp(present) <= ROUND_OFF * max(present.max(), -present.min()):
        return SurrogateVerdict.CONSTANT, {}
    seed = int(sample.rng("surrogate fit").integers(2**31))
    predicted = divided.predicted(values, seed)
    tests = divided.tests[tested]
    errors = predicted[tested] - values[tests]
    places = np.unique(tests // divided.near).size
    q2, low = predictivity(errors, values[tests], tests // divided.length, places)
    rmse = float(np.sqrt(np.mean(errors**2)))
    chaos, rows = divided.fit(values, answered, seed)
    inputs, block = divided.inputs(rows), rows // divided.length
    pull = influence(chaos, inputs, values[rows], block, rmse)
    missed = min(max(1 - q2, 0.0), 1.0)
    properties = {"chaos": chaos, "q2": q2, "q2_low": low, "rmse": rmse, "runs": rows.size}
    properties |= error_model(leverage(chaos, divided.inputs(tests)), errors)
    properties["held_out"] = predicted
    if not (regimes := of_sample(sample, values).size):
        properties |= indices(chaos, sample.memberships, pull, missed, sample.confidence)
    levels, most = distinct(present)
    if present.size < values.size:
        return SurrogateVerdict.FAILED_RUNS, properties
    if most >= MOSTLY * present.size:
        return SurrogateVerdict.MOSTLY_CONSTANT, properties
    if levels <= min(FEW, present.size // 10) or regimes:
        return SurrogateVerdict.JUMPS, properties
    return SurrogateVerdict.USABLE if low >= GOOD else SurrogateVerdict.POOR, properties


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Return a polynomial chaos of every response, its test and its Sobol indices.

    Returns the variables of _NUMBERS as surrogate_<name> on `response` and the dimensions there,
    NaN where a response has no surrogate; surrogate_degree (surrogate_term, surrogate_input), of
    the coefficients' terms (see `basis`); and surrogate_verdict (response). Nothing unless the
    runs are a sample of independent numbers with distributions. Raises ValueError when the number
    of runs does not fit the sample.
    """
    if not _can_be_fitted(runs):
        return xr.Dataset()
    divided, names = Divided.of(runs), listed(runs, "responses")
    sample = divided.sample
    with threadpool_limits(limits=1):  # the same bits on any number of processors
        answers = [surrogate(usable(sample.runs, name).values[0], divided) for name in names]
    terms = [np.zeros((1, len(sample.parameters)), dtype=np.int64)]
    terms += [properties["chaos"].degrees for _, properties in answers if properties]
    degrees = np.unique(np.concatenate(terms), axis=0)
    for properties in (properties for _, properties in answers if properties):
        positions = (
            (degrees[:, np.newaxis] == properties["chaos"].degrees).all(axis=-1).argmax(axis=0)
        )
        properties["coefficient"] = np.zeros(len(degrees))
        properties["coefficient"][positions] = properties["chaos"].coefficients
    coordinates = labels(runs)
    for name, entries, long_name in (
        ("held_out", sample.runs["run"].values[divided.tests], "number of a run left out once"),
        ("parameter", sample.factors, "varied parameter"),
        ("surrogate_input", sample.parameters, "parameter that the surrogate depends on"),
    ):
        coordinates[name] = (name, np.asarray(entries), {"long_name": long_name})
    sizes = {"held_out": divided.tests.size, "parameter": len(sample.factors)}
    sizes["surrogate_term"] = len(degrees)
    variables: dict[str, Any] = {}
    for name, (dims, long_name, units) in _NUMBERS.items():
        gap = 0 if name == "runs" else np.full([sizes[dim] for dim in dims], np.nan)
        rows = [properties.get(name, gap) for _, properties in answers]
        attrs: dict[str, Any] = {"long_name": long_name.format(100 * sample.confidence)}
        attrs |= {"units": units} if units else {}
        attrs |= {"estimator": "polynomial chaos"} if dims == ("parameter",) else {}
        attrs |= {"confidence": sample.confidence} if name.endswith("_interval") else {}
        variables[f"surrogate_{name}"] = (("response", *dims), np.array(rows), attrs)
    long_name = (
        "degree of each term's polynomial in each parameter, orthonormal for its distribution"
    )
    term_dims = ("surrogate_term", "surrogate_input")
    variables["surrogate_degree"] = (term_dims, degrees, {"long_name": long_name, "units": "1"})
    codes = xr.DataArray([int(verdict) for verdict, _ in answers], dims="response")
    variables["surrogate_verdict"] = flagged(codes, SurrogateVerdict, "verdict on the surrogate")
    return xr.Dataset(variables, coordinates)


_HALF_WIDTH = "half-width of the {:g} % interval of the "
_FIRST, _TOTAL = (f"{order}-order Sobol index of the surrogate" for order in ("first", "total"))
_NUMBERS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "q2": (
        (),
        "predictivity of the surrogate: 1 - mean squared error / variance over the runs left out",
        "1",
    ),
    "q2_low": ((), "lower end of the 95 % interval of the predictivity", "1"),
    "rmse": ((), "root mean squared error over the runs left out, in the unit of the response", ""),
    "error": (
        (),
        "half-width of the 95 % interval of a prediction where the leverage is 1 or less, in the "
        "unit of the response",
        "",
    ),
    "error_growth": ((), "power of a leverage above 1 that the squared error grows with", "1"),
    "reach": ((), "highest leverage of a run left out", "1"),
    "runs": ((), "runs that the surrogate was fitted to", "1"),
    "held_out": (
        ("held_out",),
        "value at a run left out, by the surrogate of the others, in the unit of the response",
        "",
    ),
    "first_order": (("parameter",), _FIRST, "1"),
    "first_order_interval": (("parameter",), _HALF_WIDTH + _FIRST, "1"),
    "total_order": (("parameter",), _TOTAL, "1"),
    "total_order_interval": (("parameter",), _HALF_WIDTH + _TOTAL, "1"),
    "coefficient": (
        ("surrogate_term",),
        "coefficient of each product of polynomials, in the unit of the response",
        "",
    ),
}
"""What is known of a surrogate: dimensions beside `response`, long name, and unit."""


LEVEL = 0.95
"""Confidence level of the errors and of Q²."""
_GROWTHS = np.linspace(1.0, 4.0, 31)


def predictivity(
    errors: Floats, values: Floats, block: NDArray[np.int64], places: int
) -> tuple[float, float]:
    """Return Q² of runs that were left out, and the lower end of its interval.

    errors, values, block: (runs,); errors within a block depend on each other. places: how many
    of the runs are no near-copies of others. Q² is 1 less the mean squared
    error over the variance. The interval takes the logarithm of their ratio as normal, with the
    scatter of a jackknife over blocks: Efron and Tibshirani (1993), An Introduction to the
    Bootstrap, section 11.5 (recalled, not read). One place more, off by the whole variance, is
    added: few places do not show a rare regime. -inf where the values are all equal.
    """
    starts = np.flatnonzero(np.diff(block, prepend=-1))
    square = np.add.reduceat(errors**2, starts)
    spread = np.add.reduceat((values - values.mean()) ** 2, starts)
    count = square.size
    if spread.sum() <= 0 or count < 2:
        return -np.inf, -np.inf
    ratio = float(square.sum() / spread.sum())
    with np.errstate(divide="ignore", invalid="ignore"):
        without = np.log((square.sum() - square) / (spread.sum() - spread))
        scatter = np.sqrt((count - 1) * np.var(without)) if ratio > 0 else 0.0
    if not np.isfinite(scatter):  # all of the error, or of the variance, is in one block
        return 1 - ratio, -np.inf
    student = float(scipy.stats.t.ppf((1 + LEVEL) / 2, count - 1))
    return 1 - ratio, float(1 - ratio * np.exp(student * scatter) - 1 / places)


def error_model(leverages: Floats, errors: Floats) -> dict[str, float]:
    """Return how the error of a surrogate grows with the leverage of a point (see `leverage`).

    leverages, errors: of runs that were left out, both (runs,). Returns, by their names in an
    analysis: error, the half-width of the interval of a prediction where the leverage is 1 or less,
    in the response's unit; error_growth, the power of a larger leverage that the squared error
    grows with; and reach, the highest leverage.

    The growth is the largest that the likelihood of normal errors does not exclude, and 1 at
    least, as of a least-squares fit; the error is the quantile of the errors, each over its
    leverage to that power, that holds the share LEVEL of further ones: Lei et al. (2018), J.
    Am. Stat. Assoc. 113, 1094, section 5.2 (recalled, not read).

    The error does not fall below that at the average leverage, 1: in the middle the terms of the
    chaos are small, but those that it lacks are not. With one parameter anywhere in its range and
    the others at their medians, the intervals of 200 surrogates of 400 impacts in 8 parameters
    (studies/sobol.yaml) hold the solver's answer in 97 to 100 % per response, and in 88 to 100 %
    per response and parameter (tests/benchmarks/surrogate_coverage.py).
    """
    outward = np.maximum(leverages, 1.0)
    scaled = errors**2 / outward ** _GROWTHS[:, np.newaxis]
    mean = np.maximum(scaled.mean(axis=1), np.finfo(float).tiny)
    likelihood = -(_GROWTHS * np.log(outward).sum() + errors.size * np.log(mean)) / 2
    threshold = likelihood.max() - scipy.stats.chi2.ppf(LEVEL, 1) / 2
    largest = int(np.flatnonzero(likelihood >= threshold)[-1])
    ranked = np.sort(np.sqrt(scaled[largest]))
    rank = min(int(np.ceil(LEVEL * (errors.size + 1))), errors.size)
    return {
        "error": float(ranked[rank - 1]),
        "error_growth": float(_GROWTHS[largest]),
        "reach": float(leverages.max()),
    }


def half_width(leverage: Floats, error: Floats, growth: Floats) -> Floats:
    """Return half-widths of the intervals of predictions (see `error_model`)."""
    return np.asarray(error * np.maximum(leverage, 1.0) ** (growth / 2))


def leverage(chaos: Chaos, inputs: Floats) -> Floats:
    """Return the mean square of the terms at points, (points, parameters) to (points,).

    It is 1 on average over the distributions, and large at the ends of ranges and in corners: the
    terms that a fit lacks, and the errors of those that it has, grow as its terms do.
    """
    return np.asarray((basis(inputs, chaos.degrees, chaos.polynomials) ** 2).mean(axis=0))
