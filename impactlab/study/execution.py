"""From a design to its runs: batches over dask, finished ones kept, none solved twice."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from distributed import as_completed

from impactlab.dataset import status_bits
from impactlab.simulate import Answers
from impactlab.study.batches import batches
from impactlab.study.engine import Engine
from impactlab.study.progress import Progress
from impactlab.study.solvers import SOLVERS, solver_of
from impactlab.study.storage import Form, Shards, run_keys

log = logging.getLogger(__name__)
Array = np.ndarray[Any, Any]

_AHEAD = 3
"""Batches under way or waiting, a worker."""
_FAILED = status_bits(())


def execute(design: xr.Dataset, shards_folder: Path, engine: Engine) -> xr.Dataset:
    """Solve what of the design has not been solved yet, and return all of it as runs.nc holds it.

    design: see impactlab.study.sampling.design. Every finished batch is in `shards_folder`
    before the next one is counted, so that an interrupted study goes on from there.

    Raises ValueError when the model refuses a run, OSError when the disk is full or when no
    scheduler answers.
    """
    name = solver_of(design)
    solver = SOLVERS[name]
    cases = solver.cases(design)
    samples = int(design.attrs["history_samples"]) if design.attrs["histories"] else 0
    form = Form(samples, bool(design.attrs["profiles"]))
    keys = run_keys(cases, form, solver.VERSION)
    shards = Shards(shards_folder, form, solver.RESPONSE, solver.VERSION)
    known, parts = _known(shards)
    first_of = {key: run for run, key in reversed(list(enumerate(keys)))}
    missing = sorted(run for key, run in first_of.items() if key not in known)
    log.info("%d runs, %d of them solved before", len(keys), len(keys) - len(missing))
    for runs, answers in _solved(name, cases, missing, form, engine):
        shards.write([keys[run] for run in runs], answers)
        known |= {keys[run]: (len(parts), row) for row, run in enumerate(runs)}
        parts.append(answers)
    answers = gather(parts, [known[key] for key in keys])
    if len(parts) > 1:
        shards.replace_all(list(known), gather(parts, list(known.values())))
    return solver.labelled(design, answers)


def gather(parts: list[Answers], places: list[tuple[int, int]]) -> Answers:
    """One Answers with a run for each (part, row) of `places`, in that order."""
    offsets = np.cumsum([0, *(part.responses.size for part in parts)])
    rows = np.array([offsets[part] + row for part, row in places])

    def picked(arrays: list[Array]) -> Array:
        rows_of_all: Array = np.concatenate(arrays)[rows]
        return rows_of_all

    return Answers(
        picked([part.responses for part in parts]),
        {name: picked([part.histories[name] for part in parts]) for name in parts[0].histories},
        {name: picked([part.profiles[name] for part in parts]) for name in parts[0].profiles},
    )


def solve_batch(solver: str, cases: Array, form: Form, version: str) -> Answers:
    """The task that dask runs. Raises RuntimeError where the solver is not the caller's."""
    if version != SOLVERS[solver].VERSION:
        raise RuntimeError(
            "this dask worker has another version of impactlab: install the same one on all of them"
        )
    return SOLVERS[solver].solve(cases, form)


def _known(shards: Shards) -> tuple[dict[bytes, tuple[int, int]], list[Answers]]:
    """Where each run on disk is: key -> (part, row), and the parts."""
    known: dict[bytes, tuple[int, int]] = {}
    parts: list[Answers] = []
    for keys, answers in shards.read():
        known |= {key: (len(parts), row) for row, key in enumerate(keys)}
        parts.append(answers)
    return known, parts


def _solved(
    name: str, cases: Array, runs: list[int], form: Form, engine: Engine
) -> Iterator[tuple[list[int], Answers]]:
    """Batches of runs with their answers, in the order in which they finish."""
    if not runs:
        return
    solver = SOLVERS[name]
    solver.solve(
        cases[:0], Form(form.samples, profiles=False)
    )  # compiles before workers ask for it
    waiting = batches(
        solver.cost(cases),
        solver.values(cases, form),
        runs,
        engine.workers,
        engine.batch_seconds,
    )
    under_way: dict[Any, list[int]] = {}
    with (
        engine.client() as client,
        Progress(total=cases.size, done=cases.size - len(runs)) as progress,
    ):

        def submit(batch: list[int]) -> Any:
            future = client.submit(
                solve_batch, name, cases[batch], form, solver.VERSION, pure=False
            )
            under_way[future.key] = batch
            return future

        slots = _AHEAD * max(engine.workers, len(client.nthreads()))
        queue = as_completed([submit(batch) for batch in islice(waiting, slots)], loop=client.loop)
        for future in queue:
            answers = future.result()
            future.release()
            batch = under_way.pop(future.key)
            yield batch, answers
            failed = np.count_nonzero(answers.responses["status"] & _FAILED)
            progress.advance(len(batch), int(failed))
            queue.update([submit(batch) for batch in islice(waiting, 1)])
