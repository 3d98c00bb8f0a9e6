"""The runs of a design: what there is to solve, what the store holds, and what may be removed."""

from __future__ import annotations

import os
import time
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from stat import S_ISREG
from typing import Any

import dask.array as da
import numpy as np
import xarray as xr
from dask.delayed import delayed

from impactlab.study.design import run_count
from impactlab.study.netcdf import DAMAGE, KEYS, Shard
from impactlab.study.solvers import SOLVERS, solver_named, solver_of
from impactlab.study.store import DAMAGED, Form, Ledger, Shards, holder, run_keys

Array = np.ndarray[Any, Any]
_CHUNK = 10_000
"""Runs whose cases are in memory together."""


@dataclass(frozen=True)
class Work:
    """The runs of a design: the key of each, shape (runs,), and its cost in the solver's unit."""

    design: xr.Dataset
    solver: str
    form: Form
    keys: Array
    cost: Array

    @staticmethod
    def of(design: xr.Dataset) -> Work:
        """Every run is checked. Raises ValueError naming one that the model refuses."""
        name, form = solver_of(design), Form.of(design)
        solver = solver_named(name)
        keys, cost = [], []
        for start in range(0, run_count(design), _CHUNK):
            stop = min(start + _CHUNK, run_count(design))
            cases = solver.cases(design, np.arange(start, stop))
            keys.append(run_keys(cases, form, solver.VERSION))
            cost.append(solver.cost(cases))
        return Work(design, name, form, np.concatenate(keys), np.concatenate(cost))

    @property
    def size(self) -> int:
        """The number of runs."""
        return int(self.keys.size)

    def cases(self, runs: Array) -> Array:
        """The cases of these runs, by number."""
        return solver_named(self.solver).cases(self.design, runs)


_OPEN = 100
"""Shards that stay open: to open one takes longer than to read a column of it."""


class Answers:
    """All answers of a design, a column at a time in memory. To be closed in the end."""

    def __init__(self, shards: Shards, ledger: Ledger) -> None:
        """Look up where each run's answers lie. Raises OSError where a run has none."""
        self._ledger = ledger
        self._open: dict[Path, Shard] = {}
        self._parts: list[tuple[Path, Array, Array]] = []
        self._closing = ExitStack()
        for path in shards.files():
            asked, runs = ledger.find(self._read(path, KEYS))
            if runs.size:
                self._parts.append((path, np.flatnonzero(asked), runs))
        found = np.zeros(ledger.size, dtype=bool)
        for _, _, runs in self._parts:
            found[runs] = True
        if not ledger.spread(found).all():
            raise OSError(f"{shards.folder}: shards went while they were read: {_AGAIN}")

    def __enter__(self) -> Answers:
        return self

    def __exit__(self, *_: object) -> None:
        self._closing.close()

    def columns(self, names: Sequence[str]) -> dict[str, da.Array]:
        """Answers by name, each of shape (runs, ...), in one block that is read when computed."""
        with self._shard(self._parts[0][0]) as shard:
            layouts = {name: shard.layout(name) for name in names}
        return {name: self._column(name, *layout) for name, layout in layouts.items()}

    def _column(self, name: str, shape: tuple[int, ...], kind: np.dtype[Any]) -> da.Array:
        whole = (self._ledger.size, *shape)
        values = delayed(self._values)(name, whole, kind)
        column: da.Array = da.from_delayed(values, whole, kind)  # type: ignore[no-untyped-call]
        return column

    def _values(self, name: str, shape: tuple[int, ...], kind: np.dtype[Any]) -> Array:
        values = np.empty(shape, kind)
        for path, rows, runs in self._parts:
            values[runs] = self._read(path, name)[rows]
        return self._ledger.spread(values)

    def _read(self, path: Path, name: str) -> Array:
        with self._shard(path) as shard:
            return shard.read(name)

    @contextmanager
    def _shard(self, path: Path) -> Iterator[Shard]:
        """Raises OSError where the shard is not what was written."""
        try:
            if path in self._open:
                yield self._open[path]
            elif len(self._open) < _OPEN:
                self._open[path] = self._closing.enter_context(Shard(path))
                yield self._open[path]
            else:
                with Shard(path) as shard:
                    yield shard
        except DAMAGE as error:
            raise OSError(f"{path} was damaged after it was written ({error}): {_AGAIN}") from error


_AGAIN = "run the same command again: what is lost is solved again"


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


_STUDY = "study"
"""Beside the folders of shards: where the file lies that asks for them."""
NO_STUDY = "its study is gone"
SET_ASIDE = "was damaged and set aside"
UNFINISHED = "was not written to its end"
OTHER_RUNS = "no run in it is asked for"
OTHER_SOLVER = "of another version of the solver, or in another form"


def stale(shards_folder: Path, designs: Collection[xr.Dataset]) -> dict[Path, str]:
    """What can go in a study's folder of shards, and why; nothing is removed.

    designs: all that the study may ask for; none where it is gone. A shard stays as long as one of
    its runs is asked for, or it cannot be read.
    """
    wanted: dict[Path, list[Array]] = {}
    for design in designs:
        work = Work.of(design)
        folder = Shards(shards_folder, work.form, solver_named(work.solver).VERSION).folder
        wanted.setdefault(folder, []).append(work.keys)
    found = {}
    for path in _beside(shards_folder):
        if reason := _reason(path, wanted):
            found[path] = reason if designs else NO_STUDY
    return found


def note_study(shards_folder: Path, file: Path) -> None:
    """Leave word of where the study lies that asks for what is in a folder."""
    shards_folder.mkdir(parents=True, exist_ok=True)
    with suppress(OSError):  # a full disk is told by what needs more of it
        (shards_folder / _STUDY).write_text(f"{file.resolve()}\n")


def noted_study(shards_folder: Path) -> Path | None:
    """The file that note_study told of, where there is one still."""
    note = shards_folder / _STUDY
    with suppress(OSError, ValueError):
        file = Path(note.read_text().strip())
        return file if file.is_file() else None
    return None


def outdated(folder: Path) -> dict[Path, str]:
    """As stale, of runs beside a study's own, all responses kept: those of another solver.

    Which of the others would be asked for again, only a search tells.
    """
    versions = [solver_named(name).VERSION for name in SOLVERS]
    current = {Shards(folder, Form(0, False), version).folder for version in versions}
    reasons = {path: _beyond_asking(path, current) for path in _beside(folder)}
    return {path: reason for path, reason in reasons.items() if reason}


def _beside(shards_folder: Path) -> Iterable[Path]:
    return sorted(path for path in shards_folder.glob("*/*") if path.is_file())


def _reason(path: Path, wanted: Mapping[Path, list[Array]]) -> str:
    """Why a file can go; "" where it has to stay."""
    if reason := _beyond_asking(path, wanted):
        return reason
    keys = Shards.keys(path)
    asked = any(np.isin(keys, each).any() for each in wanted[path.parent])
    return OTHER_RUNS if keys.size and not asked else ""


def _beyond_asking(path: Path, current: Collection[Path]) -> str:
    """Why no study can ask for what is in a file; current: folders of the solvers of today."""
    if path.name.startswith("."):
        return UNFINISHED
    if path.name.endswith(DAMAGED):
        return SET_ASIDE
    return "" if path.parent in current else OTHER_SOLVER
