"""Extended FAST: indices from the spectrum of the response along a curve for each parameter.

By SALib's estimators. Its bootstrap of half curves is known to tell little (SALib issue 649: it
leaves out the bias of the method), and draws from numpy's global stream: here the same half curves
are drawn from a stream of their own, and what the method gives for a dummy, which ought to be zero,
is added in quadrature.
"""

from __future__ import annotations

import math

import numpy as np
from SALib.analyze.fast import compute_orders

from impactlab.analysis.sensitivity.method import Array, Index, Sample, SensitivityMethod

_1999 = "extended FAST: Saltelli et al. (1999), Technometrics 41, 39"
_DUMMY = "the index of a parameter that the model never sees, from a curve of its own"
_INTERVAL = (
    "intervals are indicative only: bootstrap of half curves, with the index of the dummy added in "
    "quadrature"
)
_INDICES = {
    "first_order": Index("first-order Sobol index", f"{_1999}, eq. 11", comment=_INTERVAL),
    "total_order": Index("total-order Sobol index", f"{_1999}, section 3", comment=_INTERVAL),
    "dummy_first_order": Index(
        "first-order Sobol index of a dummy", f"{_1999}, eq. 11", (), comment=_DUMMY
    ),
    "dummy_total_order": Index(
        "total-order Sobol index of a dummy", f"{_1999}, section 3", (), comment=_DUMMY
    ),
}


def check(sample: Sample) -> None:
    """Raise ValueError where the runs are not a curve for each parameter and the dummy."""
    sample.ungrouped()
    curves = len(sample.parameters) + 1
    points, harmonics = len(sample.inputs) // curves, sample.number("harmonics")
    sample.expect(points * curves, f"{curves} curves of {points} points")
    if points <= 4 * harmonics**2:
        raise ValueError(
            f"{sample.study}: {points} points per curve are too few for {harmonics} harmonics: "
            f"take more than {4 * harmonics**2}"
        )


def varying(outputs: Array, sample: Sample) -> list[Array]:
    """Return the curves, each of which has to vary: it is divided by its own variance."""
    return list(_curves(outputs, sample))


def estimate(outputs: Array, sample: Sample, response: str) -> dict[str, Array]:
    """Return indices of one response and half-widths of their intervals, by variable name.

    outputs: (runs,), one curve per parameter and the dummy's last, finite and varying.
    """
    curves, harmonics = _curves(outputs, sample), sample.number("harmonics")
    found = np.array([_orders(curve, harmonics) for curve in curves]).T
    starts = sample.rng(response).integers(curves.shape[1], size=(sample.resamples, len(curves)))
    replicates = [
        [_orders(_half(curve, at), harmonics) for curve, at in zip(curves, row, strict=True)]
        for row in starts
    ]
    spread = sample.half_width(np.array(replicates)).T
    spread = np.hypot(spread, found[:, -1:])
    result: dict[str, Array] = {}
    for name, values, margins in zip(("first_order", "total_order"), found, spread, strict=True):
        result |= {name: values[:-1], f"{name}_interval": margins[:-1]}
        result |= {f"dummy_{name}": values[-1], f"dummy_{name}_interval": margins[-1]}
    return result


def _curves(outputs: Array, sample: Sample) -> Array:
    return outputs.reshape(len(sample.parameters) + 1, -1)


def _orders(curve: Array, harmonics: int) -> tuple[float, float]:
    """Return first and total order from one curve, whose parameter has SALib's frequency.

    NaN where it does not vary, as half of a curve may.
    """
    if np.ptp(curve) == 0:
        return math.nan, math.nan
    frequency = math.floor((curve.size - 1) / (2 * harmonics))
    first, total = compute_orders(curve, curve.size, harmonics, frequency)
    return float(first), float(total)


def _half(curve: Array, start: int) -> Array:
    """Return half of a closed curve, beginning at `start`."""
    return np.roll(curve, -start)[: math.ceil(curve.size / 2)]


METHOD = SensitivityMethod("fast", lambda sample: _INDICES, check, estimate, varying=varying)
