"""Larger designs of the same study: Sobol samples with twice as many base samples."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.study.design import run_count
from impactlab.study.sampling.design import design
from impactlab.study.sampling.sobol import Sobol
from impactlab.study.schema.files import study_of_text
from impactlab.study.schema.study import FunctionStudy, Study


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
    twice = {"base_samples": 2 * int(small.attrs["base_samples"])}
    large = design(replace(study, sampling=study.sampling.model_copy(update=twice)))
    _check_nested(small, large)
    return large


def stages(design: xr.Dataset) -> Iterator[xr.Dataset]:
    """Yield the design, then each design of twice as many runs that its `until` allows."""
    yield design
    most = int(design.attrs.get("until_runs", 0))
    while 2 * run_count(design) <= most:
        design = doubled(design)
        yield design


def study_of_design(design: xr.Dataset, file: Path) -> Study | FunctionStudy:
    """Return the study whose text a design holds, with the discretisation found for it.

    file: the path named in errors. Raises ValueError where the dataset is not a design, or its
    text is not a study.
    """
    if absent := {"study", "study_text", "varied"} - design.attrs.keys():
        raise ValueError(
            f"{file}: is not a design of a study (it has no attribute {min(absent)}): make one "
            "with `impactlab design`"
        )
    name, text = str(design.attrs["study"]), str(design.attrs["study_text"])
    return replace(_with_discretisation(study_of_text(name, text), design), path=file)


def _with_discretisation(study: Study | FunctionStudy, design: xr.Dataset) -> Study | FunctionStudy:
    """Return the study with the discretisation of its design, where the text says auto."""
    if isinstance(study, FunctionStudy) or study.auto is None:
        return study
    found = {name: design[name].item() for name in ("nodes", "points", "courant")}
    return replace(study, discretisation=replace(study.discretisation, **found), auto=None)


def _check_nested(small: xr.Dataset, large: xr.Dataset) -> None:
    """Raise ValueError unless the runs of the small design come first, bit for bit."""
    runs = small.sizes["run"]
    for name in np.atleast_1d(small.attrs["varied"]):
        if not np.array_equal(small[name].values, large[name].values[:runs]):
            raise ValueError(
                f"the design of study {small.attrs['study']!r} was drawn by another version of "
                f"impactlab ({name} differs): draw it again with `impactlab design`"
            )
