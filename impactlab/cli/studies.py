"""Study files, and their runs on disk."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import RESULTS, StudyFile

Folder = Annotated[Path, typer.Argument(help="Where the study files lie.")]
Results = Annotated[Path, typer.Option(help="Where results land.")]


def studies(
    folder: Folder = Path("studies"),
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

        from impactlab.study.schema.files import describe

        print(json.dumps([describe(path) for path in files], indent=1))
        return
    from impactlab.report.console import print_studies
    from impactlab.study.schema.files import read_any

    read = [read_any(path) for path in files]
    print_studies((study.name, study.size, study.title) for study in read)


def status(study: StudyFile, results: Results = RESULTS) -> None:
    """Show the progress of a study: runs solved, failed and left.

    Changes nothing; the study may be running.
    """
    from impactlab.report.console import print_status
    from impactlab.study import steps
    from impactlab.study.schema.files import read_study

    found = steps.status(read_study(study), results / study.stem)
    if found is None:
        print(f"{study.stem}: its discretisation is auto and was not found yet: nothing is solved")
    else:
        print_status(study.stem, found)


def clean(
    folder: Folder = Path("studies"),
    results: Results = RESULTS,
    yes: Annotated[bool, typer.Option("--yes", help="Remove without asking.")] = False,
) -> None:
    """Remove solved runs that no study asks for any more.

    Asks first. Runs that a changed study still needs stay, and so do runs.nc and the reports.
    """
    from impactlab.report.console import print_files
    from impactlab.study.steps import removable

    with removable(folder, results) as found:
        if not found:
            print("Nothing to remove: every shard is asked for.")
            return
        print_files(found)
        if yes or typer.confirm("Remove these files?"):
            for path in found:
                path.unlink()
