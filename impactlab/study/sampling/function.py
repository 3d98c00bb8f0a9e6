"""The design of a study of a test function."""

from __future__ import annotations

import xarray as xr

from impactlab.study.declaration import FunctionStudy, Grid
from impactlab.study.sampling.columns import columns, coordinates, declared_attributes, grid
from impactlab.verification.functions import FUNCTIONS


def function_design(study: FunctionStudy) -> xr.Dataset:
    """As of impacts; a parameter that the study does not name keeps the middle of its range."""
    ranges = FUNCTIONS[study.function].ranges
    scalars = {name: ((), 0.5 * (low + high)) for name, (low, high) in ranges.items()}
    scalars |= {name: ((), float(value)) for name, value in study.sampling.fixed.items()}
    if isinstance(study.sampling, Grid):
        varied = grid(study.sampling)
    else:
        varied = coordinates(study.sampling, columns(study.sampling))
    attrs = declared_attributes(study) | {"solver": "function", "function": study.function}
    return xr.Dataset(
        coords=scalars | varied, attrs=attrs | {"histories": 0, "profiles": 0, "history_samples": 0}
    )
