"""Differences between the beam models and the 3-D FE model, and the effects they come from.

Each model is taken on its finest grid, with its uncertainty.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from impactlab.figures.access import known, usable
from impactlab.model.impact import SOLID
from impactlab.types import Floats

AXES = {"nodes": np.argmax, "element_size": np.argmin, "elements_per_radius": np.argmax}
"""Refinements, and the function that finds the finest grid on each."""
_FEWEST = 3


class Side(NamedTuple):
    """A response of one model: value and half-width, (velocities,), SI; the latter NaN if unknown.

    Where nothing bounds the error, the half-width is infinite.
    """

    value: Floats
    uncertainty: Floats


def differ(runs: xr.Dataset) -> bool:
    """Return whether a grid has the 3-D FE model beside others at three velocities or more."""
    if "beam_model" not in runs.dims or runs.sizes.get("velocity", 0) < _FEWEST:
        return False
    rest = set(runs.dims) - {"time", "x", "z", "velocity", "beam_model", *AXES}
    return SOLID in runs["beam_model"].values and runs.sizes["beam_model"] > 1 and not rest


def models(runs: xr.Dataset) -> list[str]:
    """Return the 3-D FE model first, then the others in the study's order."""
    listed = [str(name) for name in runs["beam_model"].values]
    return [SOLID, *(name for name in listed if name != SOLID)]


def finest(runs: xr.Dataset) -> dict[str, int]:
    """Return the index of the finest grid, by dimension."""
    return {dim: int(at(runs[dim].values)) for dim, at in AXES.items() if dim in runs.dims}


def side(runs: xr.Dataset, analysis: xr.Dataset, name: str, model: str) -> Side:
    """Return a response of one model against the velocity, in the order of the runs."""
    values = usable(runs, name).sel(beam_model=model).isel(finest(runs), missing_dims="ignore")
    found = values.values.astype(float)
    variable = f"{'element_size' if model == SOLID else 'nodes'}_uncertainty"
    if variable not in analysis or not known(analysis, name):
        return Side(found, np.full(found.shape, np.nan))
    share = analysis[variable].sel(response=name, beam_model=model)
    share = share.isel(dict.fromkeys(AXES, 0), missing_dims="ignore")
    return Side(found, abs(found) * share.values.astype(float))


def difference(over: list[Side], under: list[Side]) -> Side:
    """Return product over product, minus one, with the uncertainties of all; NaN over 0."""
    below = np.prod([each.value for each in under], axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.prod([each.value for each in over], axis=0) / np.where(below, below, np.nan)
        share = sum(abs(each.uncertainty / each.value) for each in (*over, *under))
    return Side(ratio - 1.0, abs(ratio) * share)


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


def separable(runs: xr.Dataset) -> bool:
    """Return whether a grid varies only the three models and two yield stresses."""
    if "beam_model" not in runs.dims or runs.sizes.get(_YIELD, 0) != 2:
        return False
    rest = set(runs.dims) - {"time", "beam_model", _YIELD, *AXES}
    wanted = {EULER, TIMOSHENKO, SOLID} <= set(runs["beam_model"].values.tolist())
    return wanted and not rest and all(name in runs for name in NAMES)


def effects(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> dict[str, Side]:
    """Return the share by which each effect changes a response, by the keys of EFFECTS.

    Each is of shape (). With E, T and S the response of the Euler-Bernoulli beam, the Timoshenko
    beam and the 3-D FE model, and e for the runs in which nothing yields: shear T/E - 1,
    flexibility Se/Te - 1, law (S/Se)/(T/Te) - 1, all S/E - 1. One plus the last is the product of
    one plus each other.
    """
    soft, hard = np.argsort(runs[_YIELD].values)
    both = {model: side(runs, analysis, name, model) for model in (EULER, TIMOSHENKO, SOLID)}
    (e, _), (t, te), (s, se) = (
        [Side(curve.value[at], curve.uncertainty[at]) for at in (soft, hard)]
        for curve in both.values()
    )
    return {
        "shear": difference([t], [e]),
        "flexibility": difference([se], [te]),
        "law": difference([s, te], [se, t]),
        "all": difference([s], [e]),
    }
