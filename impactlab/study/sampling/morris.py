"""Morris' trajectories."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from impactlab.study.declaration import Morris
from impactlab.study.sampling.problem import generator, problem


def draws(sampling: Morris) -> npt.NDArray[np.float64]:
    """Trajectories one after the other: a start, and a step of each parameter or group.

    Levels in the unit cube, ends included, on (run, varied parameter).
    """
    from SALib.sample import morris  # takes a second, with its pandas

    found: npt.NDArray[np.float64] = morris.sample(
        problem(list(sampling.varied), list(sampling.group_of.values())),
        sampling.trajectories,
        num_levels=sampling.levels,
        optimal_trajectories=sampling.optimal_trajectories or None,
        seed=generator(sampling),
    )
    return found
