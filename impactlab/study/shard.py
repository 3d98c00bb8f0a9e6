"""One shard: keys and answers of some runs as a netCDF file that tells when it is not itself."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.dataset import HISTORIES, PROFILES
from impactlab.study.netcdf import read_netcdf

Array = np.ndarray[Any, Any]
Columns = dict[str, Array]
"""Answers by name, each of shape (runs, ...)."""
KEY = np.dtype("S16")
"""Of the key of a run."""
DAMAGE = (OSError, ValueError, KeyError, RuntimeError)
"""What unpack raises on a file that is no sound shard."""
_DIMS = {name: entry.dims for name, entry in (HISTORIES | PROFILES).items()}


def pack(keys: Array, columns: Columns, claim: str) -> xr.Dataset:
    """The shard as a dataset. claim: folder and name it will have."""
    table = np.frombuffer(keys.tobytes(), dtype=np.uint8).reshape(-1, KEY.itemsize)
    variables: dict[str, Any] = {"key": (("run", "byte"), table)}
    for name, values in columns.items():
        variables[name] = (("run", *_DIMS.get(name, ())), np.ascontiguousarray(values))
    dataset = xr.Dataset(variables)
    return dataset.assign_attrs(checksum=_checksum(dataset, claim))


def unpack(path: Path, claim: str) -> tuple[Array, Columns]:
    """Keys and answers of a file. Raises one of DAMAGE where its checksum does not hold.

    The checksum covers the claim, so that a sound shard under another's name is found, too.
    """
    shard = read_netcdf(path)
    if _checksum(shard, claim) != shard.attrs["checksum"]:
        raise ValueError("its checksum does not hold")
    keys = np.frombuffer(shard["key"].values.tobytes(), dtype=KEY)
    columns = {str(name): shard[name].values for name in shard.data_vars if name != "key"}
    return keys, columns


def _checksum(dataset: xr.Dataset, claim: str) -> str:
    digest = hashlib.sha256(claim.encode())
    for name in sorted(map(str, dataset.data_vars)):
        values = dataset[name].values
        digest.update(f"{name} {dataset[name].dims} {values.shape} {values.dtype}".encode())
        digest.update(np.ascontiguousarray(values).data)
    return digest.hexdigest()
