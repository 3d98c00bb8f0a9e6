"""The study files of a folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def studies(
    folder: Annotated[Path, typer.Argument(help="Folder of the study files.")] = Path("studies"),
    as_json: Annotated[
        bool, typer.Option("--json", help="Print JSON, with what a workflow needs to know.")
    ] = False,
) -> None:
    """List a folder's studies with their number of runs or checks."""
    files = sorted(folder.glob("*.yaml"))
    if not files:
        raise FileNotFoundError(f"{folder}: no study files (*.yaml) there")
    if as_json:
        import json

        from impactlab.study.description import describe

        print(json.dumps([describe(path) for path in files], indent=1))
        return
    from impactlab.report.console import print_studies
    from impactlab.study.schema.files import read_any

    read = [read_any(path) for path in files]
    print_studies((study.name, study.size, study.title) for study in read)
