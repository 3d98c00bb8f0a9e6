"""Finished runs on disk, in shards that are found by content and written by one process at a time.

A run's key is a hash of its case, its output and the version of its solver, so that a changed study
finds the runs that still fit. Small shards are merged while a study is solved: opening thousands
takes long.
"""

from __future__ import annotations

import hashlib
import logging
import os
import re
import socket
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime
from hashlib import blake2b
from itertools import starmap
from pathlib import Path

import numpy as np
import xarray as xr
from filelock import FileLock, Timeout

from impactlab.files import unfinished_files
from impactlab.study import PARTS, SHARDS
from impactlab.study.shard import DAMAGE, KEY, KEYS, LAYOUT, Array, Columns, Shard, write_shard

log = logging.getLogger(__name__)

_MANY = 64  # small shards before they are merged
_SMALL = 8e6
"""Bytes of a shard that is no longer small; small ones of this size together are merged."""
DAMAGED = ".damaged"
"""Suffix of a shard that was set aside."""
_PATIENCE = 1.0  # seconds to wait for a lock, which `holder` takes for a moment


@dataclass(frozen=True)
class OutputSpec:
    """The output kept of each run: samples per history (0: none), and profiles or not.

    strikes: length of the series of strikes. spheres: number of spheres whose answers are kept. (0:
    none, as of runs of one strike and one sphere).
    """

    samples: int
    profiles: bool
    strikes: int = 0
    spheres: int = 0

    @staticmethod
    def of(design: xr.Dataset) -> OutputSpec:
        """Return the output that a design asks for."""
        samples = int(design.attrs["history_samples"]) if design.attrs["histories"] else 0
        counts = (int(design.attrs.get(name, 0)) for name in ("most_strikes", "spheres"))
        return OutputSpec(samples, bool(design.attrs["profiles"]), *counts)


def run_keys(cases: Array, output: OutputSpec, version: str) -> Array:
    """Return one key of 16 bytes per case, shape (cases,); cases are compared by their bytes."""
    solver = hashlib.sha256(f"{version} {output} {cases.dtype.descr}".encode()).digest()
    rows, size = memoryview(cases.tobytes()), cases.dtype.itemsize
    digests = [
        blake2b(rows[start : start + size], digest_size=KEY.itemsize, key=solver).digest()
        for start in range(0, len(rows), size)
    ]
    return np.frombuffer(b"".join(digests), dtype=KEY)


class Shards:
    """The shards of one study with one output, by one solver, in one folder."""

    def __init__(self, folder: Path, output: OutputSpec, version: str) -> None:
        """Look in `folder`/<hash of solver version, output and layout>, made by a first write."""
        form = f"{version} {output} {LAYOUT}"
        self.folder = folder / hashlib.sha256(form.encode()).hexdigest()[:16]
        self._parts = folder.with_name(PARTS) if folder.name == SHARDS else None
        self._small: dict[Path, tuple[Array, Columns]] = {}  # kept in memory until merged

    def files(self) -> list[Path]:
        """Return all shards, and the blocks that parts of the study have solved beside them."""
        blocks = sorted(self._parts.glob("*/*-of-*.npz")) if self._parts else []
        return shard_files(self.folder) + blocks

    def read(self, *names: str) -> Iterator[tuple[Array, Columns]]:
        """Yield keys and answers of every sound shard; the log names damaged ones.

        names: of the columns to read and check; all by default. While another process merges
        shards, runs may come twice, but none is left out.
        """
        seen: set[Path] = set()
        while fresh := [path for path in self.files() if path not in seen]:
            seen.update(fresh)
            for path in fresh:
                if runs := sound_runs(path, *names):
                    yield runs

    def recover(self) -> Iterator[Array]:
        """Yield the keys of every sound shard, and tidy up; only for the process that writes here.

        Every shard is checked whole. A damaged one is renamed, for a person to look at; unfinished
        files are removed. Blocks of parts stay as they are: others may write there.
        """
        for unfinished in unfinished_files(self.folder):
            unfinished.unlink()
        for path in self.files():
            if not (runs := sound_runs(path)):
                if path.parent == self.folder:
                    path.replace(path.with_name(path.name + DAMAGED))
                continue
            if _size(*runs) < _SMALL and path.parent == self.folder:
                self._small[path] = runs
            yield runs[0]

    def write(self, keys: Array, columns: Columns) -> Path:
        """Write runs and return their file, named for their keys.

        columns: by name, one row per key. Raises OSError, for example when the disk is full.
        """
        path = self.folder / f"{hashlib.sha256(keys.tobytes()).hexdigest()[:32]}.npz"
        write_shard(path, keys, columns)
        if _size(keys, columns) < _SMALL:
            self._small[path] = keys, columns
        if len(self._small) >= _MANY or sum(starmap(_size, self._small.values())) >= _SMALL:
            self.merge()
        return path

    def merge(self) -> None:
        """Replace all small shards by one; they are removed when it is on disk."""
        merged, self._small = dict(sorted(self._small.items())), {}
        if len(merged) < 2:
            return
        keys, columns = joined(merged.values())
        _, first = np.unique(keys, return_index=True)
        large = self.write(keys[first], {name: values[first] for name, values in columns.items()})
        for path in merged.keys() - {large}:
            path.unlink()


