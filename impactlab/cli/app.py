"""The command `impactlab`: its commands and its log."""

import logging
import warnings
from pathlib import Path
from pkgutil import resolve_name
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from impactlab import wings
from impactlab.cli import stop_quietly

_COMMANDS = {
    "simulate": "impactlab.cli.simulate:simulate",
    "go": "impactlab.cli.solve:go",
    "new": "impactlab.cli.studies:new",
    "studies": "impactlab.cli.studies:studies",
    "recommend": "impactlab.cli.solve:recommend",
    "design": "impactlab.cli.solve:design",
    "run": "impactlab.cli.solve:run",
    "merge": "impactlab.cli.solve:merge",
    "refine": "impactlab.cli.solve:refine",
    "status": "impactlab.cli.studies:status",
    "analyse": "impactlab.cli.results:analyse",
    "predict": "impactlab.cli.results:predict",
    "calibrate": "impactlab.cli.results:calibrate",
    "rare": "impactlab.cli.questions:rare",
    "size": "impactlab.cli.questions:size",
    "multifidelity": "impactlab.cli.questions:multifidelity",
    "verify": "impactlab.cli.solve:verify",
    "figures": "impactlab.cli.results:figures",
    "animate": "impactlab.cli.results:animate",
    "report": "impactlab.cli.results:report",
    "compare": "impactlab.cli.results:compare",
    "export": "impactlab.cli.results:export",
    "index": "impactlab.cli.results:index",
    "schema": "impactlab.cli.studies:schema",
    "clean": "impactlab.cli.studies:clean",
    "compile": "impactlab.cli.simulate:compile_kernels",
} | wings.commands()
"""Module and function by name, in the order of the help."""
_HELP = {"help_option_names": ["-h", "--help"]}


class _Commands(TyperGroup):
    """The commands, each imported when it is called or when help is asked for."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names in the order of the help."""
        return list(_COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command, or None where there is none of this name."""
        if cmd_name not in _COMMANDS:
            if not cmd_name.startswith("-"):
                from impactlab.model.checks import did_you_mean  # late: it loads numpy

                ctx.fail(f"there is no command {cmd_name!r}{did_you_mean(cmd_name, _COMMANDS)}")
            return None
        alone = typer.Typer(rich_markup_mode=None, add_completion=False)
        alone.command(cmd_name, context_settings=_HELP)(resolve_name(_COMMANDS[cmd_name]))
        return typer.main.get_command(alone)


app = typer.Typer(
    name="impactlab",
    cls=_Commands,
    help="A sphere strikes an elastic-plastic beam: from a study file to a report.",
    no_args_is_help=True,
    context_settings=_HELP,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help: boxes and colours take twice as long
    add_completion=False,
)


def _version(requested: bool) -> None:
    if requested:
        from importlib.metadata import version

        print(f"impactlab {version('impactlab')}")
        raise typer.Exit


@app.callback()
def configure(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    log: Annotated[Path | None, typer.Option(help="Write messages to this file as well.")] = None,
    debug: Annotated[bool, typer.Option(help="Log details, including where errors occur.")] = False,
) -> None:
    """Set up logging, warnings and Ctrl-C for every command."""
    stop_quietly()
    logger = logging.getLogger("impactlab")
    logger.setLevel(logging.DEBUG if debug else logging.INFO)
    form = logging.Formatter("%(levelname)s: %(message)s")
    logger.handlers[:] = [logging.StreamHandler()]
    logger.handlers[0].setFormatter(form)
    if log:
        log.parent.mkdir(parents=True, exist_ok=True)
        logger.addHandler(logging.FileHandler(log, mode="w"))
        logger.handlers[1].setFormatter(form)
    warnings.showwarning = lambda message, *_, **__: logger.warning("%s", message)
