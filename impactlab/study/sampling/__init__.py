"""Sampling methods: their sections of the study file, and their draws.

The indices of a method are in the file of its name in analysis.sensitivity.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationInfo

from impactlab.study.sampling.grid import Grid
from impactlab.study.sampling.samples import Fast, Latin, Morris, Pawn, Sobol
from impactlab.study.sampling.sections import Sampling
from impactlab.study.schema.section import name_at

METHODS: Mapping[str, type[Sampling]] = {
    "grid": Grid,
    "sobol": Sobol,
    "morris": Morris,
    "fast": Fast,
    "delta": Latin,
    "pawn": Pawn,
    "regression": Latin,
}
"""Sections by the method that study files name: a new one is a class and a line."""


def read_sampling(data: Any, info: ValidationInfo) -> Sampling:
    """Read the section `sampling` of a study. Raises ValueError naming the key at fault."""
    return METHODS[name_at("method", METHODS, data)].model_validate(data, context=info.context)
