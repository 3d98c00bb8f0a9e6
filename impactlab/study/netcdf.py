"""Datasets on disk, written whole or not at all.

Apart from the shards: not every step that reads a file needs to load a compiler.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from uuid import uuid4

import xarray as xr
from netCDF4 import set_chunk_cache
from rich.filesize import decimal

_CACHE = 1_000_000
"""Bytes of a variable that HDF5 holds until a file is closed: each chunk is written once, whole."""


def write_netcdf(dataset: xr.Dataset, path: Path, *, compress: bool = True) -> None:
    """Write under a temporary name, then rename: readers see all of a file or none of it.

    compress: large variables, which takes longer. Raises OSError, naming the file and the space
    left, when the disk does not take it; an older file then stays as it was.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.{uuid4().hex}")
    large = {
        str(name): {"zlib": True, "complevel": 1}
        for name, values in dataset.data_vars.items()
        if compress and values.dtype.kind == "f" and values.size > 10_000
    }
    set_chunk_cache(_CACHE)
    try:
        dataset.to_netcdf(unfinished, engine="netcdf4", encoding=large)
        with unfinished.open("rb") as handle:
            os.fsync(handle.fileno())
        unfinished.replace(path)
    except (OSError, RuntimeError) as error:  # HDF5 does not tell a full disk from others
        raise OSError(_unwritten(dataset, path, error)) from error
    finally:
        unfinished.unlink(missing_ok=True)


def _unwritten(dataset: xr.Dataset, path: Path, error: Exception) -> str:
    free, needed = shutil.disk_usage(path.parent).free, dataset.nbytes
    said = f"{path}: could not be written ({error}); {decimal(free)} are free on its disk"
    if free < needed:
        return f"{said}, {decimal(needed)} are needed: make room, then run the same command again"
    return said


def read_netcdf(path: Path) -> xr.Dataset:
    """A dataset in memory, its file closed. Raises OSError, naming a file that cannot be read."""
    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            return dataset.load()
    except (OSError, ValueError, RuntimeError) as error:
        raise OSError(f"{path}: cannot be read as netCDF ({error})") from None
