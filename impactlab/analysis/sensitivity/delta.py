"""Delta, the moment-independent measure, and the first order, both from given data, by SALib.

SALib's estimators with the bias reduction of Plischke et al. (2013), eq. 30, about the estimate on
the data themselves. SALib 1.6 takes a resample for these, which brings back the bias that the
reduction is to take away, and its "balanced" delta weighs the inputs anew, as if all of them were
uniform. The resamples are by the same formulae in a form that is many times faster.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from SALib.analyze.delta import calc_delta, sobol_first

from impactlab.analysis.sample import Sample
from impactlab.analysis.sensitivity.method import (
    Index,
    SensitivityMethod,
    apart_from_dummy,
    dummy_column,
)
from impactlab.types import Floats

GRID = 100
"""Places at which densities are compared, as in SALib."""
_2013 = "Plischke et al. (2013), Eur. J. Oper. Res. 226, 536"
_DUMMY = "of a random column that the model never saw"
_INDICES = {
    "delta": Index("delta, moment-independent importance", f"{_2013}, eqs. 26 and 30"),
    "delta_first_order": Index(
        "first-order Sobol index from given data",
        f"{_2013}, section 3",
        comment="of the variance between classes: a tenth too small with 5 classes (500 runs)",
    ),
    "dummy_delta": Index("delta of a dummy", f"{_2013}, eqs. 26 and 30", (), comment=_DUMMY),
    "dummy_delta_first_order": Index(
        "first-order Sobol index of a dummy from given data",
        f"{_2013}, section 3",
        (),
        comment=_DUMMY,
    ),
}


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    runs = len(outputs)
    inputs = np.column_stack([sample.inputs, dummy_column(sample)])
    exponent = 2.0 / (7.0 + np.tanh((1500.0 - runs) / 500.0))
    classes = round(min(int(np.ceil(runs**exponent)), 48))  # of a parameter's values, as in SALib
    edges = np.linspace(0, runs, classes + 1)
    places = np.linspace(outputs.min(), outputs.max(), GRID)
    values = np.full((inputs.shape[1], 2), np.nan)
    for at, column in enumerate(inputs.T):
        ordered = outputs[np.argsort(column, kind="stable")]
        # SALib takes a class with one value of the response alone for one without influence.
        if min(np.ptp(part) for part in np.split(ordered, edges[1:-1].astype(int))) > 0:
            values[at, 0] = calc_delta(outputs, places, column, edges)
        values[at, 1] = sobol_first(outputs, column, edges)
    drawn = sample.rng(response).integers(runs, size=(sample.resamples, runs))
    replicates = np.array([resampled(inputs[at], outputs[at], edges, places) for at in drawn])
    values[:, 0] = 2 * values[:, 0] - replicates[..., 0].mean(axis=0)
    spread = sample.half_width(replicates)
    delta = apart_from_dummy("delta", values[:, 0], spread[:, 0])
    return delta | apart_from_dummy("delta_first_order", values[:, 1], spread[:, 1])


def resampled(inputs: Floats, outputs: Floats, edges: Floats, places: Floats) -> Floats:
    """Return both of all parameters, (parameter, 2); NaN where a resample does not vary.

    inputs: (runs, parameters). Sums over the classes are sums over stretches of sorted runs.
    """
    starts = edges[:-1].astype(int)
    whole = _density(outputs, np.zeros(1, int), places)
    variance = outputs.var() or np.nan
    found = []
    for column in inputs.T:
        ordered = outputs[np.argsort(column, kind="stable")]
        sizes = np.diff(starts, append=len(ordered))
        shares = sizes / len(ordered)
        apart = np.trapezoid(np.abs(_density(ordered, starts, places) - whole), places, axis=0)
        means = np.add.reduceat(ordered, starts) / sizes
        first = (shares * (means - outputs.mean()) ** 2).sum() / variance
        found.append([(shares * apart).sum() / 2, first])
    return np.array(found)


def _density(outputs: Floats, starts: npt.NDArray[np.intp], places: Floats) -> Floats:
    """Return the density of each class of outputs at the places, (places, classes).

    outputs: (runs,), sorted by class; starts: where the classes begin. Gaussian kernels of
    Silverman's width, as scipy.stats.gaussian_kde has them; NaN for a class that does not vary.
    """
    sizes = np.diff(starts, append=len(outputs))
    means = np.repeat(np.add.reduceat(outputs, starts) / sizes, sizes)
    squares = np.add.reduceat((outputs - means) ** 2, starts) / (sizes - 1)
    width = np.sqrt(squares) * (0.75 * sizes) ** -0.2
    each = np.repeat(np.where(width > 0, width, np.nan), sizes)
    kernels = np.exp(-0.5 * ((places[:, None] - outputs) / each) ** 2)
    return np.asarray(
        np.add.reduceat(kernels, starts, axis=1) / (np.sqrt(2 * np.pi) * width * sizes)
    )


METHOD = SensitivityMethod("delta", _INDICES, Sample.ungrouped, _estimate)
