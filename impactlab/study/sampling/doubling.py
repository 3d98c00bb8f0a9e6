"""The next larger sample of the same study."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.study.declaration import FunctionStudy, Sobol, Study, study_of_text
from impactlab.study.sampling import design


def doubled(small: xr.Dataset) -> xr.Dataset:
    """The design with twice the base samples of a Sobol design; it begins with the same runs.

    It is drawn by the text of the study that the design holds. Raises ValueError when it is of
    another method, or when this version of impactlab draws other runs from that text.
    """
    name = str(small.attrs["study"])
    study = study_of_text(name, str(small.attrs["study_text"]))
    if not isinstance(study.sampling, Sobol):
        raise ValueError(f"study {name!r}: only a sample of method sobol can be extended")
    twice = {"base_samples": 2 * int(small.attrs["base_samples"])}
    study = replace(study, sampling=study.sampling.model_copy(update=twice))
    large = design(_settled(study, small))
    _check_nested(small, large)
    return large


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
