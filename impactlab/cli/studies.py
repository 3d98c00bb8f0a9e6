"""The study files of a folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def studies(
    folder: Annotated[Path, typer.Argument(help="Where the study files lie.")] = Path("studies"),
) -> None:
    """List a folder's studies with their number of runs or checks."""
    from impactlab.report.console import print_studies
    from impactlab.study.declaration import read_any

    files = sorted(folder.glob("*.yaml"))
    if not files:
        raise FileNotFoundError(f"{folder}: no study files (*.yaml) there")
    read = [read_any(path) for path in files]
    print_studies((study.name, study.size, study.title) for study in read)
