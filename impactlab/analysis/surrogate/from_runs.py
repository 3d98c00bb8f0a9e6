"""Surrogates of all responses of a sample: fitted, tested on held-out runs, and judged."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from impactlab.analysis.responses import Sample, correlations, labels, listed, usable
from impactlab.analysis.surrogate.chaos import drawn, fewest_runs, fit, indices, influence
from impactlab.analysis.verdicts import ROUND_OFF, Verdict, distinct, flagged
from impactlab.model.distributions import ARGUMENTS, cumulative
from impactlab.types import Floats

_SHARE = 0.2  # share of the blocks of runs to test on
_FEWEST_TESTS, _MOST_TESTS = 10, 4000
_BLOCKS = {"sobol": "base_samples", "morris": "trajectories"}
"""Methods whose runs come in blocks of near-copies, and the attribute with their number."""
_LENGTHS = {"fast": "samples"}
"""Methods whose blocks are curves through the cube, and the attribute with their length."""


def applies(runs: xr.Dataset) -> bool:
    """Return True if the runs are a sample of independent numbers with distributions."""
    if "run" not in runs.dims or correlations(runs):
        return False
    drawn = (runs[n].attrs if n in runs.coords else {} for n in listed(runs, "varied"))
    return all(each.get("distribution") in ARGUMENTS for each in drawn)


@dataclass(frozen=True)
class Divided:
    """A sample, divided into runs to fit to and runs to test on, in the order of `run`.

    length: of a block of runs, which differ in few parameters. held_out: mask of the runs that no
    surrogate sees, (runs,), a fifth of the blocks. tests: positions of these runs, rising; of more
    than _MOST_TESTS, a draw of as many.
    """

    sample: Sample
    length: int
    held_out: NDArray[np.bool_]
    tests: NDArray[np.int64]
    _units: dict[bytes, Floats] = field(default_factory=dict)

    @classmethod
    def of(cls, runs: xr.Dataset) -> Divided:
        """Divide runs. Raises ValueError where blocks do not fit."""
        sample = Sample.of(runs)
        method, count = str(runs.attrs.get("method")), runs.sizes["run"]
        length = sample.number(_LENGTHS[method]) if method in _LENGTHS else 1
        if method in _BLOCKS:
            length = count // max(sample.number(_BLOCKS[method]), 1)
        if length < 1 or count % length:
            raise ValueError(
                f"{sample.study} has {count} runs, not a whole number of blocks of its method "
                f"{method}: solve it again"
            )
        blocks = count // length
        shuffled = sample.rng("surrogate held out").permutation(blocks)
        held_blocks = np.zeros(blocks, dtype=bool)
        held_blocks[shuffled[: max(1, round(_SHARE * blocks))]] = True
        held_out = np.repeat(held_blocks, length)
        tests = sample.rng("surrogate tests").permutation(np.flatnonzero(held_out))[:_MOST_TESTS]
        return cls(sample, length, held_out, np.sort(tests))

    def unit(self, rows: NDArray[np.int64]) -> Floats:
        """Return the probability of each value in these runs, (runs, parameters).

        It is kept: most responses are fitted to the same runs.
        """
        if (key := rows.tobytes()) not in self._units:
            pairs = zip(self.sample.parameters, self.sample.rows(rows).T, strict=True)
            columns = [cumulative(self.sample.runs[name].attrs, column) for name, column in pairs]
            self._units[key] = np.column_stack(columns)
        return self._units[key]


GOOD = 0.9  # predictivity on held-out runs from which on a surrogate needs no warning
MOSTLY = 0.9
FEW = 20  # distinct values up to which a response jumps between levels, where each comes ten times


class SurrogateVerdict(Verdict):
    """Verdicts on the surrogate of a response."""

    USABLE = 0, True, "it predicts at least 90 % of the variance of runs held out"
    POOR = 1, False, "it misses more than a tenth of the variance of runs held out"
    JUMPS = 2, False, "the response jumps between few values, which no polynomial follows"
    MOSTLY_CONSTANT = 3, False, "nine runs in ten share one value: it follows the others badly"
    FAILED_RUNS = 4, False, "runs are missing: it knows nothing of where they failed"
    TOO_FEW_RUNS = 5, False, "too few runs answered to fit and to test one: there is none"
    CONSTANT = 6, False, "the response does not vary: there is none"


def surrogate(values: Floats, divided: Divided) -> tuple[SurrogateVerdict, dict[str, Any]]:
    """Fit and test a surrogate of one response, (runs,), NaN where missing.

    Returns the verdict, and by name the chaos and what `analysis` tells of it; nothing where
    constant or with too few runs. q2 is -inf where the tested values are all equal.
    """
    sample, answered = divided.sample, np.isfinite(values)
    training = answered & ~divided.held_out
    number = int(np.count_nonzero(training))
    tested = answered[divided.tests]
    few = number < fewest_runs(len(sample.parameters))
    if few or np.count_nonzero(tested) < _FEWEST_TESTS:
        return SurrogateVerdict.TOO_FEW_RUNS, {}
    known = values if answered.all() else values[answered]
    if np.ptp(known) <= ROUND_OFF * max(known.max(), -known.min()):
        return SurrogateVerdict.CONSTANT, {}
    seed = int(sample.rng("surrogate fit").integers(2**31))
    picked = drawn(number, seed)  # before the numbers of all take as much memory
    rows = np.flatnonzero(training)[picked]
    unit, block = divided.unit(rows), rows // divided.length
    chaos = fit(unit, values[rows], seed)
    predicted = chaos(divided.unit(divided.tests))
    square = float(np.mean((predicted - values[divided.tests])[tested] ** 2))
    variance = float(np.var(values[divided.tests][tested]))
    q2, rmse = 1 - square / variance if variance > 0 else -np.inf, float(np.sqrt(square))
    pull = influence(chaos, unit, values[rows], block, rmse)
    missed = min(max(1 - q2, 0.0), 1.0)
    found = {"chaos": chaos, "q2": q2, "rmse": rmse, "runs": rows.size, "held_out": predicted}
    found |= indices(chaos, sample.memberships, pull, missed, sample.confidence)
    levels, most = distinct(known)
    if known.size < values.size:
        return SurrogateVerdict.FAILED_RUNS, found
    if most >= MOSTLY * known.size:
        return SurrogateVerdict.MOSTLY_CONSTANT, found
    if levels <= min(FEW, known.size // 10):
        return SurrogateVerdict.JUMPS, found
    return SurrogateVerdict.USABLE if q2 >= GOOD else SurrogateVerdict.POOR, found


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """Return a polynomial chaos of every response, its test and its Sobol indices.

    Returns the variables of _NUMBERS as surrogate_<name> on `response` and the dimensions there,
    NaN where a response has no surrogate; surrogate_degree (surrogate_term, surrogate_input), of
    the coefficients' terms (see `basis`); and surrogate_verdict (response). Raises ValueError when
    the number of runs does not fit the sample.
    """
    divided, names = Divided.of(runs), listed(runs, "responses")
    sample = divided.sample
    with threadpool_limits(limits=1):  # the same bits on any number of processors
        answers = [surrogate(usable(sample.runs, name).values[0], divided) for name in names]
    terms = [np.zeros((1, len(sample.parameters)), dtype=np.int64)]
    terms += [found["chaos"].degrees for _, found in answers if found]
    degrees = np.unique(np.concatenate(terms), axis=0)
    for found in (found for _, found in answers if found):
        at = (degrees[:, np.newaxis] == found["chaos"].degrees).all(axis=-1).argmax(axis=0)
        found["coefficient"] = np.zeros(len(degrees))
        found["coefficient"][at] = found["chaos"].coefficients
    coordinates = labels(runs)
    for name, entries, words in (
        ("held_out", sample.runs["run"].values[divided.tests], "number of a run held out"),
        ("parameter", sample.factors, "varied parameter"),
        ("surrogate_input", sample.parameters, "parameter that the surrogate depends on"),
    ):
        coordinates[name] = (name, np.asarray(entries), {"long_name": words})
    sizes = {"held_out": divided.tests.size, "parameter": len(sample.factors)}
    sizes["surrogate_term"] = len(degrees)
    variables: dict[str, Any] = {}
    for name, (dims, words, units) in _NUMBERS.items():
        gap = 0 if name == "runs" else np.full([sizes[dim] for dim in dims], np.nan)
        rows = [found.get(name, gap) for _, found in answers]
        attrs: dict[str, Any] = {"long_name": words.format(100 * sample.confidence)}
        attrs |= {"units": units} if units else {}
        attrs |= {"estimator": "polynomial chaos"} if dims == ("parameter",) else {}
        attrs |= {"confidence": sample.confidence} if name.endswith("_interval") else {}
        variables[f"surrogate_{name}"] = (("response", *dims), np.array(rows), attrs)
    words = "degree of each term's Legendre polynomial in each parameter"
    term_dims = ("surrogate_term", "surrogate_input")
    variables["surrogate_degree"] = (term_dims, degrees, {"long_name": words, "units": "1"})
    codes = xr.DataArray([int(verdict) for verdict, _ in answers], dims="response")
    variables["surrogate_verdict"] = flagged(codes, SurrogateVerdict, "verdict on the surrogate")
    return xr.Dataset(variables, coordinates)


_HALF_WIDTH = "half-width of the {:g} % interval of the "
_FIRST, _TOTAL = (f"{order}-order Sobol index of the surrogate" for order in ("first", "total"))
_NUMBERS: dict[str, tuple[tuple[str, ...], str, str]] = {
    "q2": (
        (),
        "predictivity of the surrogate: 1 - mean squared error / variance over the runs held out",
        "1",
    ),
    "rmse": ((), "root mean squared error over the runs held out, in the unit of the response", ""),
    "runs": ((), "runs that the surrogate was fitted to", "1"),
    "held_out": (
        ("held_out",),
        "the surrogate's value at a run held out, in the unit of the response",
        "",
    ),
    "first_order": (("parameter",), _FIRST, "1"),
    "first_order_interval": (("parameter",), _HALF_WIDTH + _FIRST, "1"),
    "total_order": (("parameter",), _TOTAL, "1"),
    "total_order_interval": (("parameter",), _HALF_WIDTH + _TOTAL, "1"),
    "coefficient": (
        ("surrogate_term",),
        "coefficient of each Legendre product, in the unit of the response",
        "",
    ),
}
"""What is known of a surrogate: dimensions beside `response`, long name, and unit."""
