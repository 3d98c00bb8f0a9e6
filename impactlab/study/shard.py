"""One shard: keys and answers of some runs as a netCDF file that tells when it is not itself.

Columns of one type and shape are rows of one variable; which, the attribute `places` tells.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from netCDF4 import Dataset

from impactlab.study.netcdf import whole
from impactlab.variables import HISTORIES, PROFILES

Array = np.ndarray[Any, Any]
Columns = dict[str, Array]
"""Answers by name, each of shape (runs, ...)."""
KEY = np.dtype("S16")
"""Of the key of a run."""
KEYS = "key"
"""The column of keys."""
DAMAGE = (OSError, RuntimeError, ValueError, TypeError, LookupError, AttributeError)
"""What read_shard raises on a file that is no sound shard: HDF5 knows many ways to stumble."""
LAYOUT = 2
"""Changes with the layout of a file: one of another layout is not looked for."""
_DIMS = {KEYS: ("byte",)} | {name: entry.dims for name, entry in (HISTORIES | PROFILES).items()}


def write_shard(path: Path, keys: Array, columns: Columns) -> None:
    """Write all of it or nothing. Raises OSError, naming the file, when the disk is full."""
    arrays = {KEYS: _bytes(keys)} | columns
    size = sum(values.nbytes for values in arrays.values())
    with whole(path, size) as unfinished, Dataset(unfinished, "w") as file:
        places: dict[str, tuple[str, int]] = {}
        for alike in _alike(arrays):
            table = _written(file, [arrays[name] for name in alike], _DIMS.get(alike[0], ()))
            places |= {name: (table, row) for row, name in enumerate(alike)}
        file.setncattr("places", json.dumps(places))
        checksums = {name: _checksum(path, name, values) for name, values in arrays.items()}
        file.setncattr("checksums", json.dumps(checksums))


def _alike(arrays: Columns) -> Collection[list[str]]:
    """Names of columns, those of one type and the same dimensions together."""
    names: dict[tuple[str, ...], list[str]] = {}
    for name, values in arrays.items():
        names.setdefault((values.dtype.name, *_DIMS.get(name, ())), []).append(name)
    return names.values()


def _written(file: Dataset, columns: list[Array], others: tuple[str, ...]) -> str:
    """The name of a variable that takes them as rows: to make one takes half a millisecond.

    others: dimensions beside that of the runs.
    """
    name = "_".join((columns[0].dtype.name, *others))
    dims = (f"{name}_column", "run", *others)
    for dim, length in zip(dims, (len(columns), *columns[0].shape), strict=True):
        if dim not in file.dimensions:
            file.createDimension(dim, length)
    variable = file.createVariable(name, columns[0].dtype, dims, fill_value=False)
    for row, values in enumerate(columns):
        variable[row] = values
    return name


class Shard:
    """A file that is open for reading, which takes longer than a column of it.

    All raise one of DAMAGE where it is no sound shard.
    """

    def __init__(self, path: Path) -> None:
        """Open it. Columns that it lacks, or has too many, are found here."""
        self._path, self._file = path, Dataset(path)
        self._file.set_auto_maskandscale(False)
        self._checksums = json.loads(self._file.getncattr("checksums"))
        self._places = json.loads(self._file.getncattr("places"))
        held = [variable.shape[0] for variable in self._file.variables.values()]
        if self._checksums.keys() != self._places.keys() or len(self._places) != sum(held):
            raise ValueError("it lacks a column, or has one too many")

    def __enter__(self) -> Shard:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def layout(self, name: str) -> tuple[tuple[int, ...], np.dtype[Any]]:
        """Shape beside that of the runs, and type, of a column."""
        variable = self._file[self._places[name][0]]
        return tuple(variable.shape[2:]), variable.dtype

    def read(self, name: str) -> Array:
        """A column.

        Its checksum covers folder and name: a sound shard in another's place is found, too.
        """
        table, row = self._places[name]
        values: Array = self._file[table][row]
        if _checksum(self._path, name, values) != self._checksums[name]:
            raise ValueError(f"the checksum of its column {name} does not hold")
        return np.frombuffer(values.tobytes(), dtype=KEY) if name == KEYS else values

    def columns(self, names: Collection[str] = ()) -> Columns:
        """Those of these names; all without any, keys under KEYS."""
        return {name: self.read(name) for name in names or self._checksums}


def _bytes(keys: Array) -> Array:
    return np.frombuffer(keys.tobytes(), dtype=np.uint8).reshape(-1, KEY.itemsize)


def _checksum(path: Path, name: str, values: Array) -> str:
    head = f"{path.parent.name}/{path.name} {name} {values.shape} {values.dtype}"
    digest = hashlib.sha256(head.encode())
    digest.update(np.ascontiguousarray(values).data)
    return digest.hexdigest()
