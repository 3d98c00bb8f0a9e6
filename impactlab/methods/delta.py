"""Delta, the moment-independent measure, and the first order, both from given data.

SALib's estimators in a form that is many times faster, with the bias reduction of Plischke et al.
(2013), eq. 30, about the estimate on the data themselves: SALib 1.6 takes a resample for these,
which brings back the bias that the reduction is to take away.

Densities smoothed by Silverman's width, in SALib's few classes of a parameter, lie too close to
each other where a response has several modes: of 2000 runs of Ishigami's function they give 0.21,
0.32 and 0.16 for 0.264, 0.425 and 0.209. Here the kernels have half of that width, and there
are twice as many classes: less smoothing would raise the noise of indices near zero. Two biases are
left, of opposite signs: that of smoothing is of the size of the change from half the classes and
twice the width, times SAFETY; that of noise is the delta of a dummy. The interval includes the
larger. The classes of a parameter that takes words are the words, and its dummy takes them, too.

The first order is the covariance of neighbours among the runs in the order of the parameter:
Gamboa et al. (2022). Neighbours share hardly any noise, so that few runs do not bias it.
"""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from impactlab.methods.hypercube import Hypercube
from impactlab.methods.record import (
    Family,
    IndexVariable,
    Indices,
    Measure,
    SensitivityVerdict,
    wide,
)
from impactlab.methods.runs import Sample, apart_from_dummy, dummy_column
from impactlab.types import Floats

GRID = 200  # places at which densities are compared
WIDTH = 0.5  # width of the kernels, relative to Silverman's
SAFETY = 1.5  # bias over change; one would do for an error that each halving of the width halves
COARSE = 20  # resamples for the bias of the estimate with half the classes and twice the width
Mask = npt.NDArray[np.bool_]
_2013 = "Plischke et al. (2013), Eur. J. Oper. Res. 226, 536"
_2022 = "Gamboa et al. (2022), Bernoulli 28, 2345, the estimator by ranks"
_VARIABLES = {
    "delta": IndexVariable(
        "delta, moment-independent importance",
        f"{_2013}, eqs. 26 and 30",
        comment="the interval includes the larger of two biases: that of noise, which is the delta "
        "of a dummy, and that of smoothing, 1.5 times the change of delta from half the classes "
        "and twice the width of the kernels",
    ),
    "delta_first_order": IndexVariable(
        "first-order Sobol index from given data", _2022, comment="below zero by noise alone"
    ),
    "dummy_delta": IndexVariable.of_dummy("delta of a dummy", f"{_2013}, eqs. 26 and 30"),
    "dummy_delta_first_order": IndexVariable.of_dummy(
        "first-order Sobol index of a dummy from given data", _2022
    ),
}
FAMILY = Family(
    "delta_indices",
    "Delta indices",
    (Measure("delta", "delta"), Measure("delta_first_order", "first order", optional=True)),
    "Index (–)",
    "Delta: half the area by which the density of a response changes, on average, once the "
    "parameter is known (Borgonovo); beside it the first-order index from the same runs.",
)


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    runs, of_words = len(outputs), np.array([name in sample.words for name in sample.parameters])
    shuffled = sample.rng("dummy words").permutation(sample.inputs)[:, of_words]
    inputs = np.column_stack([sample.inputs, dummy_column(sample), shuffled])
    exponent = 2.0 / (7.0 + np.tanh((1500.0 - runs) / 500.0))
    classes = round(min(int(np.ceil(runs**exponent)), 48))  # of a parameter's values, as in SALib
    places = np.linspace(outputs.min(), outputs.max(), GRID)
    categorical = np.array([*of_words, False, *of_words[of_words]])

    def reduced(count: int, width: float, rows: npt.NDArray[np.int64]) -> tuple[Floats, Floats]:
        """Return delta without its bias (eq. 30), and the resamples of it."""
        again = [
            deltas(inputs[row], outputs[row], count, places, width, categorical) for row in rows
        ]
        estimate = deltas(inputs, outputs, count, places, width, categorical)
        return 2 * estimate - np.mean(again, axis=0), np.array(again)

    draws = sample.rng(response).integers(runs, size=(sample.resamples, runs))
    values, replicates = reduced(2 * classes, WIDTH, draws)
    change = np.abs(values - reduced(classes, 2 * WIDTH, draws[:COARSE])[0])
    margins, dummy = sample.half_width(replicates), len(of_words)
    noise = np.full(dummy, values[dummy])
    noise[of_words] = values[dummy + 1 :]
    biases = np.maximum(SAFETY * change[:dummy], np.abs(noise))
    # the noise of the dummy is as uncertain as that of an index
    margins[:dummy] = np.hypot(margins[:dummy], margins[dummy]) + biases
    rows = slice(dummy + 1)
    first, errors = first_orders(inputs[:, rows], outputs)
    return apart_from_dummy("delta", values[rows], margins[rows]) | apart_from_dummy(
        "delta_first_order", first, sample.quantile * errors
    )


