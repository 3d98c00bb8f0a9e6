"""RBD-FAST: first-order indices from the spectrum of given data in the order of a parameter.

The runs are put into the order of a parameter, first every other one upwards, then the others
downwards, so that the response makes one period. Its first harmonics are what the parameter alone
explains: a regression on cosines and sines, whose share of the variance is adjusted for the number
of its terms (Tissot and Prieur 2012). The error of the share adds up that of the residuals and that
of the noise that the terms fit. A response that jumps has harmonics without end; those left out are
about what the second half of the others adds, so that the interval is wider by that, times SAFETY.
"""

import numpy as np
import scipy  # its stats are loaded when first used

from impactlab.methods.hypercube import Hypercube
from impactlab.methods.record import IndexVariable, Indices, by_width
from impactlab.methods.runs import Sample, apart_from_dummy, dummy_column
from impactlab.methods.sobol import FAMILY
from impactlab.types import Floats

HARMONICS = 10  # least number; the root of the runs where that is more, to follow jumps
SAFETY = 1.5  # missing harmonics over what the second half adds; one would do for a jump
_SOURCE = (
    "RBD-FAST: Tarantola et al. (2006), Reliab. Eng. Syst. Saf. 91, 717, adjusted as in Tissot and "
    "Prieur (2012), Reliab. Eng. Syst. Saf. 107, 205"
)
_VARIABLES = {
    "first_order": IndexVariable(
        "first-order Sobol index", _SOURCE, comment="below zero by noise alone"
    ),
    "dummy_first_order": IndexVariable.of_dummy("first-order Sobol index of a dummy", _SOURCE),
}


def _check(sample: Sample) -> None:
    sample.ungrouped()
    sample.ordered()


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    inputs, runs = np.column_stack([sample.inputs, dummy_column(sample)]), len(outputs)
    harmonics = max(HARMONICS, round(np.sqrt(runs)))
    order = np.argsort(inputs, axis=0, kind="stable")
    period = np.concatenate([order[::2], order[1::2][::-1]])
    ordered = (outputs - outputs.mean())[period]
    shares, errors = _first_orders(ordered, harmonics)
    growth = np.maximum(shares - _first_orders(ordered, harmonics // 2)[0], 0.0)
    freedom = runs - 2 * harmonics - 1
    quantile = float(scipy.stats.t.ppf(0.5 + sample.confidence / 2, freedom))
    return apart_from_dummy("first_order", shares, quantile * errors + SAFETY * growth)


def _first_orders(ordered: Floats, harmonics: int) -> tuple[Floats, Floats]:
    """Return shares of the variance in the first harmonics and their standard errors, (columns,).

    ordered: centred outputs, (runs, columns), each in the order of a parameter.
    """
    runs, part = len(ordered), 2 * harmonics / len(ordered)
    spectrum = np.fft.rfft(ordered, axis=0)
    spectrum[: harmonics + 1] = 0.0
    squares, residuals = ordered**2, np.fft.irfft(spectrum, runs, axis=0) ** 2
    variance = squares.mean(axis=0)
    unexplained = residuals.mean(axis=0) / variance / (1.0 - part)
    influence = squares * unexplained - residuals / (1.0 - part)
    noise = 2.0 * part * unexplained**2 / (1.0 - part)
    error = np.sqrt((influence.var(axis=0) / variance**2 + noise) / runs)
    return 1.0 - unexplained, error


INDICES = Indices(
    "rbd_fast",
    _VARIABLES,
    FAMILY,
    _check,
    _estimate,
    by_width("first_order"),
    fewest=64,
    order="moves along the values in waves",
)


class RbdFast(Hypercube):
    """A Latin hypercube for first-order Sobol indices by RBD-FAST.

    {arguments}

    References
    ----------
    Tarantola et al. (2006), Reliab. Eng. Syst. Saf. 91, 717; Tissot and Prieur (2012), Reliab. Eng.
    Syst. Saf. 107, 205.

    {example}
    """

    records = (INDICES,)
    label = "Latin hypercube for RBD-FAST"
