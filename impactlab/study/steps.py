"""Steps of a study, one function each: resolve, solve, refine, analyse, check, tidy up.

The commands parse, call these and print; whatever else runs a study calls them too. Each imports
what it needs: compiler and analysis take seconds to load.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace as changed
from functools import partial
from itertools import chain
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from impactlab.files import (
    check_source,
    checked,
    identity,
    opened,
    read_netcdf,
    write_csv,
    write_netcdf,
)
from impactlab.methods.hypercube import Hypercube
from impactlab.provenance import provenance
from impactlab.study import CALIBRATION, PARTS, REFINEMENT, RESOLUTION, SHARDS, TRIALS
from impactlab.study.ownership import check_unclaimed, same_runs, study_file, write_runs
from impactlab.study.schema.declarations import (
    AnyStudy,
    Auto,
    Declared,
    FunctionStudy,
    ImpactStudy,
    Verification,
)
from impactlab.study.schema.table_file import TableStudy, runs_of_file
from impactlab.study.schema.yaml_file import check_name
from impactlab.validation.errors import StudyError

if TYPE_CHECKING:
    from impactlab.study.engine import Engine
    from impactlab.study.inventory import Status
    from impactlab.verification.finding import Outcome

log = logging.getLogger(__name__)

Tell = Callable[[xr.Dataset], object]


def results_folder(study: str, results: Path = Path("results")) -> Path:
    """Return results/STUDY. Raises ValueError where a study's name or a link leads elsewhere."""
    check_name(study, f"study {study!r}")
    folder = results / study
    for place in (folder, *(folder.iterdir() if folder.is_dir() else ())):
        if place.is_symlink() and not place.resolve().is_relative_to(results.resolve()):
            raise ValueError(
                f"{place}: is a link to {place.resolve()}, outside {results}/: take it out, or say "
                "with --output where the results are to go"
            )
    return folder


def recommend(
    study: ImpactStudy, path: Path, engine: Engine, wishes: Auto | None = None
) -> xr.Dataset:
    """Write to `path` (resolution.nc), and return, the dataset of recommendation.recommend."""
    from impactlab.study.adaptive import recommendation

    recommendations = recommendation.recommend(study, path.with_name(TRIALS), engine, wishes)
    write_netcdf(recommendations, path, "resolution")
    return recommendations


def resolved(
    study: AnyStudy,
    folder: Path,
    engine: Engine | None = None,
    tell: Tell = lambda resolution: None,
) -> AnyStudy | None:
    """Return the study with its discretisation, found by pilot runs where it is `auto`.

    They are solved once, for this very study and these kernels; their evidence is kept in
    resolution.nc in `folder`, and told. Without an engine none is solved: None where one would have
    to be. Raises StudyError where no discretisation meets the tolerance.
    """
    if isinstance(study, FunctionStudy) or study.auto is None:
        return study
    from impactlab.solver.jit import SOURCES_HASH
    from impactlab.study.adaptive.recommendation import apply_recommendation

    file, resolution = folder / RESOLUTION, None
    if file.exists():
        try:
            resolution = read_netcdf(file, "resolution")
        except ValueError as error:
            log.warning("%s; the pilot runs are solved again", error)
    stamps = {"study_sha256": study.sha256, "kernels_sha256": SOURCES_HASH}
    if resolution is None or not stamps.items() <= resolution.attrs.items():
        if engine is None:
            return None
        resolution = recommend(study, file, engine)
    tell(resolution)
    return apply_recommendation(study, resolution)


