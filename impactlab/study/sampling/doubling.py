"""The next larger sample of the same study."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.study.declaration import FunctionStudy, Sobol, Study, study_of_text
from impactlab.study.sampling import design


def doubled(small: xr.Dataset) -> xr.Dataset:
    """The design with twice the base samples of a Sobol design; it begins with the same runs.

    It is drawn by the text of the study that the design holds. Raises ValueError when it is of
    another method, or when this version of impactlab draws other runs from that text.
    """
    study = declared(small, Path(f"{small.attrs['study']}.yaml"))
    if not isinstance(study.sampling, Sobol):
        raise ValueError(f"study {study.name!r}: only a sample of method sobol can be extended")
    twice = {"base_samples": 2 * int(small.attrs["base_samples"])}
    large = design(replace(study, sampling=study.sampling.model_copy(update=twice)))
    _check_nested(small, large)
    return large


def declared(design: xr.Dataset, file: Path) -> Study | FunctionStudy:
    """The study that a design holds the text of, with the discretisation that was found for it.

    file: named in errors. Raises ValueError where it is no design, or its text no study.
    """
    if absent := {"study", "study_text", "varied"} - design.attrs.keys():
        raise ValueError(f"{file}: is no design of a study: it has no attribute {min(absent)}")
    name, text = str(design.attrs["study"]), str(design.attrs["study_text"])
    return replace(_settled(study_of_text(name, text), design), path=file)


def _settled(study: Study | FunctionStudy, small: xr.Dataset) -> Study | FunctionStudy:
    """With the discretisation that was found for the small design, where the text says auto."""
    if isinstance(study, FunctionStudy) or study.auto is None:
        return study
    found = {name: small[name].item() for name in ("nodes", "points", "courant")}
    return replace(study, discretisation=replace(study.discretisation, **found), auto=None)


def _check_nested(small: xr.Dataset, large: xr.Dataset) -> None:
    """Raises ValueError unless the runs of the small one come first, bit for bit."""
    runs = small.sizes["run"]
    for name in np.atleast_1d(small.attrs["varied"]):
        if not np.array_equal(small[name].values, large[name].values[:runs]):
            raise ValueError(
                f"the design of study {small.attrs['study']!r} was drawn by another version of "
                f"impactlab ({name} differs): draw it again with `impactlab design`"
            )
