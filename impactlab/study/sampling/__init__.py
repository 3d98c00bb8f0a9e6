"""Sampling methods, one file each with its section of the study file and its draws.

The indices of a method are in the file of the same name in analysis.sensitivity.
"""

from __future__ import annotations

from collections.abc import Mapping

from impactlab.study.sampling.fast import Fast
from impactlab.study.sampling.grid import Grid
from impactlab.study.sampling.latin import Latin
from impactlab.study.sampling.morris import Morris
from impactlab.study.sampling.sections import Sampling
from impactlab.study.sampling.sobol import Sobol
from impactlab.study.schema.parameters import Factor
from impactlab.study.schema.section import Reader, section_by

METHODS: Mapping[str, type[Sampling]] = {
    "grid": Grid,
    "sobol": Sobol,
    "morris": Morris,
    "fast": Fast,
    "delta": Latin,
    "pawn": Latin,
    "regression": Latin,
}
"""Sections by their method's name in study files: a new one is a file here and a line."""


def sampling_reader(factors: Mapping[str, Factor]) -> Reader:
    """Return the reader of the section `sampling` of studies that can vary these factors."""
    return section_by("method", {name: kind.of(factors) for name, kind in METHODS.items()})
