"""A parameter that the model never saw: what an index makes of it is noise."""

from __future__ import annotations

import numpy as np

from impactlab.analysis.sensitivity.sample import Array


def column(runs: int, rng: np.random.Generator) -> Array:
    """A Latin hypercube in one dimension, (runs,), in the open interval (0, 1)."""
    return (rng.permutation(runs) + 0.5) / runs