def run(
    study: AnyStudy | TableStudy,
    path: Path,
    engine: Engine,
    *,
    runs: xr.Dataset | None = None,
    force: bool = False,
    replace: bool = False,
    tell: Tell = lambda resolution: None,
) -> None:
    """Price a study, resolve its discretisation, draw and solve its runs; write them to `path`.

    The rows of a table are its runs. Runs placed for a probability leave rare_event.nc beside
    `path`, those of a slow model multifidelity.nc. runs: its design, where it is drawn already.
    force: whatever it costs. replace: whatever study has results there. tell: of `resolved`.

    Raises StudyError where a limit is exceeded, for wrong measurements, and as `resolved` and
    `solve`; ValueError as `check_unclaimed`.
    """
    from impactlab.study.design import design

    source = study_file(study, path.parent)
    if runs is not None and (file := runs.attrs.get("study_file")):
        study = changed(study, path=study.path.parent / file)
        source = study_file(study, path.parent)
    if not replace:
        check_unclaimed(study, path, source)
    if isinstance(study, TableStudy):
        write_runs(runs_of_file(study).assign_attrs(provenance(), study_file=source), path)
        return
    declared = priced(study, path.parent, engine.workers, force, tell)
    with engine.kept_open() as kept:  # one client for pilots, runs and what is asked of them
        if runs is None:
            runs = design(declared or resolved(study, path.parent, kept, tell) or study)
        solve(runs.assign_attrs(study_file=source), path, kept)
        if isinstance(study.sampling, Hypercube) and study.sampling.until:
            from impactlab.study.rare_event import place_runs

            place_runs(study, path.parent, kept, study.sampling.until)
        if study.multifidelity:
            from impactlab.study.multifidelity import multifidelity

            multifidelity(study, path.parent, kept)


def priced(
    study: AnyStudy, folder: Path, workers: int, force: bool, tell: Tell, parts: int = 0
) -> AnyStudy | None:
    """Return the study as `resolved` does without an engine, after checks of what it costs.

    parts: of which one is solved, in flat memory; 0: all runs are. Raises StudyError where a limit
    is exceeded, and for wrong measurements.
    """
    from impactlab.study.estimate import estimate
    from impactlab.study.schema.measurement_files import read_measurements

    for file in study.measurements if isinstance(study, ImpactStudy) else ():
        read_measurements(file)  # mistakes there are told before hours of runs
    declared = resolved(study, folder, tell=tell)
    cost = estimate(declared or study, folder, workers)
    for problem in cost.implausible:
        log.warning("%s", problem)
    if parts:
        cost = changed(cost, seconds=cost.seconds / parts, memory=0.0, disk=cost.disk / parts)
    if (exceeded := cost.exceeded()) and not force:
        raise StudyError(*exceeded)
    return declared


def solve(samples: xr.Dataset, path: Path, engine: Engine) -> None:
    """Solve the runs of a design that have not been solved yet, and write all to `path` (runs.nc).

    Finished batches stay in shards/ beside it; a growing sample ends with narrow intervals.

    Raises ValueError, OSError and BlockingIOError as execute.open_runs does.
    """
    from impactlab.study.execute import open_runs
    from impactlab.study.store import locked

    shards = path.with_name(SHARDS)
    if "until_interval" in samples.attrs:
        from impactlab.analysis.analyse import analyse
        from impactlab.study.adaptive.extension import extend_sample

        with locked(shards), ExitStack() as last:  # locked over all its stages

            def stage(samples: xr.Dataset) -> xr.Dataset:
                last.close()
                return last.enter_context(open_runs(samples, shards, engine))

            write_runs(extend_sample(samples, stage, analyse), path)
    else:
        with open_runs(samples, shards, engine) as runs:
            write_runs(runs, path)


def status(study: AnyStudy, folder: Path) -> Status | None:
    """Return the progress of a study in its folder of results; nothing is changed there.

    It is that of the stage at which a growing sample stands. None while the discretisation has
    still to be found.
    """
    from impactlab.study.design import design, stages
    from impactlab.study.inventory import status as status_of
    from impactlab.study.solvers import run_shape

    declared, runs = resolved(study, folder), folder / "runs.nc"
    if declared is None:
        return None
    last, written = None, f"{runs}: not written yet"
    if runs.exists():
        with opened(runs, "runs", indexed=False) as dataset:
            attrs, size = dataset.attrs, prod(run_shape(dataset)[1])
        others = "" if same_runs(study, attrs) else " of another study, or of its earlier text"
        written = f"{runs}: {size:,} runs{others}"
        if attrs.get("study_sha256") == declared.sha256 and "until_reason" in attrs:
            last = attrs["base_samples"]  # at which it stopped growing
    for stage in stages(design(declared)):
        status = status_of(stage, folder / SHARDS)
        if status.done < status.runs or stage.attrs.get("base_samples") == last:
            break
    return changed(status, written=written)


