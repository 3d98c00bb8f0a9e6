"""Shards: files of some finished runs, in NumPy's format npz, a checksum per column.

A shard holds the keys and the answers of its runs. The comment of the archive is a digest of the
columns' names and of the place where it was written.
"""

from __future__ import annotations

import struct
import zlib
from hashlib import sha256
from io import BytesIO
from pathlib import Path, PurePath
from typing import IO, Any
from zipfile import BadZipFile, ZipFile

import numpy as np

from impactlab.files import replaced

Array = np.ndarray[Any, Any]
Columns = dict[str, Array]
"""Answers by name, each of shape (runs, ...)."""
KEY = np.dtype("S16")
"""The type of a run's key."""
KEYS = "run key"
"""The column of keys; no answer can have this name."""
DAMAGE = (
    OSError,
    RuntimeError,
    ValueError,
    LookupError,
    EOFError,
    BadZipFile,
    zlib.error,
    struct.error,
)
"""Errors that reading a damaged shard may raise."""
LAYOUT = 3
"""Version of a shard's layout; shards of another layout are not looked for."""


def write_shard(path: Path, keys: Array, columns: Columns) -> None:
    """Write a shard. Raises OSError as `files.replaced`."""
    size = keys.nbytes + sum(values.nbytes for values in columns.values())
    with replaced(path, size) as unfinished, unfinished.open("wb") as file:
        pack_shard(file, path, keys, columns)


def pack_shard(file: IO[bytes], path: PurePath, keys: Array, columns: Columns) -> None:
    """Write the content of a shard to an open file; path: the place where it is going to be."""
    arrays = {KEYS: keys} | columns
    with ZipFile(file, "w") as archive:
        archive.comment = _digest(path, tuple(arrays))
        for name, values in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as column:
                np.lib.format.write_array(column, values, allow_pickle=False)


class Shard:
    """A shard open for reading.

    names: of its columns. Every method raises one of DAMAGE where the file is no sound shard.
    """

    def __init__(self, path: PurePath, file: IO[bytes] | None = None) -> None:
        """Open the file. Missing columns, and another place, are noticed here.

        file: the content of `path`, open for reading, where that is no file of this machine.
        """
        self._file = ZipFile(file or str(path))
        self.names = tuple(name.removesuffix(".npy") for name in self._file.namelist())
        if self._file.comment != _digest(path, self.names):
            raise ValueError("it lacks a column, or was written to another place")

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def read(self, name: str) -> Array:
        """Return a column; its checksum is compared."""
        content = BytesIO(self._file.read(f"{name}.npy"))
        values: Array = np.lib.format.read_array(content, allow_pickle=False)
        return values


def _digest(path: PurePath, names: tuple[str, ...]) -> bytes:
    return sha256(f"{path.parent.name}/{path.name} {names}".encode()).digest()
