"""The progress of a study."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import RESULTS, StudyFile


def status(
    study: StudyFile,
    results: Annotated[Path, typer.Option(help="Where results land.")] = RESULTS,
) -> None:
    """Show the progress of a study: runs solved, failed and left.

    Changes nothing; the study may be running.
    """
    from impactlab.report.console import print_status
    from impactlab.study import SHARDS
    from impactlab.study.runs import status as status_of
    from impactlab.study.sampling.design import design
    from impactlab.study.sampling.doubling import stages
    from impactlab.study.schema.files import read_study
    from impactlab.study.steps import resolved_before

    folder = results / study.stem
    declared = resolved_before(read_study(study), folder)
    if declared is None:
        print(f"{study.stem}: its discretisation is auto and was not found yet: nothing is solved")
        return
    last = _last_samples(folder / "runs.nc", declared.sha256)
    for stage in stages(design(declared)):
        found = status_of(stage, folder / SHARDS)
        if found.done < found.runs or stage.attrs.get("base_samples") == last:
            break
    print_status(study.stem, found)


def _last_samples(runs: Path, study_sha256: str) -> int | None:
    """Return the base samples at which this sample stopped growing; None if it still may."""
    from impactlab.study.netcdf import read_attributes

    attrs = read_attributes(runs) if runs.exists() else {}
    ceased = attrs.get("study_sha256") == study_sha256 and "until_reason" in attrs
    return int(attrs["base_samples"]) if ceased else None
