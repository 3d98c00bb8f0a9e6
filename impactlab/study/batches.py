"""How runs are put together into tasks: by what they cost, not by their number."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

_COST = 3e8
"""Of a second, in node-steps."""
_VALUES = 20_000_000
"""Stored numbers a batch, at most: bounds the memory of a task."""
_A_WORKER = 4
"""Batches a worker, at least: so that none idles while another works through the last one."""


def batches(
    cost: np.ndarray[Any, Any], values: int, runs: list[int], workers: int, seconds: float = 1.0
) -> Iterator[list[int]]:
    """The numbers of `runs` in consecutive batches of about equal cost.

    cost: of each of all runs, in node-steps; values: stored numbers a run; seconds: of a batch,
    about, at most.
    """
    limit = min(_COST * seconds, cost[runs].sum() / (_A_WORKER * workers))
    most = max(1, _VALUES // values)
    batch: list[int] = []
    spent = 0.0
    for run, price in zip(runs, cost[runs].tolist(), strict=True):
        if batch and (spent + price > limit or len(batch) >= most):
            yield batch
            batch, spent = [], 0.0
        batch.append(run)
        spent += price
    if batch:
        yield batch
