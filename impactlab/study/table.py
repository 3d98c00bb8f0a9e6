"""The answers of a design, in memory once: filled by key, in whatever order they come."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np

from impactlab.study.shard import Columns

Array = np.ndarray[Any, Any]


class Table:
    """A row a run of the design, and the columns that are asked for."""

    def __init__(self, keys: Array, names: Collection[str]) -> None:
        """keys: of the design's runs, shape (runs,); names: of the columns to hold."""
        self._keys, self._names = keys, names
        self._order = np.argsort(keys, kind="stable")
        ascending = keys[self._order]
        self._repeats = self._order[1:][ascending[1:] == ascending[:-1]]
        self._columns: Columns = {}
        self._done = np.zeros(keys.size, dtype=bool)
        self._done[self._repeats] = True

    def fill(self, keys: Array, columns: Columns) -> None:
        """Take the answers of those keys that are the design's."""
        asked, rows = self._rows(keys)
        for name in self._names:
            values = columns[name]
            if name not in self._columns:
                shape = (self._keys.size, *values.shape[1:])
                self._columns[name] = np.zeros(shape, dtype=values.dtype)
            self._columns[name][rows] = values[asked]
        self._done[rows] = True

    def missing(self) -> Array:
        """The runs without an answer, ascending; of equal runs the first stands for all."""
        return np.flatnonzero(~self._done)

    def left(self) -> int:
        """How many runs of the design lack an answer, equal ones counted each."""
        _, firsts = self._rows(self._keys[self._repeats])
        return int(np.count_nonzero(~self._done) + np.count_nonzero(~self._done[firsts]))

    def columns(self) -> Columns:
        """The answers, a row a run of the design."""
        _, rows = self._rows(self._keys[self._repeats])
        for values in self._columns.values():
            values[self._repeats] = values[rows]
        return self._columns

    def _rows(self, keys: Array) -> tuple[Array, Array]:
        """Which of the keys are the design's, shape (keys,), and the first run of each of those."""
        places = np.searchsorted(self._keys, keys, sorter=self._order)
        rows = self._order[np.minimum(places, self._keys.size - 1)]
        asked: Array = self._keys[rows] == keys
        return asked, rows[asked]
