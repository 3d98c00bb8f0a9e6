"""From a design to its runs: finished batches kept, none solved twice."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.study.engine import Engine
from impactlab.study.fanout import solved
from impactlab.study.lock import held
from impactlab.study.progress import Progress
from impactlab.study.shard import Columns
from impactlab.study.solvers import SOLVERS, solver_of
from impactlab.study.storage import Shards
from impactlab.study.table import Table
from impactlab.study.work import Work

log = logging.getLogger(__name__)
Array = np.ndarray[Any, Any]


def execute(design: xr.Dataset, shards_folder: Path, engine: Engine) -> xr.Dataset:
    """Solve what of the design has not been solved yet, and return all of it as runs.nc holds it.

    design: see impactlab.study.sampling.design. Every finished batch is in `shards_folder`
    before it is counted, so that an interrupted study goes on from there. Held in memory: what is
    returned, and some 40 bytes a run.

    Raises ValueError when the model refuses a run; OSError when the disk is full, when no
    scheduler answers or its workers fail; BlockingIOError when another process is at work in
    `shards_folder`.
    """
    name = solver_of(design)
    solver = SOLVERS[name]
    with held(shards_folder):
        work = Work.of(design)
        shards = Shards(shards_folder, work.form, solver.VERSION)
        table = Table(work.keys, solver.columns(design))
        for keys, columns in shards.recover():
            table.fill(keys, columns)
        missing = table.missing()
        log.info("%d runs, %d of them solved before", work.size, work.size - missing.size)
        for keys, columns in _followed(work, missing, engine):
            shards.write(keys, columns)
            table.fill(keys, columns)
        shards.merge()
        return solver.labelled(design, table.columns())


def _followed(work: Work, missing: Array, engine: Engine) -> Iterator[tuple[Array, Columns]]:
    """Keys and answers of the missing runs as they come in; a bar tells how far they are."""
    if not missing.size:
        return
    bits = SOLVERS[work.solver].failures(work.design)
    with Progress(total=work.size, done=work.size - missing.size) as progress:
        for runs, columns in solved(work, missing, engine):
            yield work.keys[runs], columns
            progress.advance(runs.size, int(np.count_nonzero(columns["status"] & bits)))
