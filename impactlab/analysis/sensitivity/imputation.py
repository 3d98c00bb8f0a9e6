"""Values of failed runs from a surrogate that was fitted to the others.

Never a mean, which would take away variance, and never without a mark: the share of runs whose
value was supplied goes with the indices.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.stats import rankdata

from impactlab.analysis.sensitivity.sample import Array, Sample

Predict = Callable[[Array], Array]
"""From places (runs, parameters) in the unit cube to values (runs,)."""
Fit = Callable[[Array, Array, int], Predict]
"""Fits a surrogate to places (runs, parameters) in the unit cube, values (runs,), and a seed."""

MOST = 0.2
"""Share of runs that may be supplied at most."""
FEWEST = 10
"""Good runs that a surrogate needs for each parameter."""


def possible(outputs: Array, sample: Sample) -> bool:
    """Whether enough runs are left to supply the others."""
    gaps = int(np.isnan(outputs).sum())
    good = outputs.size - gaps
    return gaps <= MOST * outputs.size and good >= FEWEST * len(sample.parameters)


def completed(outputs: Array, sample: Sample, fit: Fit, response: str) -> Array:
    """Outputs (runs,) with NaN replaced by what the surrogate predicts there."""
    gaps = np.isnan(outputs)
    if not gaps.any():
        return outputs
    places = unit(sample.inputs)
    seed = int(sample.rng("surrogate", response).integers(1, 2**31))
    predict = fit(places[~gaps], outputs[~gaps], seed)
    filled = outputs.copy()
    filled[gaps] = predict(places[gaps])
    return filled


def unit(inputs: Array) -> Array:
    """Places (runs, parameters) in the open unit cube: the share of runs below each value.

    Of a sample as even as those of sensitivity analyses, the probability to 1/runs, whatever the
    distribution.
    """
    return np.asarray((rankdata(inputs, axis=0) - 0.5) / len(inputs))
