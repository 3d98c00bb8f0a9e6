"""What each physical effect adds to the difference between the paper's beam and the 3-D witness."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.fem3d.figures.differences import AXES, Side, side
from impactlab.model.impact import SOLID

EULER, TIMOSHENKO = "euler_bernoulli", "timoshenko"
NAMES = ("peak_force", "contact_duration")
_YIELD = "beam_yield_stress"

EFFECTS = {
    "shear": "shear and rotary inertia",
    "flexibility": "3-D elasticity of the contact",
    "law": "contact law in yielding",
    "all": "all together",
}
"""Each effect in words."""


def applies(runs: xr.Dataset) -> bool:
    """Whether a grid has all three models with two yield stresses, and no other parameter."""
    if "beam_model" not in runs.dims or runs.sizes.get(_YIELD, 0) != 2:
        return False
    rest = set(runs.dims) - {"time", "beam_model", _YIELD, *AXES}
    wanted = {EULER, TIMOSHENKO, SOLID} <= set(runs["beam_model"].values.tolist())
    return wanted and not rest and all(name in runs for name in NAMES)


def effects(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> dict[str, Side]:
    """By which share each effect changes a response, by the keys of EFFECTS; of shape ().

    With E, T and S the response of Euler-Bernoulli's beam, of Timoshenko's and of the solid, and e
    for the runs in which nothing yields: shear T/E - 1, flexibility Se/Te - 1, law
    (S/Se)/(T/Te) - 1, all S/E - 1. One plus the last is the product of one plus each other.
    """
    soft, hard = np.argsort(runs[_YIELD].values)
    both = {model: side(runs, analysis, name, model) for model in (EULER, TIMOSHENKO, SOLID)}
    e, t, s = (_at(both[model], int(soft)) for model in (EULER, TIMOSHENKO, SOLID))
    te, se = (_at(both[model], int(hard)) for model in (TIMOSHENKO, SOLID))
    return {
        "shear": _product([t], [e]),
        "flexibility": _product([se], [te]),
        "law": _product([s, te], [se, t]),
        "all": _product([s], [e]),
    }


def _at(curve: Side, where: int) -> Side:
    return Side(curve.value[where], curve.uncertainty[where])


def _product(over: list[Side], under: list[Side]) -> Side:
    """Product over product, minus one, with the uncertainties of all."""
    ratio = np.prod([each.value for each in over]) / np.prod([each.value for each in under])
    share = sum(abs(each.uncertainty / each.value) for each in (*over, *under))
    return Side(np.asarray(ratio - 1.0), np.asarray(abs(ratio) * share))
