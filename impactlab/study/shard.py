"""One shard: keys and answers of some runs as a netCDF file that tells when it is not itself."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
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
DAMAGE = (OSError, RuntimeError, ValueError, TypeError, LookupError, AttributeError)
"""What read_shard raises on a file that is no sound shard: HDF5 knows many ways to stumble."""
_DIMS = {"key": ("byte",)} | {name: entry.dims for name, entry in (HISTORIES | PROFILES).items()}


def write_shard(path: Path, keys: Array, columns: Columns) -> None:
    """Write all of it or nothing. Raises OSError, naming the file, when the disk is full."""
    table = np.frombuffer(keys.tobytes(), dtype=np.uint8).reshape(-1, KEY.itemsize)
    arrays = {"key": table} | columns
    size = sum(values.nbytes for values in arrays.values())
    with whole(path, size) as unfinished, Dataset(unfinished, "w") as file:
        for name, values in arrays.items():
            dims = ("run", *_DIMS.get(name, ()))
            for dim, length in zip(dims, values.shape, strict=True):
                if dim not in file.dimensions:
                    file.createDimension(dim, length)
            file.createVariable(name, values.dtype, dims, fill_value=False)[:] = values
        file.setncattr("checksum", _checksum(arrays, path))


def read_shard(path: Path) -> tuple[Array, Columns]:
    """Keys and answers of a file. Raises one of DAMAGE where its checksum does not hold.

    The checksum covers folder and name, so that a sound shard in another's place is found, too.
    """
    with Dataset(path) as file:
        file.set_auto_maskandscale(False)
        arrays = {name: variable[:] for name, variable in file.variables.items()}
        checksum = file.getncattr("checksum")
    if _checksum(arrays, path) != checksum:
        raise ValueError("its checksum does not hold")
    keys = np.frombuffer(arrays.pop("key").tobytes(), dtype=KEY)
    return keys, arrays


def _checksum(arrays: Mapping[str, Array], path: Path) -> str:
    digest = hashlib.sha256(f"{path.parent.name}/{path.name}".encode())
    for name in sorted(arrays):
        values = arrays[name]
        digest.update(f"{name} {values.shape} {values.dtype}".encode())
        digest.update(np.ascontiguousarray(values).data)
    return digest.hexdigest()
