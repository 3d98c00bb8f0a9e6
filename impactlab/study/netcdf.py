"""Shards: netCDF files of some finished runs.

A shard holds keys and answers of some runs, with checksums. Columns of one type and shape are rows
of one variable; the attribute `places` names them.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
from netCDF4 import Dataset

from impactlab.files import replaced
from impactlab.variables import HISTORIES, PROFILES

Array = np.ndarray[Any, Any]
Columns = dict[str, Array]
"""Answers by name, each of shape (runs, ...)."""
KEY = np.dtype("S16")
"""The type of a run's key."""
KEYS = "key"
"""The column of keys."""
DAMAGE = (OSError, RuntimeError, ValueError, TypeError, LookupError, AttributeError)
"""Errors that reading a damaged shard may raise: HDF5 has many."""
LAYOUT = 2
"""Version of a shard's layout; shards of another layout are not looked for."""
_DIMS = {KEYS: ("byte",)} | {name: entry.dims for name, entry in (HISTORIES | PROFILES).items()}


def write_shard(path: Path, keys: Array, columns: Columns) -> None:
    """Write a shard. Raises OSError as `files.replaced`."""
    letters = np.frombuffer(keys.tobytes(), dtype=np.uint8).reshape(-1, KEY.itemsize)
    arrays = {KEYS: letters} | columns
    tables: dict[tuple[str, ...], list[str]] = {}  # each variable takes 0.5 ms
    for name, values in arrays.items():
        tables.setdefault((values.dtype.name, *_DIMS.get(name, ())), []).append(name)
    size = sum(values.nbytes for values in arrays.values())
    with replaced(path, size) as unfinished, Dataset(unfinished, "w") as file:
        places: dict[str, tuple[str, int]] = {}
        for kind, names in tables.items():
            table, first = "_".join(kind), arrays[names[0]]
            dims = (f"{table}_column", "run", *kind[1:])
            for dim, length in zip(dims, (len(names), *first.shape), strict=True):
                if dim not in file.dimensions:
                    file.createDimension(dim, length)
            variable = file.createVariable(table, first.dtype, dims, fill_value=False)
            variable[:] = np.stack([arrays[name] for name in names])  # one call per row takes long
            places |= {name: (table, row) for row, name in enumerate(names)}
        file.setncattr("places", json.dumps(places))
        checksums = {name: _checksum(path, name, values) for name, values in arrays.items()}
        file.setncattr("checksums", json.dumps(checksums))


class Shard:
    """A shard open for reading. Opening takes longer than reading a column.

    names: of its columns. Every method raises one of DAMAGE where the file is no sound shard.
    """

    def __init__(self, path: Path) -> None:
        """Open the file. Missing and surplus columns are noticed here."""
        self._path, self._file = path, Dataset(path)
        self._file.set_auto_maskandscale(False)
        self._checksums = json.loads(self._file.getncattr("checksums"))
        self._places = json.loads(self._file.getncattr("places"))
        self.names = tuple(self._places)
        rows = sum(variable.shape[0] for variable in self._file.variables.values())
        if self._checksums.keys() != self._places.keys() or len(self._places) != rows:
            raise ValueError("it lacks a column, or has one too many")

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def layout(self, name: str) -> tuple[tuple[int, ...], np.dtype[Any]]:
        """Return the shape of a column's row and its type, without reading it."""
        variable = self._file[self._places[name][0]]
        return tuple(variable.shape[2:]), variable.dtype

    def read(self, name: str) -> Array:
        """Return a column. A sound shard in another's place is noticed, too: see _checksum."""
        table, row = self._places[name]
        values: Array = self._file[table][row]
        if _checksum(self._path, name, values) != self._checksums[name]:
            raise ValueError(f"the checksum of its column {name} does not hold")
        return np.frombuffer(values.tobytes(), dtype=KEY) if name == KEYS else values


def _checksum(path: Path, name: str, values: Array) -> str:
    head = f"{path.parent.name}/{path.name} {name} {values.shape} {values.dtype}"
    digest = hashlib.sha256(head.encode())
    digest.update(np.ascontiguousarray(values).data)
    return digest.hexdigest()
