"""Finished runs on disk: found again by content, never lost, never taken for another's.

A run's key is a hash of its case, its form and the version of its solver, so that a changed study
finds what still fits. Small shards are merged while a study is solved: thousands are slow to open.
"""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.study.shard import DAMAGE, KEY, KEYS, LAYOUT, Columns, Shard, write_shard

log = logging.getLogger(__name__)
Array = np.ndarray[Any, Any]

_MANY = 64
"""Small shards at most: then they are merged."""
_SMALL = 8e6
"""Bytes from which a shard stays as it is; the small ones together are not more for long."""
DAMAGED = ".damaged"
"""Ends the name of a shard that was set aside."""


@dataclass(frozen=True)
class Form:
    """What is kept of each run: samples a history (0: none), and whether profiles."""

    samples: int
    profiles: bool

    @staticmethod
    def of(design: xr.Dataset) -> Form:
        """What a design asks for."""
        samples = int(design.attrs["history_samples"]) if design.attrs["histories"] else 0
        return Form(samples, bool(design.attrs["profiles"]))


def run_keys(cases: Array, form: Form, version: str) -> Array:
    """One key a case, shape (cases,), 16 bytes: equal keys, equal answers. version: of the solver.

    In memory, bytes that follow each other are one case: two equal cases have equal bytes.
    """
    given = hashlib.sha256(f"{version} {form} {cases.dtype.descr}".encode()).digest()
    rows, size = memoryview(cases.tobytes()), cases.dtype.itemsize
    digests = [
        blake2b(rows[start : start + size], digest_size=KEY.itemsize, key=given).digest()
        for start in range(0, len(rows), size)
    ]
    return np.frombuffer(b"".join(digests), dtype=KEY)


class Shards:
    """The shards of one study in one form, by one solver, in one folder."""

    def __init__(self, folder: Path, form: Form, version: str) -> None:
        """Look in `folder`/<hash of solver, form and layout>, made when first written to.

        version: of the solver.
        """
        given = f"{version} {form} {LAYOUT}"
        self.folder = folder / hashlib.sha256(given.encode()).hexdigest()[:16]
        self._small: dict[Path, tuple[Array, Columns]] = {}  # to be merged, without reading them

    def read(self, *names: str) -> Iterator[tuple[Array, Columns]]:
        """Keys and answers of every sound shard; a damaged one is named in the log.

        names: of the columns to read and check; all without any. Where another process merges
        shards meanwhile, runs may come twice, and none is left out.
        """
        seen: set[Path] = set()
        while fresh := [path for path in self.files() if path not in seen]:
            seen.update(fresh)
            for path in fresh:
                if found := _sound(path, names):
                    yield found

    @staticmethod
    def keys(path: Path) -> Array:
        """Of the runs in one shard; none where it is damaged."""
        found = _sound(path)
        return found[0] if found else np.zeros(0, dtype=KEY)

    def files(self) -> list[Path]:
        """All shards, sound or not."""
        return sorted(self.folder.glob("*.nc"))

    def recover(self) -> Iterator[Array]:
        """Keys of every sound shard, for the one process that writes here, which tidies up.

        All of a shard is checked. A damaged one is renamed, for a person to look at; what was not
        written to its end goes.
        """
        for unfinished in self.folder.glob(".*"):
            unfinished.unlink()
        for path in self.files():
            if found := _sound(path):
                self._noted(path, *found)
                yield found[0]
            else:
                path.replace(path.with_name(path.name + DAMAGED))

    def write(self, keys: Array, columns: Columns) -> Path:
        """Keep runs; returns their file, named for their keys. Raises OSError (a full disk, say).

        columns: of each name, a row a key.
        """
        path = self.folder / f"{hashlib.sha256(keys.tobytes()).hexdigest()[:32]}.nc"
        write_shard(path, keys, columns)
        self._noted(path, keys, columns)
        if len(self._small) >= _MANY or sum(map(_size, self._small.values())) >= _SMALL:
            self.merge()
        return path

    def merge(self) -> None:
        """Put one shard in the place of all small ones, which go when it is on disk."""
        merged, self._small = dict(sorted(self._small.items())), {}
        if len(merged) < 2:
            return
        keys, columns = joined(merged.values())
        _, first = np.unique(keys, return_index=True)
        kept = self.write(keys[first], {name: values[first] for name, values in columns.items()})
        for path in merged.keys() - {kept}:
            path.unlink()

    def _noted(self, path: Path, keys: Array, columns: Columns) -> None:
        if _size((keys, columns)) < _SMALL:
            self._small[path] = keys, columns


def _size(part: tuple[Array, Columns]) -> int:
    """Bytes of a shard, about."""
    keys, columns = part
    return int(keys.nbytes + sum(values.nbytes for values in columns.values()))


def joined(parts: Iterable[tuple[Array, Columns]]) -> tuple[Array, Columns]:
    """Keys and columns of several batches or shards as those of one."""
    keys, columns = zip(*parts, strict=True)
    names = columns[0]
    return (
        np.concatenate(keys),
        {name: np.concatenate([each[name] for each in columns]) for name in names},
    )


def _sound(path: Path, names: Collection[str] = ()) -> tuple[Array, Columns] | None:
    try:
        with Shard(path) as shard:
            columns = shard.columns((KEYS, *names) if names else ())
        return columns.pop(KEYS), columns
    except FileNotFoundError:  # merged into another by now
        return None
    except DAMAGE as error:
        log.warning("%s is damaged, and its runs will be solved again (%s)", path, error)
        return None
