"""From a law's number to its functions.

Chains of compiled functions, not functions passed as arguments: that would compile anew in each
process.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from types import ModuleType

import numpy as np

from impactlab.solver.contact import LAWS
from impactlab.solver.jit import compiled, linked
from impactlab.solver.types import Curve

Limit = Callable[..., float]

_FILES: list[ModuleType] = [import_module(f"impactlab.solver.contact.{name}") for name in LAWS]


@compiled
def _no_curve(
    law: int, delta: float, E: float, R: float, S_y: float, nu: float
) -> tuple[float, float, float, float]:
    return np.nan, np.nan, np.nan, 1.5


def _link_curve(number: int, chosen: Curve, others: Curve) -> Curve:
    def curve(
        law: int, delta: float, E: float, R: float, S_y: float, nu: float
    ) -> tuple[float, float, float, float]:
        if law == number:
            return chosen(delta, E, R, S_y, nu)
        return others(law, delta, E, R, S_y, nu)

    return linked(curve, number)


@compiled
def _no_limit(law: int, E: float, R: float, S_y: float, nu: float) -> float:
    return np.nan


def _link_limit(number: int, chosen: Limit, others: Limit) -> Limit:
    def limit(law: int, E: float, R: float, S_y: float, nu: float) -> float:
        if law == number:
            return chosen(E, R, S_y, nu)
        return others(law, E, R, S_y, nu)

    return linked(limit, number)


curve: Curve = _no_curve
limit: Limit = _no_limit
# the first laws are asked for first
for _number, _file in reversed(list(enumerate(_FILES))):
    curve = _link_curve(_number, _file.curve, curve)
    limit = _link_limit(_number, _file.limit, limit)
"""curve(law, delta, E, R, S_y, nu) -> (F, K, delta_r, n); limit(law, E, R, S_y, nu) -> m: those of
law number `law`, NaN for a number that no law has."""
