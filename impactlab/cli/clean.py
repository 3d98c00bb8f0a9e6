"""Shards that no study asks for any more."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import RESULTS
from impactlab.study import REFINEMENT, SHARDS, TRIALS


def clean(
    folder: Annotated[Path, typer.Argument(help="Where the study files lie.")] = Path("studies"),
    results: Annotated[Path, typer.Option(help="Where results land.")] = RESULTS,
    yes: Annotated[bool, typer.Option("--yes", help="Remove without asking.")] = False,
) -> None:
    """Remove solved runs that no study asks for any more.

    Asks first. Runs that a changed study still needs stay, and so do runs.nc and the reports.
    """
    from contextlib import ExitStack

    from impactlab.report.console import print_files
    from impactlab.study.store import locked

    if not any(folder.glob("*.yaml")):
        raise FileNotFoundError(f"{folder}: no study files (*.yaml) there: nothing was removed")
    with ExitStack() as locks:
        found: dict[Path, str] = {}
        for shards in _folders(results):
            locks.enter_context(locked(shards))
            found |= _stale(_study_of(shards, folder), shards)
        if not found:
            print("Nothing to remove: every shard is asked for.")
            return
        print_files(found)
        if yes or typer.confirm("Remove these files?"):
            for path in found:
                path.unlink()


def _folders(results: Path) -> list[Path]:
    return sorted(
        path for kind in (SHARDS, TRIALS, REFINEMENT) for path in results.glob(f"*/{kind}")
    )


def _study_of(shards: Path, folder: Path) -> Path | None:
    """Return the study file, in the folder or where its runs were solved from; else None."""
    from impactlab.study.runs import noted_study

    file = folder / f"{shards.parent.name}.yaml"
    return file if file.exists() else noted_study(shards.with_name(SHARDS))


def _stale(file: Path | None, shards: Path) -> dict[Path, str]:
    """Return the shards of one study to remove; none while its discretisation is to be found."""
    from impactlab.study.runs import outdated, stale
    from impactlab.study.sampling.design import design
    from impactlab.study.sampling.doubling import stages
    from impactlab.study.schema.files import read_study
    from impactlab.study.steps import resolved_before

    if file is None:
        return stale(shards, ())
    if shards.name != SHARDS:
        return outdated(shards)
    declared = resolved_before(read_study(file), shards.parent)
    return {} if declared is None else stale(shards, list(stages(design(declared))))
