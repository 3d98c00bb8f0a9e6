"""The command that answers the paper."""

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import RESULTS, new_folder


def paper(
    folders: Annotated[
        list[Path],
        typer.Argument(metavar="RESULTS...", help="results/NAME of each study of the paper."),
    ],
    output: Annotated[Path, new_folder(help="The folder to write to.")] = RESULTS / "paper",
) -> None:
    """Draw the paper's figures and test its statements.

    A missing study leaves its figures out and its statements unjudged.
    """
    from impactlab.paper.claims import write_paper

    write_paper(folders, output)
