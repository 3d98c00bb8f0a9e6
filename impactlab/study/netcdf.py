"""netCDF files, written whole or not at all: datasets and shards.

A shard holds keys and answers of some runs, with checksums. Columns of one type and shape are rows
of one variable; the attribute `places` names them.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from netCDF4 import Dataset, set_chunk_cache

from impactlab.files import replaced
from impactlab.variables import HISTORIES, PROFILES

_CACHE = 1_000_000
"""Bytes per variable that HDF5 holds until a file is closed: each chunk is written once, whole."""


def write_netcdf(dataset: xr.Dataset, path: Path) -> None:
    """Write a dataset, large variables compressed. Raises OSError as `files.replaced`."""
    large = {
        str(name): {"zlib": True, "complevel": 1}
        for name, values in dataset.data_vars.items()
        if values.dtype.kind == "f" and values.size > 10_000
    }
    set_chunk_cache(_CACHE)
    with replaced(path, dataset.nbytes) as unfinished:
        dataset.to_netcdf(unfinished, engine="netcdf4", encoding=large)


def read_netcdf(path: Path) -> xr.Dataset:
    """Return a dataset in memory, its file closed. Raises OSError naming an unreadable file."""
    with _opened(path) as dataset:
        return dataset.load()


def read_attributes(path: Path) -> dict[str, Any]:
    """Return the attributes of a dataset. Raises OSError naming an unreadable file."""
    with _opened(path) as dataset:
        return {str(name): value for name, value in dataset.attrs.items()}


@contextmanager
def _opened(path: Path) -> Iterator[xr.Dataset]:
    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            yield dataset
    except (OSError, ValueError, RuntimeError) as error:
        raise OSError(f"{path}: cannot be read as netCDF ({error})") from None


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
    """Write the whole shard or nothing. Raises OSError, naming the file, when the disk is full."""
    arrays = {KEYS: _bytes(keys)} | columns
    size = sum(values.nbytes for values in arrays.values())
    with replaced(path, size) as unfinished, Dataset(unfinished, "w") as file:
        places: dict[str, tuple[str, int]] = {}
        for alike in _alike(arrays):
            table = _written(file, [arrays[name] for name in alike], _DIMS.get(alike[0], ()))
            places |= {name: (table, row) for row, name in enumerate(alike)}
        file.setncattr("places", json.dumps(places))
        checksums = {name: _checksum(path, name, values) for name, values in arrays.items()}
        file.setncattr("checksums", json.dumps(checksums))


def _alike(arrays: Columns) -> Collection[list[str]]:
    """Group the names of columns by type and dimensions."""
    names: dict[tuple[str, ...], list[str]] = {}
    for name, values in arrays.items():
        names.setdefault((values.dtype.name, *_DIMS.get(name, ())), []).append(name)
    return names.values()


def _written(file: Dataset, columns: list[Array], others: tuple[str, ...]) -> str:
    """Write columns as rows of one variable and return its name: each variable takes 0.5 ms.

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
    """A shard open for reading. Opening takes longer than reading a column.

    Every method raises one of DAMAGE where the file is no sound shard.
    """

    def __init__(self, path: Path) -> None:
        """Open the file. Missing and surplus columns are noticed here."""
        self._path, self._file = path, Dataset(path)
        self._file.set_auto_maskandscale(False)
        self._checksums = json.loads(self._file.getncattr("checksums"))
        self._places = json.loads(self._file.getncattr("places"))
        rows = [variable.shape[0] for variable in self._file.variables.values()]
        if self._checksums.keys() != self._places.keys() or len(self._places) != sum(rows):
            raise ValueError("it lacks a column, or has one too many")

    def __enter__(self) -> Shard:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def layout(self, name: str) -> tuple[tuple[int, ...], np.dtype[Any]]:
        """Return the shape of a column's row and its type."""
        variable = self._file[self._places[name][0]]
        return tuple(variable.shape[2:]), variable.dtype

    def read(self, name: str) -> Array:
        """Return a column.

        Its checksum covers folder and name, so that a sound shard in another's place is noticed.
        """
        table, row = self._places[name]
        values: Array = self._file[table][row]
        if _checksum(self._path, name, values) != self._checksums[name]:
            raise ValueError(f"the checksum of its column {name} does not hold")
        return np.frombuffer(values.tobytes(), dtype=KEY) if name == KEYS else values

    def columns(self, names: Collection[str] = ()) -> Columns:
        """Return the columns of these names, or all of them; keys are under KEYS."""
        return {name: self.read(name) for name in names or self._checksums}


def _bytes(keys: Array) -> Array:
    return np.frombuffer(keys.tobytes(), dtype=np.uint8).reshape(-1, KEY.itemsize)


def _checksum(path: Path, name: str, values: Array) -> str:
    head = f"{path.parent.name}/{path.name} {name} {values.shape} {values.dtype}"
    digest = hashlib.sha256(head.encode())
    digest.update(np.ascontiguousarray(values).data)
    return digest.hexdigest()
