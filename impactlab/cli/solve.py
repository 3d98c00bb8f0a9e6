"""From a study file to solved runs or findings, or in one command to its report."""

from __future__ import annotations

import logging
import os
import re
from dataclasses import replace as replaced
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from impactlab.cli import stop_solving
from impactlab.cli.options import (
    RunsFile,
    StudyFile,
    chosen,
    given,
    new_file,
    stored_in,
    study_or_design,
)
from impactlab.cli.studies import shipped

if TYPE_CHECKING:
    from impactlab.study.schema.declarations import AnyStudy, Declared

Threads = Annotated[int, typer.Option(min=1, help="Threads.")]
Force = Annotated[
    bool, typer.Option("--force", help="Run even if time or memory limits are exceeded.")
]
Replace = Annotated[
    bool, typer.Option("--replace", help="Overwrite the results of another study of this name.")
]
StudyOrDesign = Annotated[
    Path,
    typer.Argument(
        metavar="STUDY",
        help="A study file, its design.nc, or results/NAME.",
        callback=study_or_design,
    ),
]
_ALL = os.cpu_count() or 1


def recommend(
    study: StudyFile,
    tolerance: Annotated[
        str,
        typer.Option(
            help="Numerical uncertainty that is good enough, such as '0.5 %'. Default: the "
            "study's, or 1 %."
        ),
    ] = "",
    responses: Annotated[
        str,
        typer.Option(
            help="Responses it applies to, such as peak_force,impulse. Default: the study's."
        ),
    ] = "",
    output: Annotated[
        Path | None, new_file(".nc", help="Default: results/NAME/resolution.nc.")
    ] = None,
    workers: Threads = _ALL,
) -> None:
    """Find the cheapest discretisation that is fine enough.

    The study's corner cases are solved with finer and finer discretisations; the file keeps the
    evidence.
    """
    from impactlab.report.console import print_recommendation
    from impactlab.study import RESOLUTION, steps
    from impactlab.study.adaptive.recommendation import recommended_grid
    from impactlab.study.engine import Engine
    from impactlab.study.ownership import check_unclaimed
    from impactlab.study.schema.declarations import Auto
    from impactlab.study.schema.readers import read_impacts

    declared = read_impacts(study)
    path = output or steps.results_folder(declared.name) / RESOLUTION
    stop_solving()
    check_unclaimed(declared, path.with_name("runs.nc"))
    wishes = declared.auto or Auto()
    if tolerance:
        limit = given("--tolerance", tolerance, "1")
        if not 0 < limit < 1:
            raise ValueError(f"--tolerance = {tolerance!r}: must lie between 0 and 100 %")
        wishes = wishes.model_copy(update={"tolerance": limit})
    if names := chosen("--responses", responses, declared.responses):
        wishes = wishes.model_copy(update={"responses": names})
    evidence = steps.recommend(declared, path, Engine("threads", workers), wishes)
    print_recommendation(evidence)
    if grid := recommended_grid(evidence, declared.discretisation):
        names = ("nodes", "points", "rule", "scheme", "courant")
        keys = ", ".join(f"{name}: {getattr(grid, name)}" for name in names)
        print(f"To paste into {study}:\n\ndiscretisation: {{{keys}}}")


def design(
    study: StudyFile,
    output: Annotated[Path | None, new_file(".nc", help="Default: results/NAME/design.nc.")] = None,
    workers: Threads = _ALL,
) -> None:
    """Sample a study into its runs.

    An `auto` discretisation is determined first, as by `impactlab recommend`.
    """
    from impactlab.files import write_netcdf
    from impactlab.report.console import print_recommendation
    from impactlab.study import steps
    from impactlab.study.design import design as design_of
    from impactlab.study.engine import Engine
    from impactlab.study.ownership import check_unclaimed, study_file
    from impactlab.study.schema.readers import read_study

    declared = read_study(study)
    path = output or steps.results_folder(declared.name) / "design.nc"
    stop_solving()
    check_unclaimed(declared, path.with_name("runs.nc"))
    engine = Engine(workers=workers)
    resolved = steps.resolved(declared, path.parent, engine, print_recommendation)
    dataset = design_of(resolved or declared)
    file = study_file(declared, path.parent)
    write_netcdf(dataset.assign_attrs(study_file=file), path, "design")


