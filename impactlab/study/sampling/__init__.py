"""Sampling methods: their sections of the study file, and their draws.

The indices of a method are in the file of its name in analysis.sensitivity.
"""

from __future__ import annotations

from collections.abc import Mapping

from impactlab.study.sampling.grid import Grid
from impactlab.study.sampling.samples import Fast, Latin, Morris, Sobol
from impactlab.study.sampling.sections import Sampling
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
"""Sections by their method's name in study files: a new one is a class and a line."""


def sampling_reader(factors: Mapping[str, Factor]) -> Reader:
    """Return the reader of the section `sampling` of studies that can vary these factors."""
    return section_by("method", {name: kind.of(factors) for name, kind in METHODS.items()})
