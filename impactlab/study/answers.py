"""The answers of a design as its shards hold them: a column is read when it is asked for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import dask.array as da
import numpy as np
from dask.delayed import delayed

from impactlab.study.ledger import Ledger
from impactlab.study.shard import DAMAGE, KEYS, Shard
from impactlab.study.storage import Shards

Array = np.ndarray[Any, Any]


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
