"""From a law's number to its function.

A chain of compiled functions, not one passed as an argument: that would compile anew in each
process.
"""

from __future__ import annotations

from importlib import import_module

import numpy as np

from impactlab.kernels.contact import LAWS
from impactlab.kernels.jit import compiled
from impactlab.kernels.types import Curve


@compiled
def _unknown(
    law: int, delta: float, E: float, R: float, S_y: float, nu: float
) -> tuple[float, float, float, float]:
    return np.nan, np.nan, np.nan, 1.5


def _link(number: int, chosen: Curve, others: Curve) -> Curve:
    @compiled
    def curve(
        law: int, delta: float, E: float, R: float, S_y: float, nu: float
    ) -> tuple[float, float, float, float]:
        if law == number:
            return chosen(delta, E, R, S_y, nu)
        return others(law, delta, E, R, S_y, nu)

    return curve


def _chain() -> Curve:
    curve = _unknown
    for number, name in enumerate(LAWS):
        curve = _link(number, import_module(f"impactlab.kernels.contact.{name}").curve, curve)
    return curve


curve = _chain()
"""curve(law, delta, E, R, S_y, nu) -> (F, K, delta_r, n): that of law number `law`."""
