"""Datasets on disk, written whole or not at all.

Apart from the shards: not every step that reads a file needs to load a compiler.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from uuid import uuid4

import xarray as xr
from netCDF4 import set_chunk_cache
from rich.filesize import decimal

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
