"""A study whose discretisation is to be found becomes one whose discretisation is stated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.solver.jit import SOURCES_HASH
from impactlab.study.adaptive.recommending import recommended
from impactlab.study.declaration import Study
from impactlab.study.errors import Problem, StudyError


def fits(found: xr.Dataset, study: Study) -> bool:
    """Whether trials were made for this very study, by these kernels."""
    same = found.attrs.get("study_sha256") == study.sha256
    return same and found.attrs.get("kernels_sha256") == SOURCES_HASH


def resolved(study: Study, found: xr.Dataset) -> Study:
    """The study with the discretisation that its trials recommend (see `recommend`).

    Raises StudyError where no discretisation meets the tolerance for an asked response, naming
    what comes nearest; ValueError where the study asks for none.
    """
    auto = study.auto
    if auto is None:
        raise ValueError(f"{study.path}: its discretisation is stated: there is none to find")
    if missed := _unreached(found):
        most, told = int(found["nodes"].max()), ", ".join(missed)
        reason = (
            f"no discretisation up to {most} nodes meets {100 * auto.tolerance:g} % for {told}: "
            "raise tolerance, or list other responses under discretisation.auto.responses"
        )
        raise StudyError(Problem(str(study.path), "discretisation.auto", reason))
    grid = recommended(found, study.discretisation)
    assert grid is not None  # something is asked, and all of it is reached
    return replace(study, discretisation=grid, auto=None)


def _unreached(found: xr.Dataset) -> list[str]:
    """The asked responses that no candidate is good enough for, with the least uncertainty."""
    missed = found["response"].values[(found["asked"] & ~found["reached"]).values]
    least = found["candidate_uncertainty"].min("candidate")
    return [f"{name} ({_percent(least.sel(response=name).item())})" for name in missed]


def _percent(share: float) -> str:
    return f"{100 * share:.2g} % at best" if np.isfinite(share) else "nothing bounds its error"
