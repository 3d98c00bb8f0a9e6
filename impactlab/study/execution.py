"""From a design to its runs: finished batches kept, none solved twice."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import dask
import numpy as np
import xarray as xr

from impactlab.study.answers import Answers
from impactlab.study.engine import Engine
from impactlab.study.fanout import solved
from impactlab.study.ledger import Ledger
from impactlab.study.lock import held
from impactlab.study.progress import Progress
from impactlab.study.shard import Columns
from impactlab.study.solvers import solver_named, solver_of
from impactlab.study.storage import Shards
from impactlab.study.work import Work

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