def run(
    design_file: StudyOrDesign,
    output: Annotated[Path | None, new_file(".nc", help="Default: results/NAME/runs.nc.")] = None,
    workers: Annotated[int, typer.Option(min=1, help="Threads or processes.")] = _ALL,
    processes: Annotated[bool, typer.Option("--processes", help="Processes, not threads.")] = False,
    scheduler: Annotated[str, typer.Option(help="Address of a running dask scheduler.")] = "",
    cluster: Annotated[
        Path | None, typer.Option(help="Profile of Slurm jobs to start; see profiles/slurm.")
    ] = None,
    batch_seconds: Annotated[
        float,
        typer.Option(min=0.001, help="Target task duration; increase for hundreds of threads."),
    ] = 2.0,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print the cost estimate and exit.")
    ] = False,
    part: Annotated[
        str, typer.Option(help="Solve this part alone, such as 3/40, for `impactlab merge`.")
    ] = "",
    to: Annotated[
        str, typer.Option(help="Folder or URL of parts, as s3://... Default: results/NAME/parts.")
    ] = "",
    force: Force = False,
    replace: Replace = False,
) -> None:
    """Solve the runs of a study that have not been solved yet.

    Finished batches are kept in results/NAME/shards: an interrupted study resumes there. With
    --part, each process solves a part by itself, needs no other, and resumes its own part.
    """
    stop_solving()
    if part or to:
        if not part or output or scheduler or cluster or processes or dry_run:
            raise ValueError(
                "--part: goes with --workers, --to, --force and --replace alone, and --to with it"
            )
        _run_part(design_file, _part(part), to, workers, force=force, replace=replace)
        return
    from impactlab.files import read_netcdf
    from impactlab.report.console import print_estimate, print_recommendation, print_solved
    from impactlab.study import steps
    from impactlab.study.design import study_of_design
    from impactlab.study.engine import Engine, read_profile
    from impactlab.study.estimate import estimate
    from impactlab.study.schema.readers import read_runs, read_study

    stored = read_netcdf(design_file, "design") if design_file.suffix == ".nc" else None
    read: Any = read_study if dry_run else read_runs
    study = read(design_file) if stored is None else study_of_design(stored, design_file)
    path = output or steps.results_folder(study.name) / "runs.nc"
    if dry_run:
        cost = estimate(steps.resolved(study, path.parent) or study, path.parent, workers)
        for problem in cost.implausible:
            logging.getLogger("impactlab").warning("%s", problem)
        print_estimate(cost, workers)
        return
    profile = read_profile(cluster) if cluster else None
    engine = Engine(
        "processes" if processes else "threads", workers, scheduler, profile, batch_seconds
    )
    options = {"force": force, "replace": replace}
    steps.run(study, path, engine, runs=stored, tell=print_recommendation, **options)
    print_solved(path)


def _part(text: str) -> tuple[int, int]:
    """Return number and total of a part. Raises ValueError for any other text."""
    match = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text)
    number, total = map(int, match.groups()) if match else (0, 0)
    if not 1 <= number <= total:
        raise ValueError(f"--part = {text!r}: write NUMBER/PARTS, from 1/40 to 40/40 of 40 parts")
    return number, total


def _study_of(file: Path) -> AnyStudy:
    """Return the study in its file or in a design, whose runs are not read."""
    from impactlab.files import opened
    from impactlab.study.design import study_of_design
    from impactlab.study.schema.readers import read_study

    if file.suffix != ".nc":
        return read_study(file)
    with opened(file, "design", indexed=False) as stored:
        study = study_of_design(stored, file)
        return replaced(study, path=file.parent / str(stored.attrs.get("study_file") or file.name))


def _run_part(file: Path, part: tuple[int, int], place: str, workers: int, **options: bool) -> None:
    from impactlab.report.console import print_recommendation
    from impactlab.study import parts, steps

    study = _study_of(file)
    folder = steps.results_folder(study.name)
    parts.run_part(study, folder, part, workers, place, tell=print_recommendation, **options)


def merge(
    design_file: StudyOrDesign,
    output: Annotated[Path | None, new_file(".nc", help="Default: results/NAME/runs.nc.")] = None,
    place: Annotated[
        str, typer.Option("--from", help="Folder or URL of parts. Default: results/NAME/parts.")
    ] = "",
    replace: Replace = False,
) -> None:
    """Put the parts of a study together.

    Names the parts that are missing or damaged; otherwise writes the runs.nc of one process.
    """
    from impactlab.report.console import print_solved
    from impactlab.study import parts, steps

    study = _study_of(design_file)
    path = output or steps.results_folder(study.name) / "runs.nc"
    parts.merge(study, path, place, replace=replace)
    print_solved(path)


def refine(
    runs: RunsFile,
    output: Annotated[
        Path | None, new_file(".nc", help="Default: refinement.nc, beside the runs.")
    ] = None,
    base_samples: Annotated[
        int | None,
        typer.Option(min=16, help="Base samples to solve again. Default: N/8, from 16 to 64."),
    ] = None,
    workers: Threads = _ALL,
) -> None:
    """Solve the first runs of a Sobol sample on finer grids.

    `impactlab analyse --refinement` estimates the numerical error of the indices from them; more
    base samples narrow the estimate.
    """
    stop_solving()
    from impactlab.study import steps
    from impactlab.study.engine import Engine

    path = output or runs.with_name("refinement.nc")
    steps.refine(runs, path, Engine("threads", workers), base_samples)


