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

from impactlab.analysis.responses import Sample
from impactlab.analysis.sensitivity.method import Index, Method, apart_from_dummy
from impactlab.types import Floats

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


def _check(sample: Sample) -> None:
    sample.ungrouped()
    sample.ordered()
    curves = len(sample.parameters) + 1
    points, harmonics = sample.size // curves, sample.number("harmonics")
    sample.expect(points * curves, f"{curves} curves of {points} points")
    if points <= 4 * harmonics**2:
        raise ValueError(
            f"{sample.study}: {points} points per curve are too few for {harmonics} harmonics: "
            f"take more than {4 * harmonics**2}"
        )


def _curves(outputs: Floats, sample: Sample) -> list[Floats]:
    """Return the dummy's curve behind one per parameter; each is divided by its own variance."""
    return list(outputs.reshape(len(sample.parameters) + 1, -1))


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    curves, harmonics = _curves(outputs, sample), sample.number("harmonics")
    first, total = np.array([_orders(curve, harmonics) for curve in curves]).T
    points = curves[0].size
    half = math.ceil(points / 2)
    starts = sample.rng(response).integers(points, size=(sample.resamples, len(curves)))
    replicates = [
        [_orders(np.roll(one, -at)[:half], harmonics) for one, at in zip(curves, row, strict=True)]
        for row in starts
    ]
    spread = sample.half_width(np.array(replicates)).T
    found = apart_from_dummy("first_order", first, np.hypot(spread[0], first[-1]))
    return found | apart_from_dummy("total_order", total, np.hypot(spread[1], total[-1]))


def _orders(curve: Floats, harmonics: int) -> tuple[float, float]:
    """Return first and total order from a curve at SALib's frequency; NaN where it is constant."""
    if np.ptp(curve) == 0:
        return math.nan, math.nan
    frequency = math.floor((curve.size - 1) / (2 * harmonics))
    first, total = compute_orders(curve, curve.size, harmonics, frequency)
    return float(first), float(total)


METHOD = Method("fast", _INDICES, _check, _estimate, _curves)
