"""The registry of sampling methods: a new one is a file of this folder and an entry here."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from impactlab.study.sampling import fast, grid, latin, morris, sobol
from impactlab.study.sampling.sections import Draws, Sample, SamplingMethod
from impactlab.study.schema.parameters import Factor
from impactlab.study.schema.section import Reader, section_by

METHODS: Mapping[str, SamplingMethod] = {
    method.name: method
    for method in (grid.METHOD, sobol.METHOD, morris.METHOD, fast.METHOD, *latin.METHODS)
}
"""By their names in study files."""
_EDGE = 2.0**-31
"""Half a step of scipy's 30-bit Sobol sequence: keeps draws off 0 and 1, where quantiles may be
infinite."""


def sampling_reader(factors: Mapping[str, Factor]) -> Reader:
    """Return the reader of the section `sampling` of studies that can vary these factors."""
    sections = {name: method.section.of(factors) for name, method in METHODS.items()}
    return section_by("method", sections)


def unit_draws(sampling: Sample) -> Draws:
    """Draw in the open unit cube, on (run, varied parameter), in the order of SALib's runs."""
    draws = METHODS[sampling.method].draws
    if draws is None:
        raise ValueError(f"method {sampling.method} draws no sample")
    return np.asarray(np.clip(draws(sampling), _EDGE, 1 - _EDGE))
