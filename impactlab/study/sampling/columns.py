"""The runs of a sample as labelled columns, and how they were drawn as attributes."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from impactlab.study.declaration import Declared, Grid, Grouped, Sample, Sobol
from impactlab.study.sampling.cube import Draws, unit_draws


def columns(sampling: Sample) -> dict[str, Draws]:
    """A value a run of each varied parameter, in SI units."""
    unit = unit_draws(sampling).T
    varied = sampling.varied.items()
    return {name: given.quantile(draws) for (name, given), draws in zip(varied, unit, strict=True)}


def coordinates(sampling: Sample, drawn: dict[str, Draws]) -> dict[str, Any]:
    """`run`, and on it the varied parameters with the arguments of their distributions."""
    run = xr.Variable("run", np.arange(sampling.runs), {"long_name": "run"})
    return {"run": run} | {
        name: ("run", values, sampling.varied[name].arguments()) for name, values in drawn.items()
    }


def grid(sampling: Grid) -> dict[str, Any]:
    """The varied parameters, each a dimension of its own."""
    return {name: (name, np.array(values)) for name, values in sampling.parameters.items()}


def declared_attributes(study: Declared) -> dict[str, Any]:
    """What the study is and asks for, whatever solves its runs."""
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
    return attrs | study.analysis.model_dump() | _drawn(study.sampling)


def _drawn(sampling: Sample) -> dict[str, Any]:
    """How the sample was drawn, and until when it is to grow."""
    attrs = dict(sampling.settings)
    if isinstance(sampling, Grouped) and sampling.groups:
        attrs["groups"] = list(sampling.group_of.values())
    if isinstance(sampling, Sobol) and sampling.until:
        until = sampling.until
        attrs |= {"until_interval": until.interval, "until_runs": until.runs}
        attrs |= {"until_responses": list(until.responses)} if until.responses else {}
    return attrs
