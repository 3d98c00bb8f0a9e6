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

from impactlab.study.netcdf import DAMAGE, KEYS, Array, Shard
from impactlab.study.solvers import SOLVERS, run_count, solver_named, solver_of
from impactlab.study.store import DAMAGED, OutputSpec, RunIndex, Shards, holder, run_keys

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

    def cases(self, runs: Array) -> Array:
        """Return the cases of these runs, by number."""
        return solver_named(self.solver).cases(self.design, runs)

    def shards(self, folder: Path) -> Shards:
        """Return the shards in which answers of these runs may be."""
        return Shards(folder, self.output, solver_named(self.solver).version)


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
        found = np.zeros(index.size, dtype=bool)
        for path in shards.files():
            requested, runs = index.find(self._read(path, KEYS))
            if runs.size:
                self._parts.append((path, np.flatnonzero(requested), runs))
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
        columns = {}
        for name, (shape, kind) in layouts.items():
            whole = (self._index.size, *shape)
            values = delayed(self._values)(name, whole, kind)
            columns[name] = da.from_delayed(values, whole, kind)  # type: ignore[no-untyped-call]
        return columns

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
    shards, index = work.shards(shards_folder), RunIndex(work.keys)
    bits = np.zeros(index.size, dtype=np.int32)
    for keys, columns in shards.read("status"):
        requested, runs = index.find(keys)
        index.mark(runs)
        bits[runs] = columns["status"][requested]
    failures = solver_named(work.solver).failures(design)
    times = [each.st_mtime for each in _seen(shards.files())]
    return Status(
        runs=index.size,
        done=index.size - index.left(),
        failed=int(np.count_nonzero(index.spread(bits) & failures)),
        age=time.time() - max(times) if times else None,
        size=disk_size(shards_folder.rglob("*")),
        holder=holder(shards_folder),
    )


def disk_size(paths: Iterable[Path]) -> int:
    """Return the bytes of these files; one that disappeared counts nothing."""
    return sum(each.st_size for each in _seen(paths) if S_ISREG(each.st_mode))


def _seen(paths: Iterable[Path]) -> Iterator[os.stat_result]:
    for path in paths:
        with suppress(FileNotFoundError):
            yield path.stat()


_STUDY = "study"
"""File beside the folders of shards that names the study file."""


def note_study(shards_folder: Path, file: Path) -> None:
    """Note beside the shards which study file they belong to."""
    shards_folder.mkdir(parents=True, exist_ok=True)
    with suppress(OSError):  # a full disk is reported where more of it is needed
        (shards_folder / _STUDY).write_text(f"{file.resolve()}\n")


def noted_study(shards_folder: Path) -> Path | None:
    """Return the study file that note_study noted, if it still exists."""
    with suppress(OSError, ValueError):
        file = Path((shards_folder / _STUDY).read_text().strip())
        return file if file.is_file() else None
    return None


def stale(shards_folder: Path, designs: Collection[xr.Dataset]) -> dict[Path, str]:
    """Return the files of a study's folder of shards that may be removed, and the reasons.

    designs: all that the study may need; none where it does not exist any more. A shard stays as
    long as one of its runs is needed, or it cannot be read.
    """
    wanted: dict[Path, list[Array]] = {}
    for design in designs:
        work = Work.of(design)
        wanted.setdefault(work.shards(shards_folder).folder, []).append(work.keys)
    found = _removable(shards_folder, wanted)
    return found if designs else dict.fromkeys(found, "its study does not exist")


def outdated(folder: Path) -> dict[Path, str]:
    """Return removable files and reasons as `stale` does, of pilot runs and refinements.

    All are kept but those of another solver: only a search tells which would be needed again.
    """
    versions = [solver_named(name).version for name in SOLVERS]
    current = [Shards(folder, OutputSpec(0, False), version).folder for version in versions]
    return _removable(folder, dict.fromkeys(current))


def _removable(
    shards_folder: Path, wanted: Mapping[Path, Sequence[Array] | None]
) -> dict[Path, str]:
    """Return removable files and reasons; wanted: keys needed in each folder, None: all of them."""
    found = {}
    for path in sorted(path for path in shards_folder.glob("*/*") if path.is_file()):
        if path.name.startswith("."):
            found[path] = "is unfinished"
        elif path.name.endswith(DAMAGED):
            found[path] = "was damaged and set aside"
        elif path.parent not in wanted:
            found[path] = "belongs to another version of the solver, or another output"
        elif (needed := wanted[path.parent]) is not None:
            keys = Shards.keys(path)
            if keys.size and not any(np.isin(keys, each).any() for each in needed):
                found[path] = "holds no run of the study"
    return found
