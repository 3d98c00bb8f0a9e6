"""One shard: keys and answers of some runs as a netCDF file that tells when it is not itself."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from netCDF4 import Dataset

from impactlab.dataset import HISTORIES, PROFILES
from impactlab.study.netcdf import whole

Array = np.ndarray[Any, Any]
Columns = dict[str, Array]
"""Answers by name, each of shape (runs, ...)."""
KEY = np.dtype("S16")
"""Of the key of a run."""
KEYS = "key"
"""The column of keys."""
DAMAGE = (OSError, RuntimeError, ValueError, TypeError, LookupError, AttributeError)
"""What read_shard raises on a file that is no sound shard: HDF5 knows many ways to stumble."""
_DIMS = {KEYS: ("byte",)} | {name: entry.dims for name, entry in (HISTORIES | PROFILES).items()}


def write_shard(path: Path, keys: Array, columns: Columns) -> None:
    """Write all of it or nothing. Raises OSError, naming the file, when the disk is full."""
    arrays = {KEYS: _bytes(keys)} | columns
    size = sum(values.nbytes for values in arrays.values())
    with whole(path, size) as unfinished, Dataset(unfinished, "w") as file:
        for name, values in arrays.items():
            dims = ("run", *_DIMS.get(name, ()))
            for dim, length in zip(dims, values.shape, strict=True):
                if dim not in file.dimensions:
                    file.createDimension(dim, length)
            file.createVariable(name, values.dtype, dims, fill_value=False)[:] = values
        checksums = {name: _checksum(path, name, values) for name, values in arrays.items()}
        file.setncattr("checksums", json.dumps(checksums))


def read_shard(path: Path, names: Collection[str] = ()) -> Columns:
    """The columns of a file, keys under KEYS; only those of these names, if any are given.

    Raises one of DAMAGE where a checksum of theirs does not hold. It covers folder and name, so
    that a sound shard in another's place is found, too.
    """
    with Dataset(path) as file:
        file.set_auto_maskandscale(False)
        checksums = json.loads(file.getncattr("checksums"))
        if checksums.keys() != file.variables.keys():
            raise ValueError("it lacks a column, or has one too many")
        arrays = {name: file[name][:] for name in names or checksums}
    for name, values in arrays.items():
        if _checksum(path, name, values) != checksums[name]:
            raise ValueError(f"the checksum of its column {name} does not hold")
    if KEYS in arrays:
        arrays[KEYS] = np.frombuffer(arrays[KEYS].tobytes(), dtype=KEY)
    return arrays


def _bytes(keys: Array) -> Array:
    return np.frombuffer(keys.tobytes(), dtype=np.uint8).reshape(-1, KEY.itemsize)


def _checksum(path: Path, name: str, values: Array) -> str:
    head = f"{path.parent.name}/{path.name} {name} {values.shape} {values.dtype}"
    digest = hashlib.sha256(head.encode())
    digest.update(np.ascontiguousarray(values).data)
    return digest.hexdigest()
