"""How runs are put together into tasks: about a second each, by what finished ones took."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]

_FIRST_SECONDS = 0.1
"""Of the first tasks, which measure."""
_LEAST_SECONDS = 0.05
"""Of a task near the end."""
_SHARE = 2
"""A task is at most this part of a worker's share of what is left: none idles at the end."""
_SPEED = 3e8
"""Cost a second, before it is measured."""
_MEMORY = 0.8
"""Weight of all measurements so far beside the next one."""
_VALUES = 4_000_000
"""Stored numbers a task, at most: bounds its memory."""
_RUNS = 10_000
"""Runs a task, at most: its cases travel with it, and take 2 MB."""


class Batches:
    """Cuts runs into consecutive batches, sized when they are asked for."""

    def __init__(self, runs: Array, cost: Array, values: int, seconds: float = 1.0) -> None:
        """runs: their numbers; cost: of each, in a solver's unit; values: stored numbers a run.

        seconds: of a batch; one is long beside what dask and the disk take for it.
        """
        self._runs = runs
        self._until = np.concatenate([[0.0], np.cumsum(cost)])
        self._most = max(1, min(_RUNS, _VALUES // values))
        self._at = 0
        self._wished = seconds
        self._cost, self._seconds = 0.0, 0.0

    def take(self, workers: int) -> Array:
        """The numbers of the next runs; empty when all are taken."""
        start, spent = self._at, self._until[self._at]
        left = self._until[-1] - spent
        limit = spent + self._speed * self._target(left / self._speed / workers)
        stop = int(np.searchsorted(self._until, limit, side="right")) - 1
        self._at = min(max(stop, start + 1), start + self._most, self._runs.size)
        return self._runs[start : self._at]

    def learn(self, cost: float, seconds: float) -> None:
        """Size further batches by one that took so long."""
        self._cost = _MEMORY * self._cost + cost
        self._seconds = _MEMORY * self._seconds + seconds

    @property
    def _speed(self) -> float:
        return self._cost / self._seconds if self._seconds else _SPEED

    def _target(self, share: float) -> float:
        """Seconds of the next task; share: a worker's share of what is left, in s."""
        wished = self._wished if self._seconds else min(self._wished, _FIRST_SECONDS)
        return min(wished, max(share / _SHARE, _LEAST_SECONDS))
