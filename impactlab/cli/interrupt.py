"""Ctrl-C: how a command ends when it is interrupted."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import active_children
from typing import NoReturn

_INTERRUPTED = b"impactlab: interrupted\n"
_STOPPING = b"impactlab: stopping to keep what is computed; Ctrl-C again ends at once\n"


def stop_without_more() -> None:
    """Make Ctrl-C end the process at once: nothing has begun, and imports swallow exceptions."""

    def stop(number: int, frame: object) -> NoReturn:
        os.write(sys.stderr.fileno(), _INTERRUPTED)
        os._exit(130)

    signal.signal(signal.SIGINT, stop)


def stopped() -> None:
    """Make Ctrl-C do nothing: the process is about to end by itself."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def stop_quietly() -> None:
    """Make Ctrl-C end the command with one line; unfinished files are removed."""

    def stop(number: int, frame: object) -> NoReturn:
        os.write(sys.stderr.fileno(), _INTERRUPTED)
        raise SystemExit(130)

    signal.signal(signal.SIGINT, stop)


def stop_at_once() -> None:
    """Make Ctrl-C end the command without any clean-up: that of dask may hang.

    Finished batches are on disk.
    """

    def stop(number: int, frame: object) -> NoReturn:
        show_cursor = "\x1b[?25h\n" if sys.stderr.isatty() else ""
        message = f"{show_cursor}impactlab: interrupted; the same command goes on from here\n"
        os.write(sys.stderr.fileno(), message.encode())
        for worker in active_children():
            worker.kill()
        os._exit(130)

    # a process of multiprocessing's cleans up behind us: it need not tell what
    quiet = "ignore::UserWarning:multiprocessing.resource_tracker"
    os.environ["PYTHONWARNINGS"] = ",".join(filter(None, (os.getenv("PYTHONWARNINGS"), quiet)))
    signal.signal(signal.SIGINT, stop)


@contextmanager
def stop_kept() -> Iterator[Callable[[], bool]]:
    """Take a first Ctrl-C as a request to stop; the function given tells whether one was made.

    A second one ends the command in one line.
    """
    asked = False

    def ask(number: int, frame: object) -> None:
        nonlocal asked
        asked = True
        os.write(sys.stderr.fileno(), _STOPPING)
        stop_quietly()

    signal.signal(signal.SIGINT, ask)
    try:
        yield lambda: asked
    finally:
        stop_quietly()
