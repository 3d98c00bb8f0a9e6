"""Shards: files of some finished runs, in NumPy's format npz, a checksum per column.

A shard holds the keys and the answers of its runs. The comment of the archive is a digest of the
columns' names and of the place where it was written.

Blocks are shards that are named for their runs, in a folder or in an object store. Nothing is
locked, and no file is changed or removed: where two processes solve the same runs, they write the
same values, of which readers take one.
"""

from __future__ import annotations

import logging
import re
import struct
import zlib
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from hashlib import sha256
from io import BytesIO
from pathlib import Path, PurePath, PurePosixPath
from typing import IO, Any, NamedTuple
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


log = logging.getLogger(__name__)

_NAME = re.compile(r"(\d+)-(\d+)-of-(\d+)\.npz")


class Block(NamedTuple):
    """A file of the runs from `start` to `stop`; parts: the number of parts of the study."""

    start: int
    stop: int
    parts: int

    @property
    def name(self) -> str:
        """The name of the file."""
        return f"{self.start}-{self.stop}-of-{self.parts}.npz"


class Piece(NamedTuple):
    """Runs from `start` to `stop` and the block that holds them; None where none does."""

    start: int
    stop: int
    block: Block | None


def pieces_of(blocks: Iterable[Block], start: int, stop: int) -> Iterator[Piece]:
    """Yield the runs from start to stop in order, each once, with the block that holds them."""
    for block in sorted(blocks):
        if block.stop <= start or block.start >= stop:
            continue
        if block.start > start:
            yield Piece(start, block.start, None)
            start = block.start
        end = min(block.stop, stop)
        yield Piece(start, end, block)
        start = end
    if start < stop:
        yield Piece(start, stop, None)


@dataclass(frozen=True)
class PartFiles:
    """The blocks of one design, in a folder: of this machine, or of a file system of fsspec."""

    folder: PurePath
    system: Any = None

    @staticmethod
    def at(place: str | Path, name: str) -> PartFiles:
        """Return those in the folder of this name within a place, which is a folder or a URL.

        Raises OSError where the package for this kind of URL is not installed.
        """
        if "://" not in str(place):
            return PartFiles(Path(place) / name)
        import fsspec

        with _reached(place):
            system, folder = fsspec.url_to_fs(str(place))
        return PartFiles(PurePosixPath(folder) / name, system)

    def blocks(self) -> list[Block]:
        """Return all blocks, sound or not. Raises OSError where the place is out of reach."""
        if self.system is None:
            names = [path.name for path in Path(self.folder).glob("*.npz")]
        else:
            with _reached(self.folder):
                exists = self.system.exists(str(self.folder))
                paths = self.system.ls(str(self.folder), detail=False) if exists else []
            names = [PurePosixPath(path).name for path in paths]
        matches = filter(None, map(_NAME.fullmatch, names))
        return [Block(*map(int, match.groups())) for match in matches]

    @contextmanager
    def opened(self, block: Block) -> Iterator[Shard]:
        """Open a block. Raises one of DAMAGE where it is not sound."""
        path = self.folder / block.name
        with ExitStack() as stack:
            file = None
            if self.system is not None:
                file = stack.enter_context(self.system.open(str(path), "rb"))
            yield stack.enter_context(closing(Shard(path, file)))

    def sound(self, blocks: Iterable[Block]) -> list[Block]:
        """Return the blocks that are whole and unchanged; the log names the others."""
        return [block for block in blocks if self._is_sound(block)]

    def _is_sound(self, block: Block) -> bool:
        try:
            with self.opened(block) as shard:
                sizes = {len(shard.read(name)) for name in shard.names}
            if sizes != {block.stop - block.start}:
                raise ValueError("it holds another number of runs")
        except DAMAGE as error:
            path = self.folder / block.name
            log.warning("%s is damaged, and its runs have to be solved again (%s)", path, error)
            return False
        return True

    def read(self, block: Block, name: str) -> Array:
        """Return a column of a block. Raises OSError where it is not sound any more."""
        try:
            with self.opened(block) as shard:
                return shard.read(name)
        except DAMAGE as error:
            path = self.folder / block.name
            raise OSError(f"{path} was damaged while it was read ({error}): try again") from error

    def write(self, block: Block, keys: Array, columns: Columns) -> None:
        """Write a block, all or nothing. Raises OSError, for example when the disk is full."""
        path = self.folder / block.name
        if self.system is None:
            write_shard(Path(path), keys, columns)
            return
        content = BytesIO()
        pack_shard(content, path, keys, columns)
        with _reached(path):
            self.system.pipe_file(str(path), content.getvalue())


@contextmanager
def _reached(place: object) -> Iterator[None]:
    """Turn errors of a remote file system, which are of many kinds, into OSError."""
    try:
        yield
    except ImportError as error:
        advice = "for s3: pip install 'impactlab[s3]'"
        raise OSError(
            f"{place}: needs a package that is not installed ({error}); {advice}"
        ) from None
    except Exception as error:
        raise OSError(f"{place}: cannot be reached ({error})") from error
