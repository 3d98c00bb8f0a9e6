"""One process at a time on a folder of shards.

The lock is the operating system's: it goes with its process, however that ends, so none is stale.
"""

from __future__ import annotations

import logging
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import datetime
from pathlib import Path

from filelock import FileLock, Timeout

log = logging.getLogger(__name__)
_PATIENCE = 1.0
"""Seconds to wait: `holder` takes the lock for a moment."""


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Work in `folder` alone, in steps that may hold it again. Raises BlockingIOError: who does."""
    folder.mkdir(parents=True, exist_ok=True)
    lock, owner = FileLock(folder / "lock", is_singleton=True), folder / "owner"
    try:
        lock.acquire(timeout=_PATIENCE)
    except Timeout:
        raise BlockingIOError(
            f"{folder}: {_read(owner)} is at work here: wait until it ends, or end it; "
            "the same command then goes on from there"
        ) from None
    try:
        if lock.lock_counter == 1:
            _sign(owner)
        yield
        if lock.lock_counter == 1:
            owner.unlink(missing_ok=True)
    finally:
        lock.release()


def _sign(owner: Path) -> None:
    if owner.exists():
        log.info("%s did not finish: going on from what it kept", _read(owner))
    now = datetime.now().astimezone().isoformat(" ", "seconds")
    with suppress(OSError):  # a note for people, which a full disk may not take
        owner.write_text(f"process {os.getpid()} on {socket.gethostname()}, since {now}")


def holder(folder: Path) -> str:
    """Who works in the folder: process, host and since when; "" when nobody does."""
    if not (folder / "lock").exists():
        return ""
    lock = FileLock(folder / "lock")
    with suppress(Timeout), lock.acquire(timeout=0):
        return ""
    return _read(folder / "owner")


def _read(owner: Path) -> str:
    with suppress(OSError):
        return owner.read_text().strip() or "another process"
    return "another process"
