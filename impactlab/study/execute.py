"""From a design to its runs: batches are solved by dask, kept, and none is solved twice."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import dask
import numpy as np
import xarray as xr
from distributed import Client, Future, KilledWorker, as_completed
from distributed.comm.core import CommClosedError

from impactlab.model.own_law import adopt
from impactlab.study.engine import Engine
from impactlab.study.inventory import Work, open_answers
from impactlab.study.progress import items_done
from impactlab.study.shard import Array, Columns
from impactlab.study.solvers import solver_named
from impactlab.study.store import OutputSpec, RunIndex, Shards, joined, locked

log = logging.getLogger(__name__)


@contextmanager
def open_runs(design: xr.Dataset, shards_folder: Path, engine: Engine) -> Iterator[xr.Dataset]:
    """Solve the runs of a design that are not solved yet, and give all of them as a context.

    design: see impactlab.study.design. Every finished batch is in `shards_folder` before
    it is counted: interrupted studies resume where they stopped. Answers are read from there, one
    column at a time, when they are computed: memory holds about 40 bytes per run, and no other
    process works in the folder meanwhile.

    Raises ValueError when the model refuses a run; OSError when the disk is full, when no
    scheduler answers or its workers fail, or when a shard is damaged while it is read;
    BlockingIOError when another process is at work in `shards_folder`.
    """
    with locked(shards_folder):
        work = Work.of(design)
        solver, index = work.solver, RunIndex(work.keys)
        shards = Shards(shards_folder, work.output, solver.version)
        for keys in shards.recover():
            index.done[index.find(keys)[1]] = True
        missing, repeats = np.flatnonzero(~index.done), index.size - index.distinct
        before = index.distinct - missing.size
        equal = f" ({repeats} more are equal to one of them)" if repeats else ""
        log.info("%d runs%s, %d of them solved before", index.distinct, equal, before)
        if missing.size:
            bits = solver.failures(design)
            with items_done(index.distinct, before, "runs") as advance:
                for runs, columns in solved(work, missing, engine):
                    shards.write(work.keys[runs], columns)
                    index.done[runs] = True
                    advance(runs.size, int(np.count_nonzero(columns["status"] & bits)))
        shards.merge()
        names = solver.columns(design)
        # HDF5 is not for two threads
        with (
            open_answers(shards, index, names) as answers,
            dask.config.set(scheduler="synchronous"),
        ):
            yield solver.labelled(design, answers)


def execute(design: xr.Dataset, shards_folder: Path, engine: Engine) -> xr.Dataset:
    """Return all runs of a design in memory; see `open_runs`."""
    with open_runs(design, shards_folder, engine) as runs:
        return runs.load()


Result = tuple[Columns, float]
_AHEAD = 3  # batches per worker under way or waiting: the graph does not grow with the study
_LOOK_AGAIN = 1.0  # seconds between counts of the workers, which come and go
_PAUSE = 0.001, 0.05
"""Seconds between checks for finished batches, first and last: a check takes 0.1 ms."""
_KEPT = "Finished runs are kept: the same command resumes where it stopped."
_GONE = f"the dask scheduler is gone. {_KEPT}"


def solve_batch(
    solver: str,
    cases: Array,
    output: OutputSpec,
    version: str,
    functions: Any = None,
    laws: Any = (),
) -> Result:
    """Return the answers and the seconds that they took: the task that dask runs.

    functions: of the solver, for a worker that may not know them. laws: from outside the
    package, likewise. Raises RuntimeError where the
    solver has another version than the caller's.
    """
    for law in laws:
        adopt(law)
    if functions is not None:
        from impactlab.study.solvers.own import TASKS

        TASKS[solver] = functions
    if version != solver_named(solver).version:
        raise RuntimeError(
            "this dask worker has another version of impactlab: install the same one on all of them"
        )
    start = time.perf_counter()
    columns = solver_named(solver).solve(cases, output)
    return columns, time.perf_counter() - start


def solved(work: Work, missing: Array, engine: Engine) -> Iterator[tuple[Array, Columns]]:
    """Yield numbers and answers of the missing runs, those of all batches that finished together.

    Raises OSError when no scheduler answers, or when its workers fail.
    """
    work.solver.prepare(work.design)
    batches = Batches(missing, work.cost, work.values, engine.batch_seconds)
    with engine.client() as client:
        pool = WorkerPool(client, work, batches)
        # with results: waiting for the result of a lost worker would never end
        queue = as_completed(pool.submit(), loop=client.loop, with_results=True)
        while not queue.is_empty():
            pause, longest = _PAUSE
            while not queue.has_ready():
                queue.update(pool.submit())  # for workers that have come
                time.sleep(pause)
                pause = min(1.1 * pause, longest)  # about a tenth of the time waited so far
            ready = []
            while queue.has_ready():
                ready.append(pool.take(queue))
            yield joined(ready)
            queue.update(pool.submit())


@dataclass
class WorkerPool:
    """The workers of a client, and the batches that they solve.

    under_way: runs by the key of their task. threads: of all workers, as counted last.
    """

    client: Client
    work: Work
    batches: Batches
    under_way: dict[Any, Array] = field(default_factory=dict)
    threads: int = 1
    counted: float = 0.0

    def submit(self) -> list[Future[Result]]:
        """Submit and return new tasks, as many as keep the workers busy.

        Their threads are counted now and then: on a cluster they come and go.
        """
        if time.monotonic() - self.counted >= _LOOK_AGAIN:
            try:
                before, self.threads = self.threads, sum(self.client.nthreads().values())
            except OSError as error:
                raise ConnectionError(_GONE) from error
            self.counted = time.monotonic()
            if before and not self.threads:
                log.warning("no worker at the dask scheduler: waiting for one. %s", _KEPT)
        workers, work, futures = max(1, self.threads), self.work, []
        name, solver = work.name, work.solver
        while len(self.under_way) < _AHEAD * workers:
            runs = self.batches.take(workers)
            if not runs.size:
                break
            cases = solver.cases(work.design, runs)
            task = (
                solve_batch,
                name,
                cases,
                work.output,
                solver.version,
                solver.functions,
                work.laws,
            )
            future = self.client.submit(*task, pure=False)
            self.under_way[future.key] = runs
            futures.append(future)
        return futures

    def take(self, queue: as_completed) -> tuple[Array, Columns]:
        """Return a batch's runs and answers. Raises OSError where workers or scheduler failed."""
        try:
            future, result = next(queue)
        except KilledWorker as error:
            message = "a batch of runs ended every dask worker that took it (too little memory?)"
            raise OSError(f"{message}: {error} {_KEPT}") from error
        except (CancelledError, CommClosedError) as error:
            raise ConnectionError(_GONE) from error
        except (ImportError, RuntimeError) as error:
            raise OSError(f"a dask worker failed: {error}. {_KEPT}") from error
        if isinstance(result, CancelledError | asyncio.CancelledError):  # returned, not raised
            raise ConnectionError(_GONE) from result
        runs, (columns, seconds) = self.under_way.pop(future.key), result
        future.release()
        self.batches.learn(float(self.work.cost[runs].sum()), seconds)
        return runs, columns


