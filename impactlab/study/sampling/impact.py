"""The design of a study of impacts: its sample or grid on the base that all runs share."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray as xr

from impactlab.model.parameters import flatten, with_values
from impactlab.study.declaration import Grid, Sample, Study
from impactlab.study.declaration.solid import asks_for_solid
from impactlab.study.errors import Problem, StudyError
from impactlab.study.sampling.columns import columns, coordinates, declared_attributes, grid
from impactlab.study.sampling.cube import Draws
from impactlab.study.validity import Base, Refusal, check_alone, refused_run
from impactlab.variables import described


def impact_design(study: Study) -> xr.Dataset:
    """The runs of a study, as a Dataset of coordinates alone.

    A grid has one dimension a varied parameter; a sample has the dimension `run` with the varied
    parameters on it. Every other parameter, and the duration, is a scalar coordinate (sphere_mass
    where it is stated). SI units. The attributes say what is asked of the runs, and hold the text
    of the study.

    Raises StudyError, naming parameter and value, when a drawn run is physically impossible; and
    for a study whose discretisation is still to be found (impactlab.study.adaptive.recommendation).
    """
    if study.auto is not None:
        reason = "is auto: it has to be found before the runs are drawn (impactlab design)"
        raise StudyError(Problem(str(study.path), "discretisation", reason))
    base = with_values(study.impact, study.discretisation, study.sampling.fixed)
    fixed = flatten(*base) | {"duration": study.duration}
    scalars = {name: ((), value) for name, value in fixed.items()}
    if isinstance(study.sampling, Grid):
        varied = grid(study.sampling)
    else:
        varied = _sample(study, study.sampling, base)
    return described(xr.Dataset(coords=scalars | varied, attrs=_attributes(study)))


def _sample(study: Study, sampling: Sample, base: Base) -> dict[str, Any]:
    drawn = columns(sampling)
    _check_draws(study, base, drawn)
    return coordinates(sampling, drawn)


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


def _attributes(study: Study) -> dict[str, Any]:
    return declared_attributes(study) | {
        "solver": "witness" if asks_for_solid(study) else "impact",
        "histories": int(study.store.histories),
        "profiles": int(study.store.profiles),
        "history_samples": study.store.samples,
    }
