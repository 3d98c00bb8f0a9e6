"""Axes that stay readable at paper width: linear or logarithmic, few ticks, plain numbers."""

from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, MaxNLocator, NullFormatter
from numpy.typing import ArrayLike

from impactlab.figures import labels
from impactlab.types import Floats

Which = Literal["x", "y"]
_WIDE = 30.0  # ratio of the largest to the smallest value from which on an axis is logarithmic
_PLAIN = FuncFormatter(lambda value, _: labels.number(value))
_POWERS = FuncFormatter(lambda value, _: labels.number(value, plain=(1.0, 10.5)))


class _OneNotation(FuncFormatter):
    """Plain numbers, or powers of ten at every tick where one of them needs it."""

    def format_ticks(self, values: ArrayLike) -> list[str]:
        sizes = np.abs(np.asarray(values, dtype=float))
        zero = sizes <= 1e-9 * sizes.max(initial=0.0)  # but for round-off
        plain = bool((zero | ((sizes >= 1e-4) & (sizes < 1e5))).all())
        write = _PLAIN if plain else _POWERS
        return [write(value) for value in np.where(zero, 0.0, values)]


def fit(axes: Axes, which: Which, values: ArrayLike, ticks: int = 5) -> None:
    """Make the axis logarithmic for positive values over more than a factor of 30, else linear."""
    array = np.asarray(values, dtype=float)
    finite = array[np.isfinite(array)]
    if finite.size and finite.min() > 0 and finite.max() / finite.min() > _WIDE:
        logarithmic(axes, which, finite, ticks)
    else:
        linear(axes, which, ticks)


def linear(axes: Axes, which: Which | Literal["xy"], ticks: int = 5) -> None:
    """Make one axis or both linear, with at most `ticks` intervals and numbers without offset."""
    for letter in which:
        axis: Axis = getattr(axes, f"{letter}axis")
        axis.set_major_locator(MaxNLocator(ticks, steps=[1, 2, 2.5, 5, 10]))
        axis.set_major_formatter(_OneNotation(_PLAIN))


def logarithmic(axes: Axes, which: Which, values: ArrayLike, ticks: int = 5) -> None:
    """Make the axis logarithmic, with ticks at powers of ten or, over short ranges, between."""
    shown = positive(values)
    shown = shown[np.isfinite(shown)]
    ratio = float(shown.max() / shown.min()) if shown.size else 10.0
    if ratio < 3:
        digits: tuple[float, ...] = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0)
    else:
        digits = (1.0, 2.0, 5.0) if ratio < 120 else (1.0,)
    axes.set(**{f"{which}scale": "log"})
    axis: Axis = getattr(axes, f"{which}axis")
    axis.set_major_locator(LogLocator(subs=digits, numticks=ticks + 1))
    plain = shown.size == 0 or (shown.min() >= 1e-3 and shown.max() < 1e5)
    axis.set_major_formatter(_PLAIN if plain else _POWERS)  # one notation per axis
    axis.set_minor_formatter(NullFormatter())


def at(axes: Axes, which: Which, values: ArrayLike) -> None:
    """Put ticks at just these values."""
    axis: Axis = getattr(axes, f"{which}axis")
    axis.set_major_locator(FixedLocator([float(value) for value in np.ravel(values)]))
    axis.set_minor_locator(FixedLocator([]))
    axis.set_major_formatter(_OneNotation(_PLAIN))


def positive(values: ArrayLike, above: float = 0.0) -> Floats:
    """Return the values above `above`, NaN (a gap) for the rest."""
    array = np.asarray(values, dtype=float)
    return np.where(np.isfinite(array) & (array > above), array, np.nan)


def drawn(axes: Axes, which: Which) -> Floats:
    """Return where the points of all lines are along an axis, shape (points,)."""
    along = [np.asarray(getattr(line, f"get_{which}data")(), dtype=float) for line in axes.lines]
    return np.concatenate([np.empty(0), *along])


def apart(values: ArrayLike) -> list[float]:
    """Return the values that have room on a logarithmic axis, from the largest on."""
    ordered = np.sort(np.ravel(np.asarray(values, dtype=float)))[::-1]
    least = 0.18 * np.log(ordered[0] / ordered[-1])
    spaced: list[float] = []
    for value in ordered.tolist():
        if not spaced or np.log(spaced[-1] / value) >= least:
            spaced.append(value)
    return spaced


def spread(size: int, most: int) -> list[int]:
    """Return at most `most` positions of `size`, evenly spread, with the first and the last."""
    return [
        int(position) for position in np.unique(np.linspace(0, size - 1, min(size, most)).round())
    ]
