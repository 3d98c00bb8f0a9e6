"""Designs: the coordinates of all runs of a study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from impactlab.model.parameters import flatten, with_values
from impactlab.study.errors import Problem, StudyError
from impactlab.study.sampling.grid import Grid
from impactlab.study.sampling.methods import unit_draws
from impactlab.study.sampling.sections import Draws, Grouped, Sample
from impactlab.study.sampling.sobol import Sobol
from impactlab.study.schema.checks import has_solid_runs
from impactlab.study.schema.study import FunctionStudy, Study, StudyBase
from impactlab.study.validity import Base, Refusal, check_alone, refused_run
from impactlab.variables import described
from impactlab.verification.functions import FUNCTIONS


def design(study: Study | FunctionStudy) -> xr.Dataset:
    """Return the runs of a study, as a Dataset of coordinates alone.

    A grid has one dimension per varied parameter; a sample has the dimension `run` with the varied
    parameters on it. Every other parameter, and the duration, is a scalar coordinate (sphere_mass
    where it is given); a parameter of a test function keeps the middle of its range. SI units. The
    attributes name the solver and the responses, describe the sample, and hold the study's text.

    Raises StudyError, naming parameter and value, when a drawn run is physically impossible; and
    for a study whose discretisation is still to be found (impactlab.study.adaptive.recommendation).
    """
    return _of_function(study) if isinstance(study, FunctionStudy) else _of_impacts(study)


def _of_function(study: FunctionStudy) -> xr.Dataset:
    ranges = FUNCTIONS[study.function].ranges
    scalars = {name: ((), 0.5 * (low + high)) for name, (low, high) in ranges.items()}
    scalars |= {name: ((), float(value)) for name, value in study.sampling.fixed.items()}
    if isinstance(study.sampling, Grid):
        varied = _grid(study.sampling)
    else:
        varied = _coordinates(study.sampling, columns(study.sampling))
    attrs = _common_attributes(study) | {"solver": "function", "function": study.function}
    return xr.Dataset(
        coords=scalars | varied, attrs=attrs | {"histories": 0, "profiles": 0, "history_samples": 0}
    )


def _of_impacts(study: Study) -> xr.Dataset:
    if study.auto is not None:
        reason = "is auto: find it before the runs are drawn (impactlab design)"
        raise StudyError(Problem(str(study.path), "discretisation", reason))
    base = with_values(study.impact, study.discretisation, study.sampling.fixed)
    fixed = flatten(*base) | {"duration": study.duration}
    scalars = {name: ((), value) for name, value in fixed.items()}
    if isinstance(study.sampling, Grid):
        varied = _grid(study.sampling)
    else:
        drawn = columns(study.sampling)
        _check_draws(study, base, drawn)
        varied = _coordinates(study.sampling, drawn)
    attrs = _common_attributes(study) | {
        "solver": "witness" if has_solid_runs(study) else "impact",
        "histories": int(study.store.histories),
        "profiles": int(study.store.profiles),
        "history_samples": study.store.samples,
    }
    return described(xr.Dataset(coords=scalars | varied, attrs=attrs))


def columns(sampling: Sample) -> dict[str, Draws]:
    """Return one value per run of each varied parameter, in SI units."""
    unit = unit_draws(sampling).T
    varied = sampling.varied.items()
    return {name: given.quantile(draws) for (name, given), draws in zip(varied, unit, strict=True)}


def _coordinates(sampling: Sample, drawn: dict[str, Draws]) -> dict[str, Any]:
    """Return `run`, and on it the varied parameters with the arguments of their distributions."""
    run = xr.Variable("run", np.arange(sampling.runs), {"long_name": "run"})
    return {"run": run} | {
        name: ("run", values, sampling.varied[name].arguments()) for name, values in drawn.items()
    }


def _grid(sampling: Grid) -> dict[str, Any]:
    """Return the varied parameters, each a dimension of its own."""
    return {name: (name, np.array(values)) for name, values in sampling.parameters.items()}


def _check_draws(study: Study, base: Base, drawn: Mapping[str, Draws]) -> None:
    for name, values in drawn.items():
        for extreme in (float(values.min()), float(values.max())):
            try:
                check_alone(name, extreme)
            except ValueError as error:
                raise _impossible(study, Refusal(name, str(error), {name: extreme})) from None
    runs = {name: values.tolist() for name, values in drawn.items()}
    if found := refused_run(base, runs):
        raise _impossible(study, found)


def _impossible(study: Study, found: Refusal) -> StudyError:
    drawn = ", ".join(f"{name} = {value!r}" for name, value in found.values.items())
    name = found.name if found.name in found.values else next(iter(found.values))
    reason = (
        f"a run was drawn with {drawn}, but {found.name} {found.reason}: use a bounded "
        "distribution such as truncated_normal, or narrower bounds"
    )
    return StudyError(Problem(str(study.path), f"sampling.parameters.{name}", reason))


def _common_attributes(study: StudyBase) -> dict[str, Any]:
    """Return the attributes that do not depend on the solver."""
    attrs = {
        "study": study.name,
        "title": study.title,
        "description": study.description,
        "study_text": study.text,
        "study_sha256": study.sha256,
        "method": study.sampling.method,
        "varied": list(study.sampling.varied),
        "responses": list(study.responses),
        "analyses": list(study.analyses),
    }
    if isinstance(study.sampling, Grid):
        return attrs
    return attrs | study.analysis.model_dump() | _sample_attributes(study.sampling)


def _sample_attributes(sampling: Sample) -> dict[str, Any]:
    """Return how the sample was drawn, and how far it is to grow."""
    attrs = dict(sampling.settings)
    if isinstance(sampling, Grouped) and sampling.groups:
        attrs["groups"] = list(sampling.group_of.values())
    if isinstance(sampling, Sobol) and sampling.until:
        until = sampling.until
        attrs |= {"until_interval": until.interval, "until_runs": until.runs}
        attrs |= {"until_responses": list(until.responses)} if until.responses else {}
    return attrs
