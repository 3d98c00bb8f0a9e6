"""From a study to its design: the coordinates of all runs, multiplied out or drawn."""

from __future__ import annotations

import xarray as xr

from impactlab.study.declaration import FunctionStudy, Study
from impactlab.study.sampling.function import function_design
from impactlab.study.sampling.impact import impact_design


def design(study: Study | FunctionStudy) -> xr.Dataset:
    """The runs of a study, as a Dataset of coordinates alone: see impact_design.

    The attributes say what solves them, what is asked of them, and how they were chosen. Raises
    StudyError when a drawn run is impossible.
    """
    return function_design(study) if isinstance(study, FunctionStudy) else impact_design(study)
