"""Comparisons of numbers and curves of the solver with independent ones."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import xarray as xr

from impactlab.types import Floats


@dataclass(frozen=True)
class Comparison:
    """One quantity of the solver beside an independent value.

    ours, independent: in `units` (UDUNITS). error: the difference in the measure that `measure`
    names ("relative", "absolute", or such as "of the peak"). tolerance: the largest error that
    passes. where: the case, in words.
    """

    quantity: str
    where: str
    units: str
    ours: float
    independent: float
    error: float
    tolerance: float
    measure: str = "relative"

    @property
    def passed(self) -> bool:
        """True if the error is within the tolerance; a NaN never is."""
        return bool(abs(self.error) <= self.tolerance)

    @property
    def ratio(self) -> float:
        """Error over tolerance: above 1 the comparison fails; infinite for a NaN."""
        size = abs(self.error)
        if size == 0.0:
            return 0.0
        return float(size / self.tolerance) if size < np.inf and self.tolerance > 0 else np.inf


class Comparisons(list[Comparison]):
    """Comparisons in one case; where: the case, in words. A method adds one and returns all."""

    def __init__(self, where: str = "") -> None:
        """Begin without any."""
        super().__init__()
        self.where = where

    def relative(
        self, quantity: str, units: str, ours: float, independent: float, tolerance: float
    ) -> Self:
        """Add the relative difference, which is infinite where the independent value is zero."""
        error = ours / independent - 1.0 if independent else np.inf
        self.append(Comparison(quantity, self.where, units, ours, independent, error, tolerance))
        return self

    def absolute(
        self, quantity: str, units: str, ours: float, independent: float, tolerance: float
    ) -> Self:
        """Add the difference, in `units`."""
        values = ours, independent, ours - independent, tolerance, "absolute"
        self.append(Comparison(quantity, self.where, units, *values))
        return self

    def responses(self, run: xr.Dataset, expected: Mapping[str, float], tolerance: float) -> Self:
        """Add the relative differences of responses of a run from those expected, by variable."""
        for name, value in expected.items():
            ours, units = run[name].item(), run[name].attrs["units"]
            self.relative(name.replace("_", " "), units, ours, value, tolerance)
        return self

    def curve(
        self, quantity: str, units: str, ours: Floats, independent: Floats, tolerance: float
    ) -> Self:
        """Add the largest difference of two curves at the same points, over the largest value.

        The comparison holds the values at the point where they differ most.
        """
        gap = np.abs(ours - independent)
        worst = int(np.argmax(gap))  # the first NaN where there is one
        error = float(gap[worst] / np.max(np.abs(independent)))
        values = float(ours[worst]), float(independent[worst]), error, tolerance
        self.append(Comparison(quantity, self.where, units, *values, "of the largest value"))
        return self

    def worst(self, rows: Iterable[Sequence[Comparison]]) -> Self:
        """Add the one nearest to failing of each column of rows of alike comparisons."""
        self.extend(map(worst, zip(*rows, strict=True)))
        return self


def rms_error(ours: Floats, independent: Floats) -> float:
    """Return the root mean square of the difference over the largest independent value."""
    gap = ours - independent
    return float(np.sqrt(np.mean(gap**2)) / np.max(np.abs(independent)))


def worst(entries: Sequence[Comparison]) -> Comparison:
    """Return the comparison nearest to failing, to shorten a table; a NaN comes first."""
    entry = max(entries, key=lambda entry: entry.ratio)
    return replace(entry, where=f"{entry.where} (the worst of {len(entries)})")
