"""The page that lists all reports."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import RESULTS


def index(
    results: Annotated[Path, typer.Argument(help="Folder of results.")] = RESULTS,
    output: Annotated[Path | None, typer.Option(help="Default: index.html in it.")] = None,
) -> None:
    """Write the index over all reports."""
    from impactlab.report.results import write_index

    write_index(results, output or results / "index.html")
