"""From a law's number to its functions.

Chains of compiled functions, not functions passed as arguments: that would compile anew in each
process.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from impactlab.solver.contact import LAWS
from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading


@compiled
def _no_curve(law: int, *of: float) -> Unloading:
    return np.nan, np.nan, np.nan, 1.5


@compiled
def _no_damping(law: int, *of: float) -> float:
    return 0.0


@compiled
def _no_limit(law: int, *of: float) -> float:
    return np.nan


@compiled
def _no_radius(law: int, *of: float) -> float:
    return np.nan


_FILES = [import_module(f"impactlab.solver.contact.{name}") for name in LAWS]
DAMPED = tuple(number for number, file in enumerate(_FILES) if hasattr(file, "damping"))
"""The numbers of the laws with a function `damping`."""


@compiled
def is_damped(law: int) -> bool:
    """Return True for a law with a function `damping`."""
    return law in DAMPED


def _link(attribute: str, number: int, fallback: Any) -> Any:
    """Return a function that calls this attribute of law `number`, or else `fallback`."""
    chosen = getattr(_FILES[number], attribute)

    def ask(law: int, *of: float) -> Any:
        if law == number:
            return chosen(*of)
        return fallback(law, *of)

    return compiled(ask)


curve, limit, radius, damping = _no_curve, _no_limit, _no_radius, _no_damping
for _number in reversed(range(len(LAWS))):  # the first laws are asked for first
    curve, limit = _link("curve", _number, curve), _link("limit", _number, limit)
    radius = _link("radius", _number, radius)
    damping = _link("damping", _number, damping) if _number in DAMPED else damping
"""curve(law, delta, E, R, S_y, nu) -> (F, K, delta_r, n); limit(law, E, R, S_y, nu) and
radius(law, delta, E, R, S_y, nu) -> m: those of law number `law`, NaN for a number of no law;
damping(law, F, delta, rate, E, R, S_y, nu) -> N, zero for a law without."""