def verify(
    study: Annotated[
        Path,
        typer.Argument(
            metavar="STUDY",
            help="A study file of checks, its findings.nc, or results/NAME.",
            callback=stored_in("findings.nc"),
            default_factory=lambda: shipped("studies/verification.yaml"),
            show_default="every check",
        ),
    ],
    output: Annotated[
        Path | None, new_file(".nc", help="Default: results/NAME/findings.nc.")
    ] = None,
    exit_zero: Annotated[
        bool, typer.Option("--exit-zero", help="Exit with code 0 even if checks fail.")
    ] = False,
    replace: Replace = False,
) -> None:
    """Compare the solver with independent solutions.

    The exit code is 1 where any check fails; the findings are written either way. For a
    findings.nc, the command prints its verdict again.
    """
    from impactlab.files import read_netcdf, write_netcdf
    from impactlab.report.answer import answers
    from impactlab.report.console import print_outcomes
    from impactlab.study import steps
    from impactlab.study.ownership import check_unclaimed, study_file
    from impactlab.study.schema.readers import read_verification
    from impactlab.verification.outcomes import unpacked

    if study.suffix == ".nc":
        findings = read_netcdf(study, "findings")
    else:
        declared = read_verification(study)
        path = output or steps.results_folder(declared.name) / "findings.nc"
        if not replace:
            check_unclaimed(declared, path)
        file = study_file(declared, path.parent)
        findings = steps.check(declared).assign_attrs(study_file=file, content="findings")
        write_netcdf(findings, path, "findings")
        print(f"{path}: {answers(findings)[0]}")
    outcomes = unpacked(findings)
    print_outcomes(outcomes)
    if failure := steps.failure(outcomes):
        logging.getLogger("impactlab").error("%s", failure)
        raise typer.Exit(code=0 if exit_zero else 1)


def go(
    study: StudyFile,
    workers: Threads = _ALL,
    force: Force = False,
    replace: Replace = False,
    only: Annotated[
        str,
        typer.Option(
            help="'solve': up to runs.nc, refinement.nc or findings.nc. 'report': from there on."
        ),
    ] = "",
) -> None:
    """Run, analyse, draw, report and index one study.

    For a verification: verify, figures, report and index. Solved runs are not solved again. --only
    does one half of it, for workflows, and no index: `solve` leaves design.nc, and of a sample
    resolution.nc, too.
    """
    from impactlab.cli import results
    from impactlab.study import steps
    from impactlab.study.schema.declarations import Verification
    from impactlab.study.schema.readers import read_any

    if only not in ("", "solve", "report"):
        raise ValueError(f"--only = {only!r}: must be 'solve' or 'report'")
    declared = read_any(study)
    folder = steps.results_folder(declared.name)
    names = ["runs.nc", "analysis.nc"]
    if isinstance(declared, Verification):
        names = ["findings.nc"]
    stored = [folder / name for name in names]
    failed = False
    if only != "report":
        try:
            _solve(study, declared, bool(only), workers=workers, force=force, replace=replace)
        except typer.Exit:  # the report comes first, the verdict last
            failed = True
    if only != "solve":
        if not isinstance(declared, Verification):
            results.analyse(stored[0], **steps.evidence(declared, stored[0]))
        results.figures(stored)
        results.report(stored)
    if not only:
        results.index()
    if failed:
        raise typer.Exit(code=1)


def _solve(
    study: Path, declared: Declared, stepwise: bool, *, workers: int, force: bool, replace: bool
) -> None:
    """Verify, or solve what a report is made from; stepwise: keep the file of each step."""
    from impactlab.methods.sampling import RandomSample
    from impactlab.methods.sobol import Sobol
    from impactlab.study import steps
    from impactlab.study.schema.declarations import ImpactStudy, StudyBase, Verification

    if isinstance(declared, Verification):
        verify(study, replace=replace)
        return
    folder = steps.results_folder(declared.name)
    sampling = declared.sampling if isinstance(declared, ImpactStudy) else None
    stepwise = stepwise and isinstance(declared, StudyBase)
    if stepwise:
        if isinstance(sampling, RandomSample):
            recommend(study, workers=workers)
        design(study, workers=workers)
    source = folder / "design.nc" if stepwise else study
    run(source, workers=workers, force=force, replace=replace)
    if isinstance(sampling, Sobol):
        refine(folder / "runs.nc", workers=workers)
