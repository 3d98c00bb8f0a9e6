"""The steps of a study, one function each: price, resolve, solve, refine, analyse.

The commands parse, call these and print; whatever else runs a study calls them too. Each imports
what it needs: compiler and analysis take seconds to load.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from impactlab.files import replaced
from impactlab.study import REFINEMENT, RESOLUTION, SHARDS, TRIALS
from impactlab.study.netcdf import read_netcdf, write_netcdf
from impactlab.study.schema.study import FunctionStudy, Study

if TYPE_CHECKING:
    from impactlab.study.engine import Engine
    from impactlab.study.errors import Problem
    from impactlab.study.estimate import Estimate

AnyStudy = Study | FunctionStudy


@dataclass(frozen=True)
class Price:
    """The price of a study, and whether it may run.

    cost: time, memory and disk. free: bytes of disk that it may take. exceeded: the limits that it
    exceeds. implausible: values that are possible but improbable.
    """

    cost: Estimate
    free: float
    exceeded: list[Problem]
    implausible: list[Problem]


def price(study: AnyStudy, folder: Path, workers: int) -> Price:
    """Return the price of a study whose results go to `folder`, on so many workers.

    Raises StudyError where a run that the price rests on is impossible.
    """
    from impactlab.study.estimate import estimate, exceeded_limits, free_disk, implausible

    study = resolved_before(study, folder) or study
    cost = estimate(study, workers)
    return Price(cost, free_disk(folder), exceeded_limits(cost, folder), implausible(study))


def find_resolution(study: AnyStudy, folder: Path, engine: Engine) -> xr.Dataset | None:
    """Return what pilot runs say of a discretisation that is `auto`; None where it is stated.

    They are solved once, and their evidence is kept in resolution.nc in `folder`.
    """
    if isinstance(study, FunctionStudy) or study.auto is None:
        return None
    found = _kept(study, folder / RESOLUTION)
    if found is None:
        from impactlab.study.adaptive.recommendation import recommend

        found = recommend(study, folder / TRIALS, engine)
        write_netcdf(found, folder / RESOLUTION)
    return found


def apply_resolution(study: AnyStudy, found: xr.Dataset | None) -> AnyStudy:
    """Return the study with the discretisation that `find_resolution` found.

    Raises StudyError where none meets the tolerance.
    """
    if found is None or isinstance(study, FunctionStudy):
        return study
    from impactlab.study.adaptive.recommendation import apply_recommendation

    return apply_recommendation(study, found)


def resolved_before(study: AnyStudy, folder: Path) -> AnyStudy | None:
    """Return the study with its discretisation; None where pilot runs have still to find it."""
    if isinstance(study, FunctionStudy) or study.auto is None:
        return study
    found = _kept(study, folder / RESOLUTION)
    return None if found is None else apply_resolution(study, found)


def solve(samples: xr.Dataset, path: Path, engine: Engine, file: Path | None = None) -> None:
    """Solve the runs of a design that have not been solved yet, and write all to `path` (runs.nc).

    Finished batches are kept in shards/ beside it. A sample that grows is solved until its
    intervals are narrow enough. file: the study file, noted beside the shards.

    Raises ValueError, OSError and BlockingIOError as execute.executed does.
    """
    from impactlab.study.execute import execute, executed
    from impactlab.study.runs import note_study
    from impactlab.study.store import locked

    shards = path.with_name(SHARDS)
    if file is not None:
        note_study(shards, file)
    if "until_interval" in samples.attrs:
        from impactlab.analysis.analyse import analyse
        from impactlab.study.adaptive.extending import extended

        stage = partial(execute, shards_folder=shards, engine=engine)
        with locked(shards):  # over all its stages
            write_netcdf(extended(samples, stage, analyse), path)
    else:
        with executed(samples, shards, engine) as runs:
            write_netcdf(runs, path)


def refine(runs: Path, path: Path, engine: Engine, base_samples: int | None = None) -> None:
    """Solve the first runs of a Sobol sample on finer grids and write them to `path`."""
    from impactlab.study.adaptive.refining import refined
    from impactlab.study.execute import execute

    part = partial(execute, shards_folder=runs.with_name(REFINEMENT), engine=engine)
    write_netcdf(refined(read_netcdf(runs), part, base_samples), path)


def analyse_runs(
    runs: Path, path: Path, resolution: Path | None = None, refinement: Path | None = None
) -> None:
    """Analyse solved runs and write the analysis to `path` (analysis.nc).

    Beside it, for a sample: indices.csv, indices.nc and surrogate.nc. resolution, refinement:
    evidence on the numerical uncertainty, see analysis.analyse.
    """
    from impactlab.analysis.analyse import analyse
    from impactlab.analysis.sensitivity.indices import sensitivity_variables, write_csv
    from impactlab.analysis.surrogate import packed

    solved = read_netcdf(runs)
    evidence = [read_netcdf(each) if each else None for each in (resolution, refinement)]
    found = analyse(solved, *evidence)
    write_netcdf(found, path)
    for name in ("indices.csv", "indices.nc", "surrogate.nc"):  # perhaps another study's
        path.with_name(name).unlink(missing_ok=True)
    if indices := sensitivity_variables(found):
        with replaced(path.with_name("indices.csv"), indices.nbytes) as unfinished:
            write_csv(found, unfinished)
        write_netcdf(indices, path.with_name("indices.nc"))
    if surrogates := packed(solved, found):
        write_netcdf(surrogates, path.with_name("surrogate.nc"))


def _kept(study: Study, file: Path) -> xr.Dataset | None:
    """Return what was found before for this very study, if anything."""
    if not file.exists():
        return None
    from impactlab.study.adaptive.recommendation import fits

    found = read_netcdf(file)
    return found if fits(found, study) else None
