"""Checks of a flow law from outside, and its numbers for steel."""

from functools import lru_cache
from typing import Any

import numpy as np

from impactlab.model.flow_law import FlowLaw
from impactlab.verification.law_record import compiled_functions

METALS = ((206e9, 345e6), (70e9, 250e6), (3e9, 60e6))
"""E and S_y (Pa) of steel, aluminium and a polymer."""
_STRAINS = np.concatenate([[0.0], np.geomspace(1e-6, 1.0, 61)])
_RATES = np.concatenate([[0.0], np.geomspace(1e-4, 1e6, 41)])
_ROUNDING = 1e-9
_PRINTED = ((0.002, 0.0), (0.05, 0.0), (0.05, 1e3))


@lru_cache(maxsize=8)
def _compiled(law: FlowLaw) -> Any:
    return compiled_functions(law, {"flow_stress": (0.01, 1.0, *METALS[0])})["flow_stress"]


def refusals(law: FlowLaw) -> list[str]:
    """Return what no flow law may do and this one does, in words; [] if nothing.

    Raises ValueError if it is no code.
    """
    function, reasons = _compiled(law), []
    for metal in METALS:
        stress = np.array([[function(p, rate, *metal) for rate in _RATES] for p in _STRAINS])
        if not np.isfinite(stress).all():
            reasons.append("flow_stress is not finite for all p from 0 to 1 and rates to 1e6 1/s")
            continue
        stress /= metal[1]
        if abs(stress[0, 0] - 1.0) > _ROUNDING:
            reasons.append(f"it begins at {stress[0, 0]:.5g} S_y, not at S_y")
        falls = np.argwhere(np.diff(stress, axis=0) < -_ROUNDING)
        if falls.size:
            p = _STRAINS[falls[0, 0] + 1]
            reasons.append(
                f"the stress falls at p = {p:.3g}: all bending would go to one section, however "
                "short the spacing"
            )
        falls = np.argwhere(np.diff(stress, axis=1) < -_ROUNDING)
        if falls.size:
            reasons.append(f"the stress falls with the rate at {_RATES[falls[0, 1] + 1]:.3g} 1/s")
    return list(dict.fromkeys(reasons))


def lines(law: FlowLaw) -> list[str]:
    """Return the law's numbers for steel, in lines."""
    function, steel = _compiled(law), METALS[0]
    ratios = [(p, rate, function(p, rate, *steel) / steel[1]) for p, rate in _PRINTED]
    return [
        f"flow stress at p = {p}, rate {rate:g} 1/s: {ratio:.4g} S_y" for p, rate, ratio in ratios
    ]