@contextmanager
def removable(studies: Path, results: Path) -> Iterator[dict[Path, str]]:
    """Give the files of solved runs that their studies do not ask for any more, and the reasons.

    studies, results: folders of the study files and of their results. No other process works on
    these studies within the context. Raises FileNotFoundError where there are no study files.
    """
    from impactlab.study.store import locked

    if not any(studies.glob("*.yaml")):
        raise FileNotFoundError(f"{studies}: no study files (*.yaml) there: nothing was removed")
    kinds = (SHARDS, TRIALS, REFINEMENT)
    with ExitStack() as locks:
        reasons: dict[Path, str] = {}
        places = {path for kind in kinds for path in results.glob(f"*/{kind}")}
        places |= {lock.parent for lock in results.glob(f"*/{CALIBRATION}/**/lock")}
        for shards in sorted(places):
            locks.enter_context(locked(shards))
            home = results / shards.relative_to(results).parts[0]
            reasons |= _stale(studies / f"{home.name}.yaml", shards, home)
        for parts in sorted(results.glob(f"*/{PARTS}")):
            reasons |= _stale_parts(studies / f"{parts.parent.name}.yaml", parts)
        yield reasons


def _stale(file: Path, shards: Path, home: Path) -> dict[Path, str]:
    """Return a study's files to remove: none where it has no file; home: its folder of results."""
    from impactlab.study.design import design, stages
    from impactlab.study.inventory import removable_files

    if not file.is_file():
        return {}
    if shards != home / SHARDS:
        return removable_files(shards, None)
    declared = _declared_in(file, home)
    return {} if declared is None else removable_files(shards, list(stages(design(declared))))


def _stale_parts(file: Path, parts: Path) -> dict[Path, str]:
    """Return the blocks of parts to remove; those that a process may write now all stay."""
    from impactlab.study.parts import identity

    if not file.is_file() or (declared := _declared_in(file, parts.parent)) is None:
        return {}
    reason, needed = "belongs to another text of the study, or another solver", identity(declared)
    return {path: reason for path in sorted(parts.glob("*/*.npz")) if path.parent.name != needed}


def _declared_in(file: Path, home: Path) -> AnyStudy | None:
    """Return the resolved study of a file; None where its results are another study's."""
    from impactlab.study.schema.readers import read_study

    study = read_study(file)
    try:
        check_unclaimed(study, home / "runs.nc")
    except ValueError:  # the runs are another study's
        return None
    return resolved(study, home)


def refine(runs: Path, path: Path, engine: Engine, base_samples: int | None = None) -> None:
    """Solve the first runs of a Sobol sample on finer grids and write them to `path`."""
    from impactlab.study.adaptive.extension import refine_cases
    from impactlab.study.execute import execute

    with checked(runs, "runs") as solved:
        part = partial(execute, shards_folder=runs.with_name(REFINEMENT), engine=engine)
        write_netcdf(refine_cases(solved, part, base_samples), path, "refinement", solved)


def evidence(study: Declared, runs: Path) -> dict[str, Path]:
    """Return the files beside solved runs on their numerical uncertainty, for `analyse_runs`.

    They hold what pilot runs of `auto`, or `recommend` of this very study, found, and `refine` of
    these very runs.
    """
    evidence = {}
    resolution, refinement = runs.with_name(RESOLUTION), runs.with_name(f"{REFINEMENT}.nc")
    if isinstance(study, ImpactStudy) and resolution.exists():
        with opened(resolution, "resolution") as recommendations:
            made_for = recommendations.attrs.get("study_sha256")
        if study.auto or made_for == study.sha256:
            evidence["resolution"] = resolution
    if refinement.exists():
        with opened(refinement, "refinement") as refined, opened(runs, "runs") as solved:
            if identity(solved) in refined.attrs["made_from"].split():
                evidence["refinement"] = refinement
    return evidence


