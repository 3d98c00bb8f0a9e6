"""The search curves of the extended Fourier amplitude sensitivity test."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from impactlab.study.declaration import Fast
from impactlab.study.sampling.problem import generator, problem

_DUMMY = "dummy"


def draws(sampling: Fast) -> npt.NDArray[np.float64]:
    """Curves one after the other: each parameter's, and last that of a dummy.

    Unit draws on (run, varied parameter): the dummy has a curve, in which the others have their
    low frequencies, but no column.
    """
    from SALib.sample import fast_sampler  # takes a second, with its pandas

    found: npt.NDArray[np.float64] = fast_sampler.sample(
        problem([*sampling.varied, _DUMMY]),
        sampling.samples,
        M=sampling.harmonics,
        seed=generator(sampling),
    )
    return found[:, :-1]
