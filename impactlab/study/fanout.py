"""Batches of runs over dask: few under way at a time, sized by what they take."""

from __future__ import annotations

import asyncio
import logging
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
from impactlab.study.solvers import solver_named
from impactlab.study.storage import Form, joined
from impactlab.study.work import Work

log = logging.getLogger(__name__)
Array = np.ndarray[Any, Any]
Result = tuple[Columns, float]
Task = Future[Result]

_AHEAD = 3
"""Batches under way or waiting, a worker: the graph does not grow with the study."""
_LOOK_AGAIN = 1.0
"""Seconds between counts of the workers, which may come and go."""
_PAUSE = 0.001, 0.05
"""Seconds between looks at what has finished, first and last: a look takes 0.1 ms."""
_KEPT = "Finished runs are kept: the same command goes on from there."
_GONE = f"the dask scheduler is gone. {_KEPT}"


def solve_batch(solver: str, cases: Array, form: Form, version: str) -> Result:
    """The task that dask runs: the answers, and the seconds that they took.

    Raises RuntimeError where the solver is not the caller's.
    """
    if version != solver_named(solver).VERSION:
        raise RuntimeError(
            "this dask worker has another version of impactlab: install the same one on all of them"
        )
    start = time.perf_counter()
    columns = solver_named(solver).solve(cases, form)
    return columns, time.perf_counter() - start


def solved(work: Work, missing: Array, engine: Engine) -> Iterator[tuple[Array, Columns]]:
    """Numbers and answers of the missing runs, as their batches finish; all that have, together.

    Raises OSError when no scheduler answers, or when its workers fail.
    """
    solver = solver_named(work.solver)
    first = work.cases(missing[:1])
    compiled_for = Form(work.form.samples, profiles=False)
    solver.solve(first[:0], compiled_for)  # before workers ask for it
    values = solver.values(first, work.form)
    batches = Batches(missing, work.cost, values, engine.batch_seconds)
    with engine.client() as client:
        crew = _Crew(client, work, batches)
        # with results: to wait for one of a worker that is gone would be to wait for ever
        queue = as_completed(crew.more(), loop=client.loop, with_results=True)
        for finished in _finished(queue, crew):
            yield joined([crew.took(future, result) for future, result in finished])
            queue.update(crew.more())


def _finished(queue: as_completed, crew: _Crew) -> Iterator[list[tuple[Task, Result]]]:
    """Tasks as they finish; meanwhile, more of them for workers that have come."""
    while not queue.is_empty():
        pause, longest = _PAUSE
        while not queue.has_ready():
            queue.update(crew.more())
            time.sleep(pause)
            pause = min(1.1 * pause, longest)  # a tenth of what it has waited
        ready = [_next(queue)]
        while queue.has_ready():
            ready.append(_next(queue))
        yield ready


class _Crew:
    """The workers of a client, and what they are at."""

    def __init__(self, client: Client, work: Work, batches: Batches) -> None:
        self._client, self._work, self._batches = client, work, batches
        self._under_way: dict[Any, Array] = {}
        self._threads, self._counted = 1, 0.0

    def more(self) -> list[Task]:
        """New tasks, as many as the workers need to be busy."""
        self._look()
        workers = max(1, self._threads)
        futures = []
        while len(self._under_way) < _AHEAD * workers:
            runs = self._batches.take(workers)
            if not runs.size:
                break
            futures.append(self._submit(runs))
        return futures

    def _look(self) -> None:
        """Count the threads of all workers, now and then; a study without any says so, and waits.

        Workers come and go: on a busy cluster the first one may take hours.
        """
        if time.monotonic() - self._counted < _LOOK_AGAIN:
            return
        before, self._threads = self._threads, _threads(self._client)
        self._counted = time.monotonic()
        if before and not self._threads:
            log.warning("no worker at the dask scheduler: waiting for one. %s", _KEPT)

    def took(self, future: Task, result: Result) -> tuple[Array, Columns]:
        """Numbers and answers of a finished batch."""
        runs, (columns, seconds) = self._under_way.pop(future.key), result
        future.release()
        self._batches.learn(float(self._work.cost[runs].sum()), seconds)
        return runs, columns

    def _submit(self, runs: Array) -> Task:
        work = self._work
        version = solver_named(work.solver).VERSION
        future = self._client.submit(
            solve_batch, work.solver, work.cases(runs), work.form, version, pure=False
        )
        self._under_way[future.key] = runs
        return future


def _threads(client: Client) -> int:
    try:
        return sum(client.nthreads().values())
    except OSError as error:
        raise ConnectionError(_GONE) from error


def _next(queue: as_completed) -> tuple[Task, Result]:
    """A finished task. Raises OSError where its workers, or the scheduler, failed."""
    try:
        future, result = next(queue)
    except KilledWorker as error:
        said = "a batch of runs ended every dask worker that took it (too little memory?)"
        raise OSError(f"{said}: {error} {_KEPT}") from error
    except (CancelledError, CommClosedError) as error:
        raise ConnectionError(_GONE) from error
    except (ImportError, RuntimeError) as error:
        raise OSError(f"a dask worker failed: {error}. {_KEPT}") from error
    if isinstance(result, CancelledError | asyncio.CancelledError):  # returned, not raised
        raise ConnectionError(_GONE) from result
    return future, result
