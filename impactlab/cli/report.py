"""The report of stored results."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import StoredFiles


def report(
    stored: StoredFiles,
    figures: Annotated[
        Path | None, typer.Option(help="Default: figures/ beside the first of them.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Default: report.html beside the first of them.")
    ] = None,
) -> None:
    """Write a study's report."""
    from impactlab.report.results import read_stored

    kind, datasets = read_stored(stored)
    kind.write(
        *datasets,
        figures or stored[0].with_name("figures"),
        output or stored[0].with_name("report.html"),
    )
