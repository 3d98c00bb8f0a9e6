"""What has no limit in the model itself: no grid makes it converge, so no number is given.

Source: Bazant and Planas (1998), Fracture and Size Effect, ch. 8 (localisation of strain in
materials that do not harden).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr

from impactlab.model.impact import SOLID

_HARDENING = ("beam_isotropic_hardening_modulus", "beam_kinematic_hardening_modulus")


class WithoutLimit(NamedTuple):
    """A response that has no limit as the grid of an axis is refined.

    condition: where, from the runs and the response's largest value over the grids, both on the
    rest of the grid; reason: in words.
    """

    axis: str
    response: str
    condition: Callable[[xr.Dataset, xr.DataArray], xr.DataArray]
    reason: str


def _perfectly_plastic_and_yielding(runs: xr.Dataset, largest: xr.DataArray) -> xr.DataArray:
    """Runs of beams; those that do not state a hardening modulus may harden."""
    found = (largest > 0) & ~xr.DataArray(_is_solid(runs))
    for name in _HARDENING:
        found = found & (runs.coords[name] == 0 if name in runs.coords else False)
    return found


def _solid_and_yielding(runs: xr.Dataset, largest: xr.DataArray) -> xr.DataArray:
    return (largest > 0) & _is_solid(runs)


def _is_solid(runs: xr.Dataset) -> xr.DataArray | bool:
    return runs.coords["beam_model"] == SOLID if "beam_model" in runs.coords else False


WITHOUT_LIMIT = (
    WithoutLimit(
        "nodes",
        "peak_plastic_strain",
        _perfectly_plastic_and_yielding,
        "in a beam that does not harden, plastic strain gathers at the node that is struck: its "
        "peak grows with the nodes, up to twice as much with each halving of the spacing",
    ),
    WithoutLimit(
        "element_size",
        "peak_plastic_strain",
        _solid_and_yielding,
        "in the contact of a solid, plastic strain gathers at the edge of the dent: its peak grows "
        "as the elements shrink",
    ),
)
"""Every such response there is, a line each."""


def mask(runs: xr.Dataset, values: xr.DataArray, axis: str, dim: str) -> xr.DataArray:
    """True on (response, *rest of the grid) where there is no limit along `dim`.

    values: the usable responses of the runs on (response, *grid dims).
    """
    largest = values.max(dim)
    found = xr.zeros_like(largest, dtype=bool)
    for entry in _of(axis, values):
        chosen = found["response"] == entry.response
        condition = entry.condition(runs, largest.sel(response=entry.response, drop=True))
        found = found | (chosen & condition)
    return found.transpose(*largest.dims).reset_coords(drop=True)


def reasons(values: xr.DataArray, axis: str) -> str:
    """A line a response of the table: "response: reason"."""
    return "\n".join(f"{entry.response}: {entry.reason}" for entry in _of(axis, values))


def _of(axis: str, values: xr.DataArray) -> list[WithoutLimit]:
    there = np.unique(values["response"].values).tolist()
    return [entry for entry in WITHOUT_LIMIT if entry.axis == axis and entry.response in there]
