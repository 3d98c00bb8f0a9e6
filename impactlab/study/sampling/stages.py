"""The designs that a study goes through: one, or those of a sample that is doubled."""

from __future__ import annotations

from collections.abc import Iterator

import xarray as xr

from impactlab.study.design import run_count
from impactlab.study.sampling.doubling import doubled


def stages(design: xr.Dataset) -> Iterator[xr.Dataset]:
    """The design, then each with twice as many runs that its `until` allows."""
    yield design
    most = int(design.attrs.get("until_runs", 0))
    while 2 * run_count(design) <= most:
        design = doubled(design)
        yield design
