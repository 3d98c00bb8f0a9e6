"""Saltelli's sample."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from impactlab.study.declaration import Sobol
from impactlab.study.sampling.problem import generator, problem


def draws(sampling: Sobol) -> npt.NDArray[np.float64]:
    """Base samples one after the other, each A, A with B's columns, B with A's columns, B.

    Unit draws on (run, varied parameter); the parameters of a group take their columns together.
    The first runs of a larger sample are the smaller sample.
    """
    from SALib.sample import sobol  # takes a second, with its pandas

    found: npt.NDArray[np.float64] = sobol.sample(
        problem(list(sampling.varied), list(sampling.group_of.values())),
        sampling.base_samples,
        calc_second_order=sampling.second_order,
        seed=generator(sampling),
    )
    return found
