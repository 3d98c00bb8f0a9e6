"""Extended FAST: indices from the spectrum of the response along curves for each parameter.

Each parameter has a few curves, with phases and other frequencies of their own, so that what
differs between curves tells the error: intervals are Student's over the curves. A curve has whole
multiples of its own frequency as its number of points: harmonics beyond the last one fold onto
multiples, too, and none is lost. Harmonics of the other parameters that reach the upper half of
the spectrum are counted into the total order of each; the dummy shows how much that is, and its
index is added to the half-widths.
"""

from __future__ import annotations

import numpy as np
import scipy  # its stats are loaded when first used

from impactlab.analysis.responses import Sample
from impactlab.analysis.sensitivity.method import Index, Method, apart_from_dummy
from impactlab.types import Floats

_1999 = "extended FAST: Saltelli et al. (1999), Technometrics 41, 39"
_DUMMY = "the index of a parameter that the model never sees, from curves of its own"
_INTERVAL = "the interval is Student's over the curves, widened by the index of the dummy"
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
    points = (2 * sample.number("harmonics") + 1) * sample.number("frequency")
    curves = sample.number("curves")
    sample.expect(points * curves, f"{curves} curves of {points} points")


def _curves(outputs: Floats, sample: Sample) -> list[Floats]:
    """Return the runs of each parameter, and last those of the dummy; each part has to vary."""
    return list(outputs.reshape(len(sample.parameters) + 1, -1))


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    curves = outputs.reshape(
        len(sample.parameters) + 1, -1, outputs.size // sample.number("curves")
    )
    number, frequency = curves.shape[1], sample.number("frequency")
    spectrum = np.abs(np.fft.rfft(curves - curves.mean(axis=-1, keepdims=True))[..., 1:]) ** 2
    variance = spectrum.sum(axis=-1)
    parts = {
        "first_order": spectrum[..., frequency - 1 :: frequency].sum(axis=-1),
        "total_order": spectrum[..., frequency // 2 :].sum(axis=-1),
    }
    quantile = float(scipy.stats.t.ppf(0.5 + sample.confidence / 2, number - 1))
    indices: dict[str, Floats] = {}
    for name, part in parts.items():
        mean = variance.mean(axis=1)
        values = part.mean(axis=1) / mean
        residuals = part - values[:, None] * variance
        margins = quantile * residuals.std(axis=1, ddof=1) / (mean * np.sqrt(number))
        margins[:-1] += values[-1]
        indices |= apart_from_dummy(name, values, margins)
    return indices


METHOD = Method("fast", _INDICES, _check, _estimate, _curves)
