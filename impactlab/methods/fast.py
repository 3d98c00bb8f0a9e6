"""Extended FAST: indices from the spectrum of the response along curves for each parameter.

Each parameter has a few curves, with phases and other frequencies of their own, so that what
differs between curves tells the error: intervals are Student's over the curves. A curve has whole
multiples of its own frequency as its number of points: harmonics beyond the last one fold onto
multiples, too, and none is lost. Harmonics of the other parameters that reach the upper half of
the spectrum are counted into the total order of each; the dummy shows how much that is, and its
index is added to the half-widths.
"""

from dataclasses import dataclass
from typing import Annotated, Any, Self

import numpy as np
import scipy  # its stats are loaded when first used
from pydantic import Field, model_validator

from impactlab.methods.record import IndexVariable, Indices, of_orders
from impactlab.methods.runs import Sample, apart_from_dummy
from impactlab.methods.sampling import MOST_RUNS, RandomSample
from impactlab.methods.sobol import FAMILY
from impactlab.types import Floats
from impactlab.validation.fields import Whole, at_key

_CURVES = 4
"""Curves of FAST per parameter: their differences tell the error of its indices."""
_1999 = "extended FAST: Saltelli et al. (1999), Technometrics 41, 39"
_DUMMY = "the index of a parameter that the model never sees, from curves of its own"
_INTERVAL = "the interval is Student's over the curves, widened by the index of the dummy"
_VARIABLES = {
    "first_order": IndexVariable("first-order Sobol index", f"{_1999}, eq. 11", comment=_INTERVAL),
    "total_order": IndexVariable(
        "total-order Sobol index", f"{_1999}, section 3", comment=_INTERVAL
    ),
    "dummy_first_order": IndexVariable(
        "first-order Sobol index of a dummy", f"{_1999}, eq. 11", (), comment=_DUMMY
    ),
    "dummy_total_order": IndexVariable(
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


INDICES = Indices(
    "fast",
    _VARIABLES,
    FAMILY,
    _check,
    _estimate,
    of_orders,
    _curves,
    order="moves along the values in waves",
)


@dataclass(frozen=True, kw_only=True)
class Fast(RandomSample):
    """Search curves of extended FAST: at most `samples` (D + 1) runs of D parameters.

    Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter.
    seed : int, default 1
        Equal seeds give equal runs.
    samples : int
        Number of runs per parameter; docs/studies.md has the least.
    harmonics : int, default 4
        Multiples of a parameter's frequency that are kept apart from other parameters.

    References
    ----------
    Saltelli et al. (1999), Technometrics 41, 39, eqs. 11 and 20.

    Examples
    --------
    >>> speed, depth = il.Uniform(1, 5), il.Uniform("26 mm", "29 mm")
    >>> sample = il.Fast(samples=1024, parameters={"velocity": speed, "beam_depth": depth})
    """

    records = (INDICES,)
    label = "extended FAST curves"
    no_distribution = "the runs lie along search curves, and are no independent draws"
    blocks = "curves"
    samples: Annotated[Whole, Field(ge=5, le=MOST_RUNS)]
    harmonics: Annotated[Whole, Field(ge=4, le=100)] = 4

    @property
    def frequency(self) -> int:
        """Frequency of a parameter on its own curves: odd, to share few factors with others."""
        largest = self.samples // (_CURVES * (2 * self.harmonics + 1))
        return largest - 1 + largest % 2

    @property
    def points(self) -> int:
        """Points of a curve: so many that the harmonics beyond the last fold onto harmonics."""
        return (2 * self.harmonics + 1) * self.frequency

    @property
    def curves(self) -> int:
        """Number of curves: those of each parameter, and of the dummy."""
        return _CURVES * (len(self.varied) + 1)

    @property
    def runs(self) -> int:
        """Number of runs: the points of all curves."""
        return self.curves * self.points

    @model_validator(mode="after")
    def _check_resolution(self) -> Self:
        # one frequency more than there are others: with fewer, intervals miss too often
        width = 2 * self.harmonics
        least = _CURVES * (width + 1) * (width * (len(self.varied) + 1) + 1)
        if self.samples < least:
            size = f"{self.harmonics} harmonics of {len(self.varied)} parameters"
            raise at_key("samples", f"must be at least {least:,} for {size}")
        return self

    @property
    def settings(self) -> dict[str, Any]:
        """The attributes of a design that describe its draws."""
        return super().settings | {"curves": self.curves, "frequency": self.frequency}

    def draws(self, start: int = 0, stop: int | None = None) -> Floats:
        """Draw the curves of one parameter after the other, last those of the dummy.

        Along a curve, the others have distinct frequencies up to 1/(2 M) of the parameter's own;
        frequencies and phases are drawn anew for each curve (Saltelli et al. 1999, eq. 20).
        """
        rng, size = np.random.default_rng(self.seed), len(self.varied)
        stop = self.runs if stop is None else stop
        runs = np.empty((stop - start, size))
        for curve in range(self.curves):
            parameter, before = curve // _CURVES, curve * self.points
            frequencies = 1 + rng.choice(
                self.frequency // (2 * self.harmonics), size, replace=False
            )
            if parameter < size:
                frequencies[parameter] = self.frequency
            phases = rng.uniform(0, 2 * np.pi, size)
            first, last = max(start - before, 0), min(stop - before, self.points)
            if first < last:
                angles = 2 * np.pi * np.arange(first, last)[:, None] / self.points
                waves = np.sin(frequencies * angles + phases)
                rows = slice(before + first - start, before + last - start)
                runs[rows] = 0.5 + np.arcsin(waves) / np.pi
        return runs

    @staticmethod
    def near_runs(sample: Sample, length: int) -> int:
        """Return how many runs in a row are alike, along a curve."""
        return 2 * sample.number("harmonics") + 1
