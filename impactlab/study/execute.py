"""From a design to its runs: batches are solved by dask, kept, and none is solved twice."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import dask
import numpy as np
import xarray as xr
from distributed import Client, Future, KilledWorker, as_completed
from distributed.comm.core import CommClosedError

from impactlab.study.engine import Engine
from impactlab.study.netcdf import Columns
from impactlab.study.progress import Progress
from impactlab.study.runs import Answers, Work
from impactlab.study.solvers import solver_named, solver_of
from impactlab.study.store import Form, Ledger, Shards, held, joined

log = logging.getLogger(__name__)
Array = np.ndarray[Any, Any]


@contextmanager
def executed(design: xr.Dataset, shards_folder: Path, engine: Engine) -> Iterator[xr.Dataset]:
    """Solve what of the design has not been solved yet; within, all of it as runs.nc holds it.

    design: see impactlab.study.sampling.design. Every finished batch is in `shards_folder`
    before it is counted, so that an interrupted study goes on from there. Answers are read from
    there, too, when they are computed, a column at a time: held in memory are some 40 bytes a run,
    and no other process works in the folder meanwhile.

    Raises ValueError when the model refuses a run; OSError when the disk is full, when no
    scheduler answers or its workers fail, or when a shard is damaged while it is read;
    BlockingIOError when another process is at work in `shards_folder`.
    """
    name = solver_of(design)
    solver = solver_named(name)
    with held(shards_folder):
        work = Work.of(design)
        shards, ledger = Shards(shards_folder, work.form, solver.VERSION), Ledger(work.keys)
        for keys in shards.recover():
            ledger.mark(ledger.find(keys)[1])
        log.info("%s", _found(ledger))
        for runs, columns in _followed(work, ledger, engine):
            shards.write(work.keys[runs], columns)
            ledger.mark(runs)
        shards.merge()
        # HDF5 is not for two threads
        with Answers(shards, ledger) as answers, dask.config.set(scheduler="synchronous"):
            yield solver.labelled(design, answers.columns(solver.columns(design)))


def execute(design: xr.Dataset, shards_folder: Path, engine: Engine) -> xr.Dataset:
    """As `executed`, all of it in memory."""
    with executed(design, shards_folder, engine) as runs:
        return runs.load()


def _found(ledger: Ledger) -> str:
    """What there is to do."""
    before = ledger.distinct - ledger.missing().size
    repeats = ledger.size - ledger.distinct
    runs = f"{ledger.distinct} runs" + f" ({repeats} more are equal to one of them)" * bool(repeats)
    return f"{runs}, {before} of them solved before"


def _followed(work: Work, ledger: Ledger, engine: Engine) -> Iterator[tuple[Array, Columns]]:
    """Numbers and answers of the missing runs as they come in; a bar tells how far they are."""
    missing, total = ledger.missing(), ledger.distinct
    if not missing.size:
        return
    bits = solver_named(work.solver).failures(work.design)
    with Progress(total=total, done=total - missing.size) as progress:
        for runs, columns in solved(work, missing, engine):
            yield runs, columns
            progress.advance(runs.size, int(np.count_nonzero(columns["status"] & bits)))


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
