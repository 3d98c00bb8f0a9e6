"""The axes of the discretisation that are refined: nodes, time step, and size of the elements."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.analysis.convergence.axis import Axis
from impactlab.model.parameters import ELEMENTS

_STEPS = {
    "leapfrog": "the square of the spacing (leapfrog)",
    "semi_implicit": "the spacing (semi-implicit scheme)",
    "timoshenko": "the spacing (Timoshenko beam)",
}
"""What the time step follows, by the scheme of bending beams or the model of others."""
_BENDING = ("euler_bernoulli", "elastic")


def coupling(runs: xr.Dataset) -> str:
    """Describe what is refined along with the spacing; "" if the time step is independent of it."""
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


NODES = Axis("nodes", "the nodes", {"nodes": lambda nodes: 1.0 / (nodes - 1.0)}, coupling)
"""spacing = span/(nodes - 1)."""

TIME_STEP = Axis(
    "time_step",
    "the time step",
    {"courant": lambda courant: courant},
    lambda runs: (
        "The nodes stay the same, so that the order is that of time alone; the limit is the answer "
        "of these nodes at an infinitesimal time step, not that of the beam."
    ),
)
"""The time step is proportional to courant."""

ELEMENT_SIZE = Axis(
    "element_size",
    "the element size",
    dict(zip(ELEMENTS, (lambda size: size, lambda count: 1.0 / count), strict=True)),
    lambda runs: (
        "The elements of the 3-D model shrink about the contact, and the time step with them; "
        "beyond they keep their largest size. Models of the beam do not know the element size, and "
        "agree."
    ),
)
"""The size of the solid elements about the contact."""
