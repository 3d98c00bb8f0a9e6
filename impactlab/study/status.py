"""How far a study is, from what lies on disk."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from stat import S_ISREG

import numpy as np
import xarray as xr

from impactlab.study.ledger import Ledger
from impactlab.study.lock import holder
from impactlab.study.solvers import solver_named
from impactlab.study.storage import Shards
from impactlab.study.work import Work


@dataclass(frozen=True)
class Status:
    """Runs in all, and on disk; of these, how many lack a response that is asked for.

    age: of the latest shard in s, None without one; size: of all shards in bytes, those of other
    solvers and forms included; holder: who works on it now, or "".
    """

    runs: int
    done: int
    failed: int
    age: float | None
    size: int
    holder: str


def status(design: xr.Dataset, shards_folder: Path) -> Status:
    """The status of a design; shards are only read, also while another process writes them."""
    work = Work.of(design)
    solver = solver_named(work.solver)
    shards = Shards(shards_folder, work.form, solver.VERSION)
    ledger, bits = Ledger(work.keys), np.zeros(work.size, dtype=np.int32)
    for keys, columns in shards.read("status"):
        asked, runs = ledger.find(keys)
        ledger.mark(runs)
        bits[runs] = columns["status"][asked]
    return Status(
        runs=work.size,
        done=work.size - ledger.left(),
        failed=int(np.count_nonzero(ledger.spread(bits) & solver.failures(design))),
        age=_age(shards.files()),
        size=disk_size(shards_folder.rglob("*")),
        holder=holder(shards_folder),
    )


def disk_size(paths: Iterable[Path]) -> int:
    """Bytes of these files; one that has gone in between counts nothing."""
    return sum(each.st_size for each in _seen(paths) if S_ISREG(each.st_mode))


def _age(files: Iterable[Path]) -> float | None:
    times = [each.st_mtime for each in _seen(files)]
    return time.time() - max(times) if times else None


def _seen(paths: Iterable[Path]) -> Iterator[os.stat_result]:
    for path in paths:
        with suppress(FileNotFoundError):
            yield path.stat()
