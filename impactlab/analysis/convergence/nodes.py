"""Convergence with the nodes along the span."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.analysis.convergence import axis

AXIS = axis.Axis("nodes", "nodes", "the nodes", lambda nodes: 1.0 / (nodes - 1.0))
_STEPS = {
    "leapfrog": "the square of the spacing (leapfrog)",
    "semi_implicit": "the spacing (semi-implicit scheme)",
    "timoshenko": "the spacing (Timoshenko beam)",
}
"""What the time step follows, by the scheme of bending beams or the model of others."""
_BENDING = ("euler_bernoulli", "elastic")


def applies(runs: xr.Dataset) -> bool:
    """Whether the runs are a grid with three or more values of `nodes`."""
    return runs.sizes.get("nodes", 0) >= 3


def analysis(runs: xr.Dataset) -> xr.Dataset:
    """The variables nodes_... of `axis.analysis`; spacing = span/(nodes - 1)."""
    return axis.analysis(runs, AXIS, coupling(runs))


def coupling(runs: xr.Dataset) -> str:
    """What else is refined along with the spacing, in words; "" where the step is free of it."""
    models, schemes = _words(runs, "beam_model"), _words(runs, "scheme")
    tied = [_STEPS[scheme] for scheme in schemes if set(models) & set(_BENDING)]
    tied += [_STEPS[model] for model in models if model in _STEPS]
    if not tied:
        return ""
    held = "each courant" if "courant" in runs.dims else "the same courant"
    return (
        f"At {held} the time step shrinks with {' or '.join(tied)}: the order is that of space and "
        "time together. Vary courant at fixed nodes to see time alone."
    )


def _words(runs: xr.Dataset, name: str) -> list[str]:
    return (
        [str(word) for word in np.unique(runs.coords[name].values)] if name in runs.coords else []
    )
