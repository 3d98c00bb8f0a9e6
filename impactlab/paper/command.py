"""The answer to the paper."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import RESULTS


def paper(
    folders: Annotated[
        list[Path],
        typer.Argument(metavar="RESULTS...", help="results/NAME of each study of the paper."),
    ],
    output: Annotated[Path, typer.Option(help="A folder.")] = RESULTS / "paper",
) -> None:
    """Answer the paper: its figures, its statements tested.

    A study that is not there leaves its figures out, and its statements unjudged.
    """
    from impactlab.paper.answer import read_solved, write_paper

    write_paper(read_solved(folders), output)
