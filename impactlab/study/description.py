"""Descriptions of study files for a workflow, before its first step."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from impactlab.study.errors import StudyError
from impactlab.study.sampling.sections import Sample
from impactlab.study.sampling.sobol import Sobol
from impactlab.study.schema.checks import has_solid_runs
from impactlab.study.schema.files import read_any
from impactlab.study.schema.study import Study, Verification


def describe(path: Path) -> dict[str, Any]:
    """Return name, title, size (runs or checks) and traits of a study file, for JSON.

    traits: "checks" (a verification), "auto" (its discretisation is to be found), "sample" (its
    impacts are drawn), "sobol" (by Sobol's sequence), "growing" (until its intervals are narrow),
    "fem3d" (some runs are of the 3-D FE model). Of a file that is wrong: name, no traits, and
    `error`.
    """
    try:
        study = read_any(path)
    except StudyError as error:
        return {"name": path.stem, "traits": [], "error": str(error)}
    return {
        "name": study.name,
        "title": study.title,
        "size": study.size,
        "traits": list(_traits(study)),
    }


def _traits(study: Any) -> Iterator[str]:
    if isinstance(study, Verification):
        yield "checks"
    sampling = getattr(study, "sampling", None)
    if isinstance(sampling, Sobol) and sampling.until:
        yield "growing"
    if not isinstance(study, Study):
        return
    if study.auto is not None:
        yield "auto"
    if isinstance(sampling, Sample):
        yield "sample"
    if isinstance(sampling, Sobol):
        yield "sobol"
    if has_solid_runs(study):
        yield "fem3d"
