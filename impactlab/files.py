"""Files that are written completely or not at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from uuid import uuid4

from rich.filesize import decimal


@contextmanager
def replaced(path: Path, size: int = 0) -> Iterator[Path]:
    """Give a temporary path beside `path`, renamed to it in the end: readers see all or nothing.

    size: of what is written, in bytes, roughly, where it may be large. Raises OSError, naming the
    file and the space left, where it cannot be written; an older file then stays as it was.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.{uuid4().hex}")
    try:
        yield unfinished
        with unfinished.open("rb") as handle:
            os.fsync(handle.fileno())
        unfinished.replace(path)
    except (OSError, RuntimeError) as error:  # HDF5 does not tell a full disk from others
        free = shutil.disk_usage(path.parent).free
        message = f"{path}: could not be written ({error}); {decimal(free)} are free on its disk"
        if free < size:
            message += f", {decimal(size)} are needed: make room, then run the same command again"
        raise OSError(message) from error
    finally:
        unfinished.unlink(missing_ok=True)
