"""From a law's number to its functions.

Chains of compiled functions, not functions passed as arguments: that would compile anew in each
process.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from impactlab.solver.contact import LAWS
from impactlab.solver.jit import compiled, linked
from impactlab.solver.types import Unloading


@compiled
def _no_curve(law: int, *of: float) -> Unloading:
    return np.nan, np.nan, np.nan, 1.5


@compiled
def _no_limit(law: int, *of: float) -> float:
    return np.nan


@compiled
def _no_radius(law: int, *of: float) -> float:
    return np.nan


def _link(attribute: str, number: int, fallback: Any) -> Any:
    """Return a function that calls this attribute of law `number`, or else `fallback`."""
    chosen = getattr(import_module(f"impactlab.solver.contact.{LAWS[number]}"), attribute)

    def ask(law: int, *of: float) -> Any:
        if law == number:
            return chosen(*of)
        return fallback(law, *of)

    # numba knows functions by their names and would take one made here for another
    ask.__qualname__ = ask.__name__ = f"{attribute}_{number}"
    return linked(ask)


curve, limit, radius = _no_curve, _no_limit, _no_radius
for _number in reversed(range(len(LAWS))):  # the first laws are asked for first
    curve, limit = _link("curve", _number, curve), _link("limit", _number, limit)
    radius = _link("radius", _number, radius)
"""curve(law, delta, E, R, S_y, nu) -> (F, K, delta_r, n); limit(law, E, R, S_y, nu) and
radius(law, delta, E, R, S_y, nu) -> m: those of law number `law`, NaN for a number of no law."""
