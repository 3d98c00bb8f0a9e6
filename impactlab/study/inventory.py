"""The runs of a design: what there is to solve, what the store holds, and what may be removed."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass
from functools import lru_cache, partial
from pathlib import Path
from stat import S_ISREG
from typing import Any

import dask.array as da
import numpy as np
import xarray as xr
from dask.delayed import delayed

from impactlab.files import block_rows, unfinished_files
from impactlab.model.parameters import LAW_PARAMETERS
from impactlab.study.shard import DAMAGE, KEYS, Array, Shard
from impactlab.study.solvers import SOLVERS, Solver, run_shape, solver_named
from impactlab.study.store import (
    DAMAGED,
    OutputSpec,
    RunIndex,
    Shards,
    holder,
    run_keys,
    shard_files,
    sound_runs,
)

BOUND_IT = "use a bounded distribution, such as truncated_normal, or narrower bounds"
"""What to do about an impossible draw."""
_CHUNK = 10_000  # runs whose cases are in memory together: a table of all would fill it


@dataclass(frozen=True)
class Work:
    """The runs of a design: the key of each, shape (runs,), and its cost in the solver's unit.

    name: of the solver; without the attribute, a design is one of impacts. values: numbers
    kept of each run.
    """

    design: xr.Dataset
    name: str
    solver: Solver
    output: OutputSpec
    keys: Array
    cost: Array
    values: int

    @property
    def laws(self) -> list[Any]:
        """Laws from outside the package, which workers may not know."""
        return [
            law
            for parameter, names in LAW_PARAMETERS.items()
            if parameter in self.design.variables
            for law in names.outside(np.unique(self.design[parameter].values))
        ]

    @staticmethod
    def of(design: xr.Dataset) -> Work:
        """Check every run. Raises ValueError naming one that the model refuses."""
        name, output = str(design.attrs.get("solver", "impact")), OutputSpec.of(design)
        solver = solver_named(name)
        keys, cost, runs = [], [], np.arange(math.prod(run_shape(design)[1]))
        for start in range(0, runs.size, _CHUNK):
            cases = checked_cases(design, solver, runs[start : start + _CHUNK])
            keys.append(run_keys(cases, output, solver.version))
            cost.append(solver.cost(cases))
        columns = np.concatenate(keys), np.concatenate(cost)
        return Work(design, name, solver, output, *columns, solver.values(cases, output))


def checked_cases(design: xr.Dataset, solver: Solver, runs: Array) -> Array:
    """Return the solver's cases of these runs. Raises ValueError naming one that it refuses."""
    try:
        return solver.cases(design, runs)
    except ValueError as error:
        advice = f": {BOUND_IT}" if "run" in design.dims else ""  # drawn
        raise ValueError(f"{error}{advice}") from None


_OPEN = 100  # shards that stay open: opening one takes longer than reading a column
_AGAIN = "run the same command again: what is lost is solved again"


@contextmanager
def open_answers(
    shards: Shards, index: RunIndex, names: Sequence[str]
) -> Iterator[dict[str, da.Array]]:
    """Give the answers of a design by name as a context, each of shape (runs, ...).

    Each is read when it is computed: one number per run as one block, histories and profiles in
    blocks of runs. Raises OSError where a run has no answer, or a shard is damaged.
    """
    paths = shards.files()
    shard_of, row_of = np.full(index.size, -1), np.zeros(index.size, dtype=int)
    pool: dict[Path, Shard] = {}
    with ExitStack() as stack:
        opened = partial(_open_shard, open_shards=pool, stack=stack)
        for position, path in enumerate(paths):
            with opened(path) as shard:
                requested, runs = index.find(shard.read(KEYS))
            shard_of[runs], row_of[runs] = position, np.flatnonzero(requested)
        if (index.spread(shard_of) < 0).any():
            raise OSError(f"{shards.folder}: shards disappeared while they were read: {_AGAIN}")
        index.spread(row_of)

        @lru_cache(maxsize=1)  # the same for each column
        def places(start: int, stop: int) -> list[Array]:
            """Return the runs of a block in each shard that has some, counted from `start`."""
            order = np.argsort(shard_of[start:stop], kind="stable")
            cuts = np.flatnonzero(np.diff(shard_of[start:stop][order])) + 1
            return np.split(order, cuts)

        def read(name: str, start: int, shape: tuple[int, ...], kind: np.dtype[Any]) -> Array:
            values = np.empty(shape, kind)
            for runs in places(start, start + len(values)):
                with opened(paths[shard_of[start + runs[0]]]) as shard:
                    values[runs] = shard.read(name)[row_of[start + runs]]
            return values

        columns = {}
        with opened(paths[shard_of[0]]) as shard:
            for name in names:
                column, parts = shard.read(name), []
                row, kind = column.shape[1:], column.dtype
                size = block_rows(row) if row else index.size
                for start in range(0, index.size, size):
                    shape = (min(size, index.size - start), *row)
                    part = delayed(read)(name, start, shape, kind)
                    parts.append(da.from_delayed(part, shape, kind))  # type: ignore[no-untyped-call]
                columns[name] = da.concatenate(parts)  # type: ignore[no-untyped-call]
        yield columns


