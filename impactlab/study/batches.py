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
    """Cuts runs into batches, sized when they are asked for: consecutive, after the costly ones.

    A run that is a task of its own comes first, the costliest of all ahead: none is left to one
    worker while the others idle.
    """

    def __init__(self, runs: Array, cost: Array, values: int, seconds: float = 1.0) -> None:
        """runs: their numbers, out of those that `cost` holds, in a solver's unit.

        values: stored numbers a run; seconds: of a batch, long beside what dask and the disk take
        for one.
        """
        alone = np.where(cost[runs] > _SPEED * seconds, cost[runs], 0.0)
        self._runs, self._costs = runs[np.argsort(-alone, kind="stable")], cost
        self._wished = seconds
        self._most = max(1, min(_RUNS, _VALUES // values))
        self._at, self._left = 0, float(cost[runs].sum())
        self._cost, self._seconds = 0.0, 0.0

    def take(self, workers: int) -> Array:
        """The numbers of the next runs; empty when all are taken."""
        ahead = self._runs[self._at : self._at + self._most]
        until = np.cumsum(self._costs[ahead])
        limit = self._speed * self._target(self._left / self._speed / workers)
        taken = max(1, int(np.searchsorted(until, limit, side="right")))
        runs = ahead[:taken]
        self._at += runs.size
        self._left -= float(self._costs[runs].sum())
        return runs

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
