"""How numbers and lists of numbers are written in a deck."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

PER_LINE = 16
"""Entries that a data line may hold in both programs."""


def number(value: float) -> str:
    """At most 19 characters, of the 20 that CalculiX reads; 13 digits."""
    return f"{value:.12e}"


def values(*entries: float) -> str:
    """One data line."""
    return ", ".join(f"{entry:.9g}" for entry in entries)


def listed(numbers: Iterable[int] | NDArray[np.integer]) -> Iterator[str]:
    """Data lines of whole numbers, as many on each as it may hold."""
    words = [str(entry) for entry in np.asarray(numbers).tolist()]
    for start in range(0, len(words), PER_LINE):
        yield ", ".join(words[start : start + PER_LINE])