@contextmanager
def _open_shard(path: Path, open_shards: dict[Path, Shard], stack: ExitStack) -> Iterator[Shard]:
    """Open a shard, or take one that is kept open. Raises OSError where it is damaged."""
    try:
        if path not in open_shards and len(open_shards) < _OPEN:
            open_shards[path] = stack.enter_context(closing(Shard(path)))
        if path in open_shards:
            yield open_shards[path]
        else:
            with closing(Shard(path)) as shard:
                yield shard
    except DAMAGE as error:
        raise OSError(f"{path} was damaged after it was written ({error}): {_AGAIN}") from error


@dataclass(frozen=True)
class Status:
    """The progress of a study (`il.Study.status`).

    Attributes
    ----------
    runs : int
        Number of all runs.
    done : int
        Number of runs on disk.
    failed : int
        Number of these that lack a requested response.
    age : float or None
        Time since the latest file of runs was written, in s; None without one.
    size : int
        Size of all files of runs, in bytes, also of other solvers and outputs.
    holder : str
        Process that works on the study now, or "".
    written : str
        Content of runs.nc.
    """

    runs: int
    done: int
    failed: int
    age: float | None
    size: int
    holder: str
    written: str = ""


def status(design: xr.Dataset, shards_folder: Path) -> Status:
    """Return the status of a design; shards are only read, also while another process writes."""
    work = Work.of(design)
    shards = Shards(shards_folder, work.output, work.solver.version)
    index = RunIndex(work.keys)
    bits = np.zeros(index.size, dtype=np.int32)
    for keys, columns in shards.read("status"):
        requested, runs = index.find(keys)
        index.done[runs] = True
        bits[runs] = columns["status"][requested]
    failures = work.solver.failures(design)
    times = [stat.st_mtime for stat in file_stats(shards.files())]
    return Status(
        runs=index.size,
        done=int(np.count_nonzero(index.spread(index.done))),
        failed=int(np.count_nonzero(index.spread(bits) & failures)),
        age=time.time() - max(times) if times else None,
        size=sum(stat.st_size for stat in file_stats(shards_folder.rglob("*"))),
        holder=holder(shards_folder),
    )


def file_stats(paths: Iterable[Path]) -> Iterator[os.stat_result]:
    """Yield what the system says of the files among these paths; not of one that disappeared."""
    for path in paths:
        with suppress(FileNotFoundError):
            stat = path.stat()
            if S_ISREG(stat.st_mode):
                yield stat


def removable_files(folder: Path, designs: Collection[xr.Dataset] | None) -> dict[Path, str]:
    """Return the files among a study's shards that may be removed, and the reasons.

    designs: all that the study may need; None of pilot runs and refinements, which are all kept but
    those of another solver: only a search tells which would be needed again. A shard stays as long
    as one of its runs is needed, or it cannot be read.
    """
    needed: dict[Path, list[Array]] = {}
    for name in SOLVERS if designs is None else ():
        needed[Shards(folder, OutputSpec(0, False), solver_named(name).version).folder] = []
    for design in designs or ():
        work = Work.of(design)
        shards = Shards(folder, work.output, work.solver.version)
        needed.setdefault(shards.folder, []).append(work.keys)
    reasons: dict[Path, str] = {}
    for place in folder.glob("*/"):
        reasons |= dict.fromkeys(unfinished_files(place), "is unfinished")
        reasons |= dict.fromkeys(place.glob(f"*{DAMAGED}"), "was damaged and set aside")
        if place not in needed:
            reason = "belongs to another version of the solver, or another output"
            reasons |= dict.fromkeys(place.glob("[0-9a-f]" * 32 + ".n*"), reason)  # once .nc
        for path in shard_files(place) if designs and place in needed else ():
            sound = sound_runs(path)
            if sound and not any(np.isin(sound[0], keys).any() for keys in needed[place]):
                reasons[path] = "holds no run of the study"
    return {path: why for path, why in sorted(reasons.items()) if path.is_file()}
