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


def stop_quietly() -> None:
    """Make Ctrl-C end the command with one line; unfinished files are removed."""

    def stop(number: int, frame: object) -> NoReturn:
        os.write(sys.stderr.fileno(), _INTERRUPTED)
        raise SystemExit(130)

    signal.signal(signal.SIGINT, stop)


def stop_at_once(message: bytes = _INTERRUPTED) -> None:
    """Make Ctrl-C end the process with a message, its last, and without any clean-up."""

    def stop(number: int, frame: object) -> NoReturn:
        screen = os.dup(sys.stderr.fileno())
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())  # a bar draws on in a thread
        os.write(screen, message)
        for worker in active_children():
            worker.kill()
        os._exit(130)

    signal.signal(signal.SIGINT, stop)


def stop_solving() -> None:
    """Make Ctrl-C end the command at once: the clean-up of dask may hang, and batches are kept."""
    # a process of multiprocessing's cleans up behind us: it need not tell what
    quiet = "ignore::UserWarning:multiprocessing.resource_tracker"
    os.environ["PYTHONWARNINGS"] = ",".join(filter(None, (os.getenv("PYTHONWARNINGS"), quiet)))
    show_cursor = b"\x1b[?25h\n" if sys.stderr.isatty() else b""
    stop_at_once(show_cursor + b"impactlab: interrupted; the same command goes on from here\n")


@contextmanager
def stop_kept() -> Iterator[Callable[[], bool]]:
    """Take a first Ctrl-C as a request to stop; yields a function that tells whether it came.

    A second one ends the command in one line.
    """
    is_stopping = False

    def ask(number: int, frame: object) -> None:
        nonlocal is_stopping
        is_stopping = True
        os.write(sys.stderr.fileno(), _STOPPING)
        stop_quietly()

    signal.signal(signal.SIGINT, ask)
    try:
        yield lambda: is_stopping
    finally:
        stop_quietly()
