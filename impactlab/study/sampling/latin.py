"""Latin hypercube."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from impactlab.study.declaration import Latin
from impactlab.study.sampling.problem import generator, problem


def draws(sampling: Latin) -> npt.NDArray[np.float64]:
    """Unit draws on (run, varied parameter), one in each of equal strata of every parameter.

    The method does not count: changing it asks for no new run.
    """
    from SALib.sample import latin  # takes a second, with its pandas

    found: npt.NDArray[np.float64] = latin.sample(
        problem(list(sampling.varied)), sampling.samples, seed=generator(sampling)
    )
    return found
