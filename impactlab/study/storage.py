"""Finished batches on disk: checked, atomically renamed netCDF shards, found again by content.

A run's key is a hash of its case and of the version of its solver, so a shard is never taken for
another run's answer, and a changed study finds what still fits.
"""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.dataset import HISTORIES, PROFILES
from impactlab.simulate import Answers
from impactlab.study.netcdf import read_netcdf, write_netcdf

log = logging.getLogger(__name__)
Array = np.ndarray[Any, Any]
_KEY_BYTES = 16


@dataclass(frozen=True)
class Form:
    """What is kept of each run: samples a history (0: none), and whether profiles."""

    samples: int
    profiles: bool


def run_keys(cases: Array, form: Form, version: str) -> list[bytes]:
    """One key a case, 16 bytes: equal keys, equal answers. version: of the solver."""
    prefix = hashlib.sha256(f"{version} {form} {cases.dtype.descr}".encode())
    keys = []
    for case in cases:
        digest = prefix.copy()
        digest.update(case.tobytes())
        keys.append(digest.digest()[:_KEY_BYTES])
    return keys


class Shards:
    """The shards of one study in one form, by one solver, in one folder."""

    def __init__(self, folder: Path, form: Form, response: np.dtype[Any], version: str) -> None:
        """Look in `folder`/<hash of solver and form>, made when first written to.

        response: of the solver's record of responses; version: of the solver.
        """
        name = hashlib.sha256(f"{version} {form}".encode()).hexdigest()[:16]
        self.folder = folder / name
        self.response = response

    def read(self) -> Iterator[tuple[list[bytes], Answers]]:
        """Keys and answers of every sound shard; a damaged one is named in the log."""
        for path in sorted(self.folder.glob("*.nc")):
            try:
                yield _unpack(read_netcdf(path), self.response)
            except (OSError, ValueError, KeyError, RuntimeError) as error:
                log.warning("%s is damaged and will be solved again (%s)", path, error)

    def write(self, keys: list[bytes], answers: Answers) -> Path:
        """Keep a batch; returns its file, named for its keys. Raises OSError (a full disk, say)."""
        path = self.folder / f"{hashlib.sha256(b''.join(keys)).hexdigest()[:32]}.nc"
        write_netcdf(_pack(keys, answers), path)
        return path

    def replace_all(self, keys: list[bytes], answers: Answers) -> None:
        """One shard in the place of all: thousands of small files are slow to open."""
        others = set(self.folder.glob("*.nc"))
        kept = self.write(keys, answers)
        for path in others - {kept}:
            path.unlink(missing_ok=True)


def _pack(keys: list[bytes], answers: Answers) -> xr.Dataset:
    table = np.frombuffer(b"".join(keys), dtype=np.uint8).reshape(-1, _KEY_BYTES)
    variables: dict[str, Any] = {"key": (("run", "byte"), table)}
    for name in answers.responses.dtype.names or ():
        variables[name] = (("run",), np.ascontiguousarray(answers.responses[name]))
    for name, values in (answers.histories | answers.profiles).items():
        variables[name] = (("run", *(HISTORIES | PROFILES)[name].dims), values)
    dataset = xr.Dataset(variables)
    return dataset.assign_attrs(checksum=_checksum(dataset))


def _unpack(shard: xr.Dataset, response: np.dtype[Any]) -> tuple[list[bytes], Answers]:
    """Keys and answers of a shard. Raises ValueError when its checksum does not hold."""
    if _checksum(shard) != shard.attrs["checksum"]:
        raise ValueError("its checksum does not hold")
    responses = np.zeros(shard.sizes["run"], dtype=response)
    for name in response.names or ():
        responses[name] = shard[name].values
    keys = [row.tobytes() for row in shard["key"].values]
    histories = {name: shard[name].values for name in HISTORIES if name in shard}
    profiles = {name: shard[name].values for name in PROFILES if name in shard}
    return keys, Answers(responses, histories, profiles)


def _checksum(dataset: xr.Dataset) -> str:
    digest = hashlib.sha256()
    for name in sorted(map(str, dataset.data_vars)):
        values = dataset[name].values
        digest.update(f"{name} {dataset[name].dims} {values.shape} {values.dtype}".encode())
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()