def analyse_runs(
    runs: Path, path: Path, resolution: Path | None = None, refinement: Path | None = None
) -> xr.Dataset:
    """Analyse solved runs; write the analysis to `path` (analysis.nc), and return it.

    Beside it, for a sample: indices.csv, indices.nc, distribution.csv and surrogate.nc. resolution,
    refinement: evidence on the numerical uncertainty, see analysis.analyse. The study's
    measurements are compared with the runs. The runs stay in their file: memory holds few columns
    of a sample by Sobol. Raises StudyError for wrong measurements.
    """
    from impactlab.analysis import distribution
    from impactlab.analysis.analyse import analyse
    from impactlab.analysis.measurements import compared
    from impactlab.analysis.sensitivity.indices import COLUMNS, sensitivity_variables, table_rows
    from impactlab.analysis.surrogate import packed
    from impactlab.methods.runs import listed
    from impactlab.study.schema.measurement_files import read_measurements

    beside = {"resolution": resolution, "refinement": refinement}
    evidence = {name: read_netcdf(file, name) for name, file in beside.items() if file}
    with checked(runs, "runs") as solved:
        if refinement:
            check_source(evidence["refinement"], refinement, solved, runs)
        sources = solved, *evidence.values()
        analysis = analyse(solved, **evidence)
        if "measurements" in solved.attrs:
            files = listed(solved, "measurements")
            measured = chain.from_iterable(read_measurements(file, solved) for file in files)
            analysis = analysis.merge(compared(solved, analysis, list(measured)))
        if {"slow_model", "until_probability"} & solved.attrs.keys():
            from impactlab.study.multifidelity import question_answer

            analysis.attrs["question_answer"] = question_answer(solved, runs.parent)
        write_netcdf(analysis, path, "analysis", *sources)
        for name in ("indices.csv", "indices.nc", "distribution.csv", "surrogate.nc"):
            path.with_name(name).unlink(missing_ok=True)  # perhaps another study's
        if indices := sensitivity_variables(analysis):
            table = path.with_name("indices.csv")
            write_csv(table_rows(analysis), COLUMNS, table, indices.nbytes)
            write_netcdf(indices, path.with_name("indices.nc"), "indices", *sources)
        if "quantile" in analysis:
            numbers, table = distribution.table_rows(analysis), path.with_name("distribution.csv")
            write_csv(numbers, distribution.COLUMNS, table)
        if surrogates := packed(solved, analysis):
            write_netcdf(surrogates, path.with_name("surrogate.nc"), "surrogate", *sources)
    return analysis


def check(verification: Verification) -> xr.Dataset:
    """Make every check, also after one that ends in an error; return findings.nc."""
    from impactlab.solver.jit import SOURCES_HASH
    from impactlab.study.progress import items_done
    from impactlab.verification.catalogue import CATALOGUE
    from impactlab.verification.outcomes import packed

    outcomes: list[Outcome] = []
    with items_done(len(verification.checks), 0, "checks") as advance:
        for name in verification.checks:
            outcomes.append(CATALOGUE[name].run())
            advance(1, int(outcomes[-1].verdict != "passed"))
    kernels = {"kernels_sha256": SOURCES_HASH}
    return packed(outcomes).assign_attrs(verification.attributes() | provenance() | kernels)


def failure(outcomes: Sequence[Outcome]) -> str:
    """Return a sentence about the checks that failed; "" where none did."""
    reasons = []
    for outcome in outcomes:
        if outcome.verdict == "passed":
            continue
        failed, total = len(outcome.failures), len(outcome.finding.comparisons)
        counted = f"{failed} of {total} comparisons" if total else "it compared nothing"
        reasons.append(f"{outcome.name}: {outcome.reason or counted}")
    message = f"verification failed in {len(reasons)} of {len(outcomes)} checks"
    return f"{message} ({'; '.join(reasons)})" if reasons else ""
