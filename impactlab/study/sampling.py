"""From a study to its design: the coordinates of all runs, multiplied out or drawn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.dataset import described
from impactlab.model.parameters import flatten
from impactlab.study.declaration import Grid, Sobol, Study
from impactlab.study.errors import Problem, StudyError
from impactlab.study.possible import Refusal, check_alone, refused_run

Columns = Mapping[str, NDArray[np.float64]]

_EDGE = 2.0**-31
"""Half a step of scipy's 30-bit Sobol sequence: keeps draws off 0 and 1, where quantiles may be
infinite."""


def design(study: Study) -> xr.Dataset:
    """The runs of a study, as a Dataset of coordinates alone.

    A grid has one dimension a varied parameter; a sample has the dimension `run` with the varied
    parameters on it. Every other parameter, and the duration, is a scalar coordinate (sphere_mass
    where it is stated). SI units. The attributes say what is asked of the runs, and hold the text
    of the study.

    Raises StudyError, naming parameter and value, when a drawn run is physically impossible; and
    for a study whose discretisation is still to be found (impactlab.steering.resolving).
    """
    if study.auto is not None:
        reason = "is auto: it has to be found before the runs are drawn (impactlab design)"
        raise StudyError(Problem(str(study.path), "discretisation", reason))
    fixed = flatten(study.impact, study.discretisation) | {"duration": study.duration}
    if isinstance(study.sampling, Sobol):
        varied, attrs = _sample(study, study.sampling), _sobol_attributes(study, study.sampling)
    else:
        varied, attrs = _grid(study.sampling), {}
    scalars = {name: ((), value) for name, value in fixed.items()}
    return described(xr.Dataset(coords=scalars | varied, attrs=_attributes(study) | attrs))


def _grid(sampling: Grid) -> dict[str, Any]:
    return {name: (name, np.array(values)) for name, values in sampling.parameters.items()}


def _sample(study: Study, sampling: Sobol) -> dict[str, Any]:
    unit = _saltelli(sampling)
    columns = {
        name: given.quantile(unit[:, at])
        for at, (name, given) in enumerate(sampling.parameters.items())
    }
    _check_draws(study, columns)
    run = xr.Variable("run", np.arange(len(unit)), {"long_name": "run"})
    return {"run": run} | {
        name: ("run", values, sampling.parameters[name].arguments())
        for name, values in columns.items()
    }


def _saltelli(sampling: Sobol) -> NDArray[np.float64]:
    """Draws in the open unit cube, on (run, parameter), in SALib's order.

    The seed goes in as a generator, because SALib takes a seed of 0 for none. The first runs of a
    larger sample are the smaller sample.
    """
    from SALib.sample import sobol  # takes a second, with its pandas

    names = list(sampling.parameters)
    draws = sobol.sample(
        {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)},
        sampling.base_samples,
        calc_second_order=sampling.second_order,
        seed=np.random.default_rng(sampling.seed),
    )
    return np.asarray(np.clip(draws, _EDGE, 1 - _EDGE))


def _check_draws(study: Study, columns: Columns) -> None:
    for name, values in columns.items():
        for extreme in (float(values.min()), float(values.max())):
            try:
                check_alone(name, extreme)
            except ValueError as error:
                raise _impossible(study, Refusal(name, str(error), {name: extreme})) from None
    runs = {name: values.tolist() for name, values in columns.items()}
    if found := refused_run((study.impact, study.discretisation), runs):
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
    return {
        "study": study.name,
        "title": study.title,
        "description": study.description,
        "study_text": study.text,
        "study_sha256": study.sha256,
        "method": study.sampling.method,
        "varied": list(study.sampling.parameters),
        "responses": list(study.responses),
        "analyses": list(study.analyses),
        "histories": int(study.store.histories),
        "profiles": int(study.store.profiles),
        "samples": study.store.samples,
    }


def _sobol_attributes(study: Study, sampling: Sobol) -> dict[str, Any]:
    return {
        "base_samples": sampling.base_samples,
        "second_order": int(sampling.second_order),
        "seed": sampling.seed,
        "confidence": study.analysis.confidence,
        "resamples": study.analysis.resamples,
    }
