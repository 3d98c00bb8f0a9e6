"""netCDF files, written whole or not at all: datasets and shards.

A shard holds keys and answers of some runs, with checksums. Columns of one type and shape are rows
of one variable; the attribute `places` names them.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
import xarray as xr
from netCDF4 import Dataset, set_chunk_cache
from rich.filesize import decimal

from impactlab.variables import HISTORIES, PROFILES

_CACHE = 1_000_000
"""Bytes of a variable that HDF5 holds until a file is closed: each chunk is written once, whole."""


@contextmanager
def whole(path: Path, size: int) -> Iterator[Path]:
    """A temporary name to write to, renamed in the end: readers see all of a file or none of it.

    size: about what is written, in bytes. Raises OSError, naming the file and the space left, when
    the disk does not take it; an older file then stays as it was.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.{uuid4().hex}")
    try:
        yield unfinished
        with unfinished.open("rb") as handle:
            os.fsync(handle.fileno())
        unfinished.replace(path)
    except (OSError, RuntimeError) as error:  # HDF5 does not tell a full disk from others
        raise OSError(_unwritten(path, size, error)) from error
    finally:
        unfinished.unlink(missing_ok=True)


def write_netcdf(dataset: xr.Dataset, path: Path) -> None:
    """Write all of it or nothing; large variables are compressed. Raises OSError: see whole."""
    large = {
        str(name): {"zlib": True, "complevel": 1}
        for name, values in dataset.data_vars.items()
        if values.dtype.kind == "f" and values.size > 10_000
    }
    set_chunk_cache(_CACHE)
    with whole(path, dataset.nbytes) as unfinished:
        dataset.to_netcdf(unfinished, engine="netcdf4", encoding=large)


def _unwritten(path: Path, size: int, error: Exception) -> str:
    free = shutil.disk_usage(path.parent).free
    said = f"{path}: could not be written ({error}); {decimal(free)} are free on its disk"
    if free < size:
        return f"{said}, {decimal(size)} are needed: make room, then run the same command again"
    return said


def read_netcdf(path: Path) -> xr.Dataset:
    """A dataset in memory, its file closed. Raises OSError, naming a file that cannot be read."""
    with _opened(path) as dataset:
        return dataset.load()


def read_attributes(path: Path) -> dict[str, Any]:
    """Those of a dataset. Raises OSError, naming a file that cannot be read."""
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
