"""Designs: the coordinates of all runs of a study, and larger ones of the same study."""

from collections.abc import Iterator
from dataclasses import replace
from math import prod
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import numpy as np
import xarray as xr

from impactlab.methods.grid import Grid
from impactlab.methods.runs import listed
from impactlab.methods.sobol import Sobol
from impactlab.model.bodies import sphere_rows
from impactlab.model.parameters import fixed_values, with_values
from impactlab.study.schema.consistency import further_models, values_of
from impactlab.study.schema.declarations import AnyStudy, FunctionStudy, ImpactStudy
from impactlab.study.schema.readers import study_of_text
from impactlab.study.solvers import run_shape
from impactlab.validation.errors import Problem, StudyError
from impactlab.variables import described
from impactlab.verification.functions import FUNCTIONS


def design(study: AnyStudy, start: int = 0, stop: int | None = None) -> xr.Dataset:
    """Return the runs of a study, as a Dataset of coordinates alone.

    A grid has one dimension per varied parameter; a sample has the dimension `run` with the varied
    parameters on it. Every other parameter, and the duration, is a scalar coordinate (sphere_mass
    where it is given); a parameter of a test function keeps the middle of its range. SI units. The
    attributes name the solver and the responses, describe the sample, and hold the study's text.

    stop: with it, the runs from start to stop alone, also those of a grid on the dimension `run`.

    Raises StudyError for a study whose discretisation is still to be found
    (impactlab.study.adaptive.recommendation). What is drawn is checked before it is solved.
    """
    sampling = study.sampling
    fixed: dict[str, Any]
    if isinstance(study, FunctionStudy):
        ranges = {} if study.python else FUNCTIONS[study.function].ranges
        fixed = {name: 0.5 * (low + high) for name, (low, high) in ranges.items()}
        fixed |= {name: float(value) for name, value in sampling.fixed.items()}
        settings: dict[str, Any] = {"solver": "function", "function": study.function}
        settings |= {"histories": 0, "profiles": 0, "history_samples": 0}
    else:
        if study.auto is not None:
            reason = "is auto: find it before the runs are drawn (impactlab design)"
            raise StudyError(Problem(str(study.path), "discretisation", reason))
        base = with_values(study.impact, study.discretisation, sampling.fixed)
        fixed = fixed_values(*base, sampling.varied) | {"duration": study.duration}
        settings = {
            "solver": next((model.solver for model in further_models(study)), "impact"),
            "histories": int(study.store.histories),
            "profiles": int(study.store.profiles),
            "history_samples": study.store.samples,
        }
        settings |= series_sizes(study)
        settings |= {"measurements": list(study.measurements)} if study.measurements else {}
    if study.python:
        settings |= {"solver": resolve_name("impactlab.study.solvers.own:solver_name")(study)}
    varied: dict[str, Any]
    if isinstance(sampling, Grid) and stop is None:
        varied = {name: (name, np.array(values)) for name, values in sampling.parameters.items()}
    else:
        runs = np.arange(start, sampling.runs if stop is None else stop)
        varied = {"run": xr.Variable("run", runs, {"long_name": "run"})}
        for name, values in sampling.columns(start, stop).items():
            entry = sampling.varied[name]
            varied[name] = "run", values, {} if isinstance(entry, tuple) else entry.arguments()
    scalars = {name: ((), value) for name, value in fixed.items()}
    dataset = xr.Dataset(coords=scalars | varied, attrs=study.attributes() | settings)
    if isinstance(study, ImpactStudy):
        return described(dataset)
    for name, attrs in study.labels.items():
        dataset[name].attrs = {**attrs, **dataset[name].attrs, "function": study.function}
    return dataset


def series_sizes(study: ImpactStudy) -> dict[str, int]:
    """Return what a design says of strikes and spheres, if runs have several: their most."""
    strikes = values_of(study.sampling, "strikes", study.impact.strikes)
    spheres = len(sphere_rows(study.impact.further_spheres or ())) + 1
    sizes = {"most_strikes": max(map(int, strikes)), "spheres": spheres}
    return {name: size for name, size in sizes.items() if size > 1}


def doubled(small: xr.Dataset) -> xr.Dataset:
    """Return the Sobol design with twice the base samples; it begins with the same runs.

    The study's text in the design is drawn anew. Raises ValueError for a design of another method,
    or when this version of impactlab draws other runs from that text.
    """
    study = study_of_design(small, Path(f"{small.attrs['study']}.yaml"))
    if not isinstance(study.sampling, Sobol):
        raise ValueError(
            f"study {study.name!r} has method: {study.sampling.method}, but only a sample with "
            "method: sobol can be extended"
        )
    twice = replace(study.sampling, base_samples=2 * int(small.attrs["base_samples"]))
    large = design(replace(study, sampling=twice))
    for name in listed(small, "varied"):
        if not np.array_equal(small[name].values, large[name].values[: small.sizes["run"]]):
            raise ValueError(
                f"the design of study {study.name!r} was drawn by another version of impactlab "
                f"({name} differs): draw it again with `impactlab design`"
            )
    return large


def stages(design: xr.Dataset) -> Iterator[xr.Dataset]:
    """Yield the design, then each design of twice as many runs that its `until` allows."""
    yield design
    most = int(design.attrs.get("until_runs", 0))
    while 2 * prod(run_shape(design)[1]) <= most:
        design = doubled(design)
        yield design


def study_of_design(design: xr.Dataset, file: Path) -> AnyStudy:
    """Return the study whose text a design holds, with the discretisation found for it.

    file: the path named in errors. Raises ValueError where the dataset is not a design, or its
    text is not a study.
    """
    if absent := {"study", "study_text", "varied"} - design.attrs.keys():
        raise ValueError(
            f"{file}: is not a design of a study (it has no attribute {min(absent)}): make one "
            "with `impactlab design`"
        )
    study = study_of_text(str(design.attrs["study"]), str(design.attrs["study_text"]))
    if isinstance(study, FunctionStudy) or study.auto is None:
        return replace(study, path=file)
    values = {name: design[name].item() for name in ("nodes", "points", "courant")}
    grid = replace(study.discretisation, **values)
    return replace(study, path=file, discretisation=grid, auto=None)
