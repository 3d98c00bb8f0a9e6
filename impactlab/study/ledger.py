"""Which runs of a design are answered, and which run's answers stand for which others."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]


class Ledger:
    """A place for each run of a design; runs come by key, in whatever order."""

    def __init__(self, keys: Array) -> None:
        """keys: of the design's runs, shape (runs,)."""
        self._keys = keys
        self._order = np.argsort(keys, kind="stable")
        ascending = keys[self._order]
        self._repeats = self._order[1:][ascending[1:] == ascending[:-1]]
        self._done = np.zeros(keys.size, dtype=bool)
        self._done[self._repeats] = True

    @property
    def size(self) -> int:
        """The number of runs."""
        return int(self._keys.size)

    @property
    def distinct(self) -> int:
        """The number of runs that are equal to none before them."""
        return self.size - int(self._repeats.size)

    def find(self, keys: Array) -> tuple[Array, Array]:
        """Which of the keys are the design's, shape (keys,), and the first run of each of those."""
        places = np.searchsorted(self._keys, keys, sorter=self._order)
        runs = self._order[np.minimum(places, self._keys.size - 1)]
        asked: Array = self._keys[runs] == keys
        return asked, runs[asked]

    def mark(self, runs: Array) -> None:
        """These runs, by number, are answered."""
        self._done[runs] = True

    def missing(self) -> Array:
        """The runs without an answer, ascending; of equal runs the first stands for all."""
        return np.flatnonzero(~self._done)

    def left(self) -> int:
        """How many runs of the design lack an answer, equal ones counted each."""
        return int(np.count_nonzero(~self._done) + np.count_nonzero(~self._done[self._firsts()]))

    def spread(self, values: Array) -> Array:
        """The same array, shape (runs, ...): equal runs get the row of the first of them."""
        values[self._repeats] = values[self._firsts()]
        return values

    def _firsts(self) -> Array:
        return self.find(self._keys[self._repeats])[1]