_FIRST_SECONDS = 0.1  # duration of the first tasks, which measure the speed
_LEAST_SECONDS = 0.05  # duration of a task near the end
_SHARE = 2
"""A task takes at most 1/_SHARE of a worker's share of the rest: no worker idles at the end."""
_SPEED = 3e8  # cost per second, before it is measured
_MEMORY = 0.8  # weight of all measurements so far beside the next one
_VALUES = 4_000_000  # most stored numbers per task: bounds its memory
_RUNS = 10_000  # most runs per task: its cases travel with it, and take 2 MB


class Batches:
    """Runs cut into batches as they are taken: consecutive runs, after the costly ones.

    A run that is a task of its own comes first, the costliest of all ahead, so that none is left
    to one worker while the others idle.
    """

    def __init__(self, runs: Array, cost: Array, values: int, seconds: float = 1.0) -> None:
        """Take the numbers of the runs, out of those that `cost` holds, in a solver's unit.

        values: stored numbers per run; seconds: of a batch, long beside the overhead of dask and
        the disk.
        """
        alone = np.where(cost[runs] > _SPEED * seconds, cost[runs], 0.0)
        self._runs, self._costs = runs[np.argsort(-alone, kind="stable")], cost
        self._target = seconds
        self._most = max(1, min(_RUNS, _VALUES // values))
        self._at, self._left = 0, float(cost[runs].sum())
        self._cost = self._seconds = 0.0

    def take(self, workers: int) -> Array:
        """Return the numbers of the next runs; empty when all are taken."""
        ahead = self._runs[self._at : self._at + self._most]
        until = np.cumsum(self._costs[ahead])
        speed = self._cost / self._seconds if self._seconds else _SPEED
        target = self._target if self._seconds else min(self._target, _FIRST_SECONDS)
        share = self._left / speed / workers
        seconds = min(target, max(share / _SHARE, _LEAST_SECONDS))
        batch = ahead[: max(1, int(np.searchsorted(until, speed * seconds, side="right")))]
        self._at += batch.size
        self._left -= float(self._costs[batch].sum())
        return batch

    def learn(self, cost: float, seconds: float) -> None:
        """Size further batches by the duration of one."""
        self._cost = _MEMORY * self._cost + cost
        self._seconds = _MEMORY * self._seconds + seconds
