"""The answers of a design as its shards hold them: a column is read when it is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import dask.array as da
import numpy as np
from dask.delayed import delayed

from impactlab.study.ledger import Ledger
from impactlab.study.shard import DAMAGE, KEYS, read_shard
from impactlab.study.storage import Shards

Array = np.ndarray[Any, Any]


class Answers:
    """All answers of a design, a column at a time in memory."""

    def __init__(self, shards: Shards, ledger: Ledger) -> None:
        """Look up where each run's answers lie. Raises OSError where a run has none."""
        self._ledger = ledger
        self._parts: list[tuple[Path, Array, Array]] = []
        for path in shards.files():
            asked, runs = ledger.find(_read(path, KEYS))
            if runs.size:
                self._parts.append((path, np.flatnonzero(asked), runs))
        found = np.zeros(ledger.size, dtype=bool)
        for _, _, runs in self._parts:
            found[runs] = True
        if not ledger.spread(found).all():
            raise OSError(f"{shards.folder}: shards went while they were read: {_AGAIN}")

    def columns(self, names: Sequence[str]) -> dict[str, da.Array]:
        """Answers by name, each of shape (runs, ...), in one block that is read when computed."""
        return {name: self._column(name) for name in names}

    def _column(self, name: str) -> da.Array:
        path, rows, _ = self._parts[0]
        sample = _read(path, name)[rows[:1]]
        shape = (self._ledger.size, *sample.shape[1:])
        values = delayed(self._values)(name, shape)
        column: da.Array = da.from_delayed(values, shape, sample.dtype)  # type: ignore[no-untyped-call]
        return column

    def _values(self, name: str, shape: tuple[int, ...]) -> Array:
        whole = None
        for path, rows, runs in self._parts:
            values = _read(path, name)
            whole = np.empty(shape, values.dtype) if whole is None else whole
            whole[runs] = values[rows]
        assert whole is not None  # a design has runs
        return self._ledger.spread(whole)


_AGAIN = "run the same command again: what is lost is solved again"


def _read(path: Path, name: str) -> Array:
    """One column of a shard. Raises OSError where it is not what was written."""
    try:
        return read_shard(path, (name,))[name]
    except DAMAGE as error:
        raise OSError(f"{path} was damaged after it was written ({error}): {_AGAIN}") from error