def deltas(
    inputs: Floats, outputs: Floats, classes: int, places: Floats, width: float, categorical: Mask
) -> Floats:
    """Return half the mean distance of the densities in classes of each parameter from that of all.

    inputs: (runs, parameters); outputs: (runs,); classes: their number, of equal size; width: of
    the kernels, relative to Silverman's; categorical: (parameters,), where the values
    are the classes. NaN where a class does not vary.
    """
    density = _density(outputs, np.zeros(1, int), places, width)
    equal = np.linspace(0, len(outputs), classes + 1)[:-1].astype(int)  # where classes begin
    distances = []
    for column, of_words in zip(inputs.T, categorical, strict=True):
        order = np.argsort(column, kind="stable")
        starts = np.flatnonzero(np.diff(column[order], prepend=-1)) if of_words else equal
        shares = np.diff(starts, append=len(outputs)) / len(outputs)
        apart = np.abs(_density(outputs[order], starts, places, width) - density)
        distances.append((shares * np.trapezoid(apart, places, axis=0)).sum() / 2)
    return np.array(distances)


def first_orders(inputs: Floats, outputs: Floats) -> tuple[Floats, Floats]:
    """Return first orders of each parameter and their standard errors, (parameters,).

    Runs of one word are neighbours in the order of the runs. The products of neighbours are
    correlated with the next; of that, what more distant ones have in common is no noise.
    """
    ordered = (outputs - outputs.mean())[np.argsort(inputs, axis=0, kind="stable")]
    products, squares = ordered[1:] * ordered[:-1], (ordered[1:] ** 2 + ordered[:-1] ** 2) / 2
    values = products.mean(axis=0) / outputs.var()
    residuals = (products - values * squares) / outputs.var()
    same, next_one, second = (
        (residuals[lag:] * residuals[: len(residuals) - lag]).mean(axis=0) for lag in range(3)
    )
    variance = same + 2 * np.maximum(next_one - second, 0.0)
    return values, np.sqrt(variance / len(outputs))


def _density(
    outputs: Floats, starts: npt.NDArray[np.intp], places: Floats, relative: float
) -> Floats:
    """Return the density of each class of outputs at the places, (places, classes).

    outputs: (runs,), sorted by class; starts: where the classes begin; relative: width of the
    Gaussian kernels over Silverman's. NaN for a class that does not vary.
    """
    sizes = np.diff(starts, append=len(outputs))
    means = np.repeat(np.add.reduceat(outputs, starts) / sizes, sizes)
    squares = np.add.reduceat((outputs - means) ** 2, starts) / np.maximum(sizes - 1, 1)
    width = relative * np.sqrt(squares) * (0.75 * sizes) ** -0.2
    widths = np.repeat(np.where(width > 0, width, np.nan), sizes)
    kernels = np.exp(-0.5 * ((places[:, None] - outputs) / widths) ** 2)
    sums = np.add.reduceat(kernels, starts, axis=1)
    return np.asarray(sums / (np.sqrt(2 * np.pi) * width * sizes))


def _judge(indices: Mapping[str, Floats]) -> list[SensitivityVerdict]:
    empty = bool(np.isnan(indices["delta"]).any())
    return wide(indices["delta_interval"]) + [SensitivityVerdict.NO_DENSITY] * empty


INDICES = Indices("delta", _VARIABLES, FAMILY, Sample.ungrouped, _estimate, _judge, fewest=64)


class Delta(Hypercube):
    """A Latin hypercube for Borgonovo's delta.

    {arguments}

    References
    ----------
    Plischke et al. (2013), Eur. J. Oper. Res. 226, 536, eqs. 26 and 30.

    {example}
    """

    records = (INDICES,)
    label = "Latin hypercube for delta indices"
