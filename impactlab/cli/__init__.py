"""The command line: each command parses, calls one function and prints; Ctrl-C ends it cleanly.

Heavy imports wait until a command needs them.
"""

import errno
import gc
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import active_children
from pathlib import Path
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


def main() -> None:
    """Run the command line; a user's mistake ends in one message and exit code 1."""
    stop_at_once()  # nothing has begun, and imports swallow exceptions
    import logging

    from impactlab.cli.app import app

    gc.set_threshold(100_000)  # loading modules makes many objects, but no rubbish
    try:
        app()
    except (ValueError, OSError) as error:
        from impactlab.validation.errors import printable

        logger = logging.getLogger("impactlab")
        logger.error("%s", "\n".join(map(printable, _message(error).split("\n"))))
        logger.debug("it came from here", exc_info=True)
        sys.exit(1)
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process is about to end by itself


def _message(error: Exception) -> str:
    """Return the text of an error, with a remedy where a file or folder is not accessible."""
    refusals = (errno.EACCES, errno.EPERM, errno.EROFS)
    if not isinstance(error, OSError) or error.errno not in refusals or not error.filename:
        return str(error)
    return (
        f"{Path(error.filename).absolute()}: {error.strerror}: results are written "
        "where the command runs, so run it in a folder that you may write to (a copy of studies/ "
        "is enough), or change the permissions of this one"
    )
