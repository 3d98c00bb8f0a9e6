"""The command line: each command parses, calls one function and prints.

Heavy imports wait until a command needs them.
"""

import errno
import gc
import signal
import sys
from pathlib import Path

from impactlab.cli.interrupt import stop_at_once


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
