"""Draws in the unit cube, by SALib's samplers: one method a file, and one line in the table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from impactlab.study.declaration import Sample
from impactlab.study.sampling import fast, latin, morris, sobol

Draws = npt.NDArray[np.float64]

_EDGE = 2.0**-31
"""Half a step of scipy's 30-bit Sobol sequence: keeps draws off 0 and 1, where quantiles may be
infinite."""

_SAMPLERS: Mapping[str, Callable[[Any], Draws]] = {
    "sobol": sobol.draws,
    "morris": morris.draws,
    "fast": fast.draws,
    "delta": latin.draws,
    "pawn": latin.draws,
    "regression": latin.draws,
}


def unit_draws(sampling: Sample) -> Draws:
    """Draws in the open unit cube, on (run, varied parameter), in the order of SALib's runs."""
    return np.asarray(np.clip(_SAMPLERS[sampling.method](sampling), _EDGE, 1 - _EDGE))
