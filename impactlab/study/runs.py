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
from impactlab.study.store import DAMAGED, OutputSpec, RunIndex, Shards, holder, run_keys

Array = np.ndarray[Any, Any]
_CHUNK = 10_000
"""Runs whose cases are in memory together."""


@dataclass(frozen=True)
class Work:
    """The runs of a design: the key of each, shape (runs,), and its cost in the solver's unit.

    Cases are made as they are needed: a table of all would fill the memory.
    """

    design: xr.Dataset
    solver: str
    output: OutputSpec
    keys: Array
    cost: Array

    @staticmethod
    def of(design: xr.Dataset) -> Work:
        """Check every run. Raises ValueError naming one that the model refuses."""
        name, output = solver_of(design), OutputSpec.of(design)
        solver = solver_named(name)
        keys, cost = [], []
        for start in range(0, run_count(design), _CHUNK):
            stop = min(start + _CHUNK, run_count(design))
            cases = solver.cases(design, np.arange(start, stop))
            keys.append(run_keys(cases, output, solver.version))
            cost.append(solver.cost(cases))
        return Work(design, name, output, np.concatenate(keys), np.concatenate(cost))

    @property
    def size(self) -> int:
        """Return the number of runs."""
        return int(self.keys.size)

    def cases(self, runs: Array) -> Array:
        """Return the cases of these runs, by number."""
        return solver_named(self.solver).cases(self.design, runs)


_OPEN = 100
"""Shards that stay open: opening one takes longer than reading a column."""
_AGAIN = "run the same command again: what is lost is solved again"


class Answers:
    """All answers of a design, as a context; one column at a time is in memory."""

    def __init__(self, shards: Shards, index: RunIndex) -> None:
        """Find the answers of each run. Raises OSError where a run has none."""
        self._index = index
        self._open: dict[Path, Shard] = {}
        self._parts: list[tuple[Path, Array, Array]] = []
        self._closing = ExitStack()
        for path in shards.files():
            requested, runs = index.find(self._read(path, KEYS))
            if runs.size:
                self._parts.append((path, np.flatnonzero(requested), runs))
        found = np.zeros(index.size, dtype=bool)
        for _, _, runs in self._parts:
            found[runs] = True
        if not index.spread(found).all():
            raise OSError(f"{shards.folder}: shards disappeared while they were read: {_AGAIN}")

    def __enter__(self) -> Answers:
        return self

    def __exit__(self, *_: object) -> None:
        self._closing.close()

    def columns(self, names: Sequence[str]) -> dict[str, da.Array]:
        """Return answers by name, each of shape (runs, ...), in one block read when computed."""
        with self._shard(self._parts[0][0]) as shard:
            layouts = {name: shard.layout(name) for name in names}
        return {name: self._column(name, *layout) for name, layout in layouts.items()}

    def _column(self, name: str, shape: tuple[int, ...], kind: np.dtype[Any]) -> da.Array:
        whole = (self._index.size, *shape)
        values = delayed(self._values)(name, whole, kind)
        column: da.Array = da.from_delayed(values, whole, kind)  # type: ignore[no-untyped-call]
        return column

    def _values(self, name: str, shape: tuple[int, ...], kind: np.dtype[Any]) -> Array:
        values = np.empty(shape, kind)
        for path, rows, runs in self._parts:
            values[runs] = self._read(path, name)[rows]
        return self._index.spread(values)

    def _read(self, path: Path, name: str) -> Array:
        with self._shard(path) as shard:
            return shard.read(name)

    @contextmanager
    def _shard(self, path: Path) -> Iterator[Shard]:
        """Open a shard, or take an open one. Raises OSError where it is damaged."""
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


@dataclass(frozen=True)
class Status:
    """The progress of a study: all runs, those on disk, and those that lack a requested response.

    age: of the latest shard in s, None without one; size: of all shards in bytes, also of other
    solvers and outputs; holder: who works on it now, or "".
    """

    runs: int
    done: int
    failed: int
    age: float | None
    size: int
    holder: str


