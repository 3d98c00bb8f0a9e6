"""What Ctrl-C does."""

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
    """From here on, Ctrl-C ends the process: nothing is begun, and imports lose exceptions."""
    signal.signal(signal.SIGINT, _stop_without_more)


def stopped() -> None:
    """From here on, Ctrl-C does nothing: the process ends by itself, its work done or put away."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def stop_quietly() -> None:
    """From here on, Ctrl-C ends the command in one line; what is half done is put away."""
    signal.signal(signal.SIGINT, _stop)


def stop_at_once() -> None:
    """From here on, Ctrl-C ends the command without its clean-up: dask's own may hang.

    Finished batches are on disk.
    """
    # a process of multiprocessing's cleans up behind us: it need not tell what
    quiet = "ignore::UserWarning:multiprocessing.resource_tracker"
    os.environ["PYTHONWARNINGS"] = ",".join(filter(None, (os.getenv("PYTHONWARNINGS"), quiet)))
    signal.signal(signal.SIGINT, _stop_at_once)


@contextmanager
def stop_kept() -> Iterator[Callable[[], bool]]:
    """Within, a first Ctrl-C only asks to stop, and what is given tells whether it was asked.

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


def _stop_without_more(number: int, frame: object) -> NoReturn:
    os.write(sys.stderr.fileno(), _INTERRUPTED)
    os._exit(130)


def _stop(number: int, frame: object) -> NoReturn:
    os.write(sys.stderr.fileno(), _INTERRUPTED)
    raise SystemExit(130)


def _stop_at_once(number: int, frame: object) -> NoReturn:
    show_cursor = "\x1b[?25h\n" if sys.stderr.isatty() else ""
    message = f"{show_cursor}impactlab: interrupted; the same command goes on from here\n"
    os.write(sys.stderr.fileno(), message.encode())
    for worker in active_children():
        worker.kill()
    os._exit(130)
