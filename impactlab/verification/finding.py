"""What a check found: numbers beside their independent values, and curves to draw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Comparison:
    """One quantity, ours beside an independent value.

    ours, independent: in `units` (UDUNITS). error: how far they are apart, in the measure that
    `measure` names ("relative", "absolute", or such as "of the peak"). tolerance: the largest
    error that passes. where: the case, in words.
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
        """Whether the error is within the tolerance; never with a NaN."""
        return bool(abs(self.error) <= self.tolerance)

    @property
    def ratio(self) -> float:
        """The error in tolerances: above 1 it fails; infinite where there is no number."""
        size = abs(self.error)
        if size == 0.0:
            return 0.0
        return float(size / self.tolerance) if size < np.inf and self.tolerance > 0 else np.inf


def relative(
    quantity: str, where: str, units: str, ours: float, independent: float, tolerance: float
) -> Comparison:
    """A comparison by the relative difference."""
    error = ours / independent - 1.0 if independent else np.inf
    return Comparison(quantity, where, units, ours, independent, error, tolerance)


def absolute(
    quantity: str, where: str, units: str, ours: float, independent: float, tolerance: float
) -> Comparison:
    """A comparison by the difference, in `units`."""
    error = ours - independent
    return Comparison(quantity, where, units, ours, independent, error, tolerance, "absolute")


def curve(
    quantity: str, where: str, units: str, ours: Floats, independent: Floats, tolerance: float
) -> Comparison:
    """Two curves at the same points, by their largest difference over the largest value.

    The values told are those where they differ most.
    """
    gap = np.abs(ours - independent)
    worst = int(np.argmax(np.where(np.isnan(gap), np.inf, gap)))
    error = float(gap[worst] / np.max(np.abs(independent)))
    values = float(ours[worst]), float(independent[worst])
    return Comparison(quantity, where, units, *values, error, tolerance, "of the largest value")


def worst(entries: Sequence[Comparison]) -> Comparison:
    """The one nearest to failing, for a table that would else be long; a NaN comes first."""
    entry = max(entries, key=lambda entry: entry.ratio)
    return replace(entry, where=f"{entry.where} (the worst of {len(entries)})")


@dataclass(frozen=True)
class Curve:
    """A line to draw, x and y of shape (points,), in SI; independent: not from the solver."""

    label: str
    x: Floats
    y: Floats
    independent: bool = False


@dataclass(frozen=True)
class Panel:
    """Axes with their curves. x, y: (name, units); log: logarithmic axes, for errors."""

    title: str
    x: tuple[str, str]
    y: tuple[str, str]
    curves: Sequence[Curve]
    log: bool = False


@dataclass(frozen=True)
class Finding:
    """All that one check found."""

    comparisons: Sequence[Comparison]
    panels: Sequence[Panel] = field(default_factory=tuple)

    @property
    def passed(self) -> bool:
        """Whether there is a comparison, and all pass."""
        return bool(self.comparisons) and all(entry.passed for entry in self.comparisons)
