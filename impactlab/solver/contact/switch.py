"""From a law's number to its functions.

Chains of compiled functions, not functions passed as arguments: that would compile anew in each
process.
"""

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


def _link(attribute: str, number: int, fallback: Any, file: Any = None) -> Any:
    """Return a function that calls this attribute of law `number`, or else `fallback`.

    file: with the law's functions; by default, the module of a law of this package.
    """
    chosen = getattr(file or _FILES[number], attribute)

    def ask(law: int, *of: float) -> Any:
        if law == number:
            return chosen(*of)
        return fallback(law, *of)

    if file is not None:  # named alike in every process; its copies are those that are compiled
        ask.__qualname__ = f"{attribute}_of_law"
    return compiled(ask)


curve, limit, radius, damping = _no_curve, _no_limit, _no_radius, _no_damping
for _number in reversed(range(len(LAWS))):  # the first laws are asked for first
    curve, limit = _link("curve", _number, curve), _link("limit", _number, limit)
    radius = _link("radius", _number, radius)
    damping = _link("damping", _number, damping) if _number in DAMPED else damping
"""curve(law, delta, E, R, S_y, nu) -> (F, K, delta_r, n); limit(law, E, R, S_y, nu) and
radius(law, delta, E, R, S_y, nu) -> m: those of law number `law`, NaN for a number of no law;
damping(law, F, delta, rate, E, R, S_y, nu) -> N, zero for a law without."""


def substitutes(law: Any) -> dict[Any, Any]:
    """Return what takes the place of each function of this module in kernels of an outside law."""
    number, damps = law.number, law.damping is not None

    def damped(law: int) -> bool:
        return damps and law == number

    damped.__qualname__ = "is_damped_of_law"
    links = {
        curve: _link("curve", number, _no_curve, law),
        limit: _link("limit", number, _no_limit, law),
        radius: _link("radius", number, _no_radius, law),
        damping: _link("damping", number, _no_damping, law) if damps else _no_damping,
        is_damped: compiled(damped),
    }
    return links
