"""How runs are put together into tasks: by what they cost, not by their number."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from impactlab.dataset import HISTORIES, PROFILES, RESPONSES
from impactlab.model.cost import node_steps
from impactlab.study.storage import Form

_COST = 3e8
"""Node-steps a batch, at most: about a second."""
_VALUES = 20_000_000
"""Stored numbers a batch, at most: bounds the memory of a task."""
_A_WORKER = 4
"""Batches a worker, at least: so that none idles while another works through the last one."""


def batches(
    cases: np.ndarray[Any, Any], runs: list[int], form: Form, workers: int
) -> Iterator[list[int]]:
    """The numbers of `runs` in consecutive batches of about equal cost."""
    cost = node_steps(cases[runs])
    limit = min(_COST, cost.sum() / (_A_WORKER * workers))
    most = max(1, _VALUES // _values_a_run(cases, form))
    batch: list[int] = []
    spent = 0.0
    for run, price in zip(runs, cost, strict=True):
        if batch and (spent + price > limit or len(batch) >= most):
            yield batch
            batch, spent = [], 0.0
        batch.append(run)
        spent += price
    if batch:
        yield batch


def _values_a_run(cases: np.ndarray[Any, Any], form: Form) -> int:
    profile = int(cases[0].nodes) * int(cases[0].points) if form.profiles else 0
    return len(RESPONSES) + len(HISTORIES) * form.samples + len(PROFILES) * profile