def shard_files(folder: Path) -> list[Path]:
    """Return what has a shard's name in a folder, sound or not; of nothing else that lies there."""
    return sorted(folder.glob("[0-9a-f]" * 32 + ".npz"))


def _size(keys: Array, columns: Columns) -> int:
    return int(keys.nbytes + sum(values.nbytes for values in columns.values()))


def joined(parts: Iterable[tuple[Array, Columns]]) -> tuple[Array, Columns]:
    """Return keys and columns of several batches or shards as those of one."""
    keys, columns = zip(*parts, strict=True)
    together = {name: np.concatenate([part[name] for part in columns]) for name in columns[0]}
    return np.concatenate(keys), together


def sound_runs(path: Path, *names: str) -> tuple[Array, Columns] | None:
    """Return keys and columns (all by default) of a shard; None where it is damaged or gone."""
    try:
        with closing(Shard(path)) as shard:
            names = (KEYS, *names) if names else shard.names
            columns = {name: shard.read(name) for name in names}
        return columns.pop(KEYS), columns
    except FileNotFoundError:  # merged into another meanwhile
        return None
    except DAMAGE as error:
        log.warning("%s is damaged, and its runs will be solved again (%s)", path, error)
        return None


class RunIndex:
    """The runs of a design by key: which are answered, and which are equal to another.

    size: their number. distinct: the number of those that are equal to none before them. done: a
    mask of the runs that are answered, shape (runs,); of equal ones the first stands for all.
    """

    def __init__(self, keys: Array) -> None:
        """Take the keys of the design's runs, shape (runs,)."""
        self._keys = keys
        self._order = np.argsort(keys, kind="stable")
        ascending = keys[self._order]
        self._repeats = self._order[1:][ascending[1:] == ascending[:-1]]
        self.done = np.zeros(keys.size, dtype=bool)
        self.done[self._repeats] = True
        self._firsts = self.find(keys[self._repeats])[1]
        self.size = int(keys.size)
        self.distinct = self.size - int(self._repeats.size)

    def find(self, keys: Array) -> tuple[Array, Array]:
        """Return a mask of the keys that are in the design, shape (keys,), and their first runs."""
        places = np.searchsorted(self._keys, keys, sorter=self._order)
        runs = self._order[np.minimum(places, self._keys.size - 1)]
        requested: Array = self._keys[runs] == keys
        return requested, runs[requested]

    def spread(self, values: Array) -> Array:
        """Copy the row of the first of equal runs to the others, in place; shape (runs, ...)."""
        values[self._repeats] = values[self._firsts]
        return values


_OWNER = re.compile(r"process \d{1,9} on [\w.-]{1,99}, since [\d:+ -]{19,40}")
"""What `locked` writes beside its lock."""


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Work in `folder` alone, in steps that may lock it again.

    The operating system's lock ends with its process, however that ends, so none is ever stale.
    Raises BlockingIOError naming the process that works there.
    """
    folder.mkdir(parents=True, exist_ok=True)
    lock, owner = FileLock(folder / "lock", is_singleton=True), folder / "owner"
    try:
        lock.acquire(timeout=_PATIENCE)
    except Timeout:
        raise BlockingIOError(
            f"{folder}: {_read(owner)} is at work here: wait until it ends, or end it; "
            "the same command then resumes where it stopped"
        ) from None
    try:
        if lock.lock_counter == 1:
            if owner.exists():
                log.info("%s did not finish: resuming where it stopped", _read(owner))
            now = datetime.now().astimezone().isoformat(" ", "seconds")
            with suppress(OSError):  # a note for people, which a full disk may not take
                owner.write_text(f"process {os.getpid()} on {socket.gethostname()}, since {now}")
        yield
        if lock.lock_counter == 1:
            with suppress(OSError):  # a folder, say
                owner.unlink()
    finally:
        lock.release()


def holder(folder: Path) -> str:
    """Return who works in the folder: process, host and since when; "" when nobody does."""
    if not (folder / "lock").exists():
        return ""
    lock = FileLock(folder / "lock")
    with suppress(Timeout), lock.acquire(timeout=0):
        return ""
    return _read(folder / "owner")


def _read(owner: Path) -> str:
    with suppress(OSError, UnicodeDecodeError):
        if _OWNER.fullmatch(text := owner.read_text() if owner.is_file() else ""):
            return text
    return "another process"
