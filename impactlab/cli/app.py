"""The command `impactlab`: its commands, its log, and how it ends."""

from __future__ import annotations

import gc
import logging
import sys
from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.analyse import analyse
from impactlab.cli.clean import clean
from impactlab.cli.design import design
from impactlab.cli.figures import figures
from impactlab.cli.index import index
from impactlab.cli.interrupt import stop_quietly
from impactlab.cli.paper import paper
from impactlab.cli.predict import predict
from impactlab.cli.recommend import recommend
from impactlab.cli.refine import refine
from impactlab.cli.report import report
from impactlab.cli.run import run
from impactlab.cli.simulate import simulate
from impactlab.cli.status import status
from impactlab.cli.studies import studies
from impactlab.cli.verify import verify
from impactlab.cli.witness import witness

_COMMANDS = (
    simulate,
    studies,
    recommend,
    design,
    run,
    refine,
    status,
    analyse,
    predict,
    verify,
    figures,
    report,
    paper,
    witness,
    index,
    clean,
)
"""In the order of the help; a new one is a file and a line here."""

app = typer.Typer(
    name="impactlab",
    help="A sphere strikes an elastic-plastic beam: from a study file to a report.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help: boxes and colours take twice as long
    add_completion=False,
)


def main() -> None:
    """Run the command line; a user's mistake ends in one message and exit code 1."""
    gc.set_threshold(100_000)  # loading modules makes many objects, but no rubbish
    try:
        app()
    except (ValueError, OSError) as error:
        from impactlab.study.errors import printable

        logger = logging.getLogger("impactlab")
        logger.error("%s", "\n".join(map(printable, str(error).split("\n"))))
        logger.debug("it came from here", exc_info=True)
        sys.exit(1)


@app.callback()
def configure(
    log: Annotated[Path | None, typer.Option(help="Write messages to this file as well.")] = None,
    debug: Annotated[
        bool, typer.Option(help="Log details, the place of an error included.")
    ] = False,
) -> None:
    """Set up logging and Ctrl-C for every command."""
    stop_quietly()
    logger = logging.getLogger("impactlab")
    logger.setLevel(logging.DEBUG if debug else logging.INFO)
    handlers: list[logging.Handler] = [logging.StreamHandler()]
    if log:
        log.parent.mkdir(parents=True, exist_ok=True)
        handlers.append(logging.FileHandler(log, mode="w"))
    logger.handlers[:] = handlers
    for handler in handlers:
        handler.setFormatter(logging.Formatter("%(levelname)s: %(message)s"))


for _command in _COMMANDS:
    app.command()(_command)
