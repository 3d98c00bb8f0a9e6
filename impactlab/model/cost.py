"""What a run costs, before it is solved."""

from __future__ import annotations

from typing import Any

import numpy as np

from impactlab.kernels import BEAM_MODELS, SCHEMES


def node_steps(cases: Any) -> Any:
    """Estimated cost of a run, or of each: half the nodes times the time steps.

    Their largest is that of bending for the paper's beam by leapfrog; half a bar wave's for the
    semi-implicit scheme and, roughly, for the other models of the beam.
    """
    dx = cases["beam_span"] / (cases["nodes"] - 1)
    wave = 0.5 * dx * np.sqrt(cases["beam_density"] / cases["beam_youngs_modulus"])
    bending = wave * dx * np.sqrt(12.0) / cases["beam_depth"]
    bends = cases["beam_model"] <= BEAM_MODELS.index("elastic")
    bends = bends & (cases["scheme"] == SCHEMES.index("leapfrog"))
    largest = np.where(bends, bending, wave)
    return 0.5 * cases["nodes"] * cases["duration"] / (cases["courant"] * largest)
