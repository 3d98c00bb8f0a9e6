"""Files that are written completely or not at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.filesize import decimal


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Give a temporary path beside `path`, which is renamed to it once the block succeeds.

    Raises OSError, naming the file and the space left, where it cannot be written; then `path` is
    as it was.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield temporary
        temporary.replace(path)
    except (OSError, RuntimeError) as error:  # a netCDF file on a full disk raises either
        free = decimal(shutil.disk_usage(path.parent).free)
        message = f"{path}: could not be written ({error}); {free} are free on its disk"
        raise OSError(message) from error
    finally:
        temporary.unlink(missing_ok=True)
