"""A study whose discretisation is to be found becomes one whose discretisation is stated."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.steering.recommending import recommend, recommended
from impactlab.study.declaration import Study
from impactlab.study.engine import Engine
from impactlab.study.errors import Problem, StudyError


def resolved(study: Study, folder: Path, engine: Engine) -> tuple[Study, xr.Dataset]:
    """The study with the discretisation found by trials, and the evidence (see `recommend`).

    folder: for the shards of the trials. Raises StudyError where no discretisation meets the
    tolerance for an asked response, naming what comes nearest; ValueError where the study asks
    for none.
    """
    auto = study.auto
    if auto is None:
        raise ValueError(f"{study.path}: its discretisation is stated: there is none to find")
    asked = auto.responses or study.responses
    found = recommend(study, auto.tolerance, asked, folder, engine)
    if missed := _unreached(found):
        reason = (
            f"no discretisation up to {int(found['nodes'].max())} nodes meets "
            f"{100 * auto.tolerance:g} % for {'; '.join(missed)}: raise tolerance, or list other "
            "responses under discretisation.auto.responses"
        )
        raise StudyError(Problem(str(study.path), "discretisation.auto", reason))
    grid = recommended(found, study.discretisation)
    assert grid is not None  # something is asked, and all of it is reached
    return replace(study, discretisation=grid, auto=None), found


def _unreached(found: xr.Dataset) -> list[str]:
    """The asked responses that no candidate is good enough for, with the least uncertainty."""
    missed = found["response"].values[(found["asked"] & ~found["reached"]).values]
    least = found["candidate_uncertainty"].min("candidate")
    return [f"{name} ({_percent(least.sel(response=name).item())})" for name in missed]


def _percent(share: float) -> str:
    return f"{100 * share:.2g} % at best" if np.isfinite(share) else "nothing bounds its error"
