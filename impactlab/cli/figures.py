"""The figures of stored results."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import StoredFiles


def figures(
    stored: StoredFiles,
    output: Annotated[
        Path | None, typer.Option(help="Default: figures/ beside the first of them.")
    ] = None,
) -> None:
    """Draw every figure that a study's answers, or findings, allow."""
    from impactlab.report.results import read_stored

    kind, datasets = read_stored(stored)
    kind.draw(*datasets, output or stored[0].with_name("figures"))