def status(design: xr.Dataset, shards_folder: Path) -> Status:
    """Return the status of a design; shards are only read, also while another process writes."""
    work = Work.of(design)
    solver = solver_named(work.solver)
    shards = Shards(shards_folder, work.output, solver.version)
    index, bits = RunIndex(work.keys), np.zeros(work.size, dtype=np.int32)
    for keys, columns in shards.read("status"):
        requested, runs = index.find(keys)
        index.mark(runs)
        bits[runs] = columns["status"][requested]
    return Status(
        runs=work.size,
        done=work.size - index.left(),
        failed=int(np.count_nonzero(index.spread(bits) & solver.failures(design))),
        age=_age(shards.files()),
        size=disk_size(shards_folder.rglob("*")),
        holder=holder(shards_folder),
    )


def disk_size(paths: Iterable[Path]) -> int:
    """Return the bytes of these files; one that disappeared counts nothing."""
    return sum(each.st_size for each in _seen(paths) if S_ISREG(each.st_mode))


def _age(files: Iterable[Path]) -> float | None:
    times = [each.st_mtime for each in _seen(files)]
    return time.time() - max(times) if times else None


def _seen(paths: Iterable[Path]) -> Iterator[os.stat_result]:
    for path in paths:
        with suppress(FileNotFoundError):
            yield path.stat()


_STUDY = "study"
"""File beside the folders of shards that names the study file."""
NO_STUDY = "its study does not exist"
SET_ASIDE = "was damaged and set aside"
UNFINISHED = "is unfinished"
OTHER_RUNS = "holds no run of the study"
OTHER_SOLVER = "belongs to another version of the solver, or another output"


def stale(shards_folder: Path, designs: Collection[xr.Dataset]) -> dict[Path, str]:
    """Return the files of a study's folder of shards that may be removed, and the reasons.

    designs: all that the study may need; none where it does not exist any more. A shard stays as
    long as one of its runs is needed, or it cannot be read.
    """
    wanted: dict[Path, list[Array]] = {}
    for design in designs:
        work = Work.of(design)
        folder = Shards(shards_folder, work.output, solver_named(work.solver).version).folder
        wanted.setdefault(folder, []).append(work.keys)
    found = {}
    for path in _beside(shards_folder):
        if reason := _reason(path, wanted):
            found[path] = reason if designs else NO_STUDY
    return found


def note_study(shards_folder: Path, file: Path) -> None:
    """Note beside the shards which study file they belong to."""
    shards_folder.mkdir(parents=True, exist_ok=True)
    with suppress(OSError):  # a full disk is reported where more of it is needed
        (shards_folder / _STUDY).write_text(f"{file.resolve()}\n")


def noted_study(shards_folder: Path) -> Path | None:
    """Return the study file that note_study noted, if it still exists."""
    note = shards_folder / _STUDY
    with suppress(OSError, ValueError):
        file = Path(note.read_text().strip())
        return file if file.is_file() else None
    return None


def outdated(folder: Path) -> dict[Path, str]:
    """Return removable files and reasons as `stale` does, of pilot runs and refinements.

    All are kept but those of another solver: only a search tells which would be needed again.
    """
    versions = [solver_named(name).version for name in SOLVERS]
    current = {Shards(folder, OutputSpec(0, False), version).folder for version in versions}
    reasons = {path: _unusable(path, current) for path in _beside(folder)}
    return {path: reason for path, reason in reasons.items() if reason}


def _beside(shards_folder: Path) -> Iterable[Path]:
    return sorted(path for path in shards_folder.glob("*/*") if path.is_file())


def _reason(path: Path, wanted: Mapping[Path, list[Array]]) -> str:
    """Return why a file may be removed; "" where it has to stay."""
    if reason := _unusable(path, wanted):
        return reason
    keys = Shards.keys(path)
    needed = any(np.isin(keys, each).any() for each in wanted[path.parent])
    return OTHER_RUNS if keys.size and not needed else ""


def _unusable(path: Path, current: Collection[Path]) -> str:
    """Return why no study can use a file, or ""; current: folders of the present solvers."""
    if path.name.startswith("."):
        return UNFINISHED
    if path.name.endswith(DAMAGED):
        return SET_ASIDE
    return "" if path.parent in current else OTHER_SOLVER
