"""Batches of runs over dask: few under way at a time, sized by what they take."""

from __future__ import annotations

import time
from collections.abc import Iterator
from concurrent.futures import CancelledError
from typing import Any

import numpy as np
from distributed import Client, Future, KilledWorker, as_completed
from distributed.comm.core import CommClosedError

from impactlab.study.batches import Batches
from impactlab.study.engine import Engine
from impactlab.study.shard import Columns
from impactlab.study.solvers import SOLVERS
from impactlab.study.storage import Form, joined
from impactlab.study.work import Work

Array = np.ndarray[Any, Any]
Task = Future[tuple[Columns, float]]

_AHEAD = 3
"""Batches under way or waiting, a worker: the graph does not grow with the study."""
_LOOK_AGAIN = 1.0
"""Seconds between counts of the workers, which may come and go."""
_KEPT = "Finished runs are kept: the same command goes on from there."


def solve_batch(solver: str, cases: Array, form: Form, version: str) -> tuple[Columns, float]:
    """The task that dask runs: the answers, and the seconds that they took.

    Raises RuntimeError where the solver is not the caller's.
    """
    if version != SOLVERS[solver].VERSION:
        raise RuntimeError(
            "this dask worker has another version of impactlab: install the same one on all of them"
        )
    start = time.perf_counter()
    columns = SOLVERS[solver].solve(cases, form)
    return columns, time.perf_counter() - start


def solved(work: Work, missing: Array, engine: Engine) -> Iterator[tuple[Array, Columns]]:
    """Numbers and answers of the missing runs, as their batches finish; all that have, together.

    Raises OSError when no scheduler answers, or when its workers fail.
    """
    solver = SOLVERS[work.solver]
    first = work.cases(missing[:1])
    compiled_for = Form(work.form.samples, profiles=False)
    solver.solve(first[:0], compiled_for)  # before workers ask for it
    batches = Batches(missing, work.cost, solver.values(first, work.form))
    with engine.client() as client:
        crew = _Crew(client, work, batches)
        queue = as_completed(crew.more(), loop=client.loop)
        for finished in queue.batches():
            yield joined([crew.answer(future) for future in finished])
            queue.update(crew.more())


class _Crew:
    """The workers of a client, and what they are at."""

    def __init__(self, client: Client, work: Work, batches: Batches) -> None:
        self._client, self._work, self._batches = client, work, batches
        self._under_way: dict[Any, Array] = {}
        self._workers, self._counted = 1, 0.0

    def more(self) -> list[Task]:
        """New tasks, as many as the workers need to be busy."""
        self._count()
        futures = []
        while len(self._under_way) < _AHEAD * self._workers:
            runs = self._batches.take(self._workers)
            if not runs.size:
                break
            futures.append(self._submit(runs))
        return futures

    def answer(self, future: Task) -> tuple[Array, Columns]:
        """Numbers and answers of a finished batch. Raises OSError where its worker failed."""
        runs = self._under_way.pop(future.key)
        columns, seconds = _result(future)
        future.release()
        self._batches.learn(float(self._work.cost[runs].sum()), seconds)
        return runs, columns

    def _submit(self, runs: Array) -> Task:
        work = self._work
        version = SOLVERS[work.solver].VERSION
        future = self._client.submit(
            solve_batch, work.solver, work.cases(runs), work.form, version, pure=False
        )
        self._under_way[future.key] = runs
        return future

    def _count(self) -> None:
        """Threads of all workers; one before the first worker is there."""
        if time.monotonic() - self._counted > _LOOK_AGAIN:
            self._workers = max(1, sum(self._client.nthreads().values()))
            self._counted = time.monotonic()


def _result(future: Task) -> tuple[Columns, float]:
    try:
        columns, seconds = future.result()
    except KilledWorker as error:
        said = "a batch of runs ended every dask worker that took it (too little memory?)"
        raise OSError(f"{said}: {error} {_KEPT}") from error
    except (CancelledError, CommClosedError) as error:
        raise ConnectionError(f"the dask scheduler is gone. {_KEPT}") from error
    except (ImportError, RuntimeError) as error:
        raise OSError(f"a dask worker failed: {error}. {_KEPT}") from error
    return columns, seconds
