"""Convergence of all responses along one axis of the discretisation, as labelled variables.

Some responses have no limit in the model itself: no grid makes them converge, and no number is
given. Source: Bazant and Planas (1998), Fracture and Size Effect, ch. 8 (localisation of strain in
materials that do not harden).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
import xarray as xr

from impactlab.analysis.convergence.judgement import AxisVerdict, How, Judgement, judge
from impactlab.analysis.convergence.least_squares import Expansion
from impactlab.analysis.convergence.richardson import Behaviour
from impactlab.analysis.responses import usable
from impactlab.analysis.verdicts import TOLERANCE, Verdict, flagged, verdict_variables
from impactlab.model.impact import SOLID
from impactlab.types import Floats


@dataclass(frozen=True)
class Axis:
    """An axis of the discretisation that is refined.

    name: prefix of the variables; words: the axis in titles, such as "the nodes". spacings: by
    dimension of the runs, the function from its values to what tends to zero, in any unit. comment:
    what to know about the order, from the runs.
    """

    name: str
    words: str
    spacings: Mapping[str, Callable[[Floats], Floats]]
    comment: Callable[[xr.Dataset], str]

    def applies(self, runs: xr.Dataset) -> bool:
        """Return whether the runs are a grid with three or more values on the axis."""
        return any(runs.sizes.get(dim, 0) >= 3 for dim in self.spacings)

    def analysis(self, runs: xr.Dataset) -> xr.Dataset:
        """Judge every response at every point of the rest of the grid.

        Returns the fields of Judgement as <axis>_<field> on (response, *other grid dims), flags as
        CF flags; beside them <axis>_summary (response) and <axis>_tally (response, <axis>_outcome).
        What has no limit by design keeps its observed order alone. Raises ValueError for a repeated
        value on the axis.
        """
        dim = next(name for name in self.spacings if name in runs.dims)
        values = usable(runs)
        spacings = self.spacings[dim](values[dim].values.astype(float))
        finest_first = np.argsort(spacings)
        values, spacings = values.isel({dim: finest_first}), spacings[finest_first]
        fields = xr.apply_ufunc(
            partial(judge, spacings=spacings),
            values,
            input_core_dims=[[dim]],
            output_core_dims=[[]] * len(Judgement._fields),
            output_dtypes=[np.int8 if name in _FLAGS else float for name in Judgement._fields],
            vectorize=True,
        )
        found = _marked(
            dict(zip(Judgement._fields, fields, strict=True)),
            without_limit(runs, values, self.name, dim),
        )
        return _described(found, self, self.comment(runs), _reasons(values, self.name))


def _marked(found: dict[str, xr.DataArray], mask: xr.DataArray) -> dict[str, xr.DataArray]:
    """Return the fields, marked and without numbers where there is no limit."""
    instead = {name: np.nan for name in Judgement._fields} | {
        "uncertainty": np.inf,
        "fit_expansion": Expansion.NONE,
        "uncertainty_from": How.NOTHING,
        "behaviour": Behaviour.NOT_CONVERGENT_BY_DESIGN,
        "verdict": AxisVerdict.NOT_CONVERGENT_BY_DESIGN,
    }
    kept = "observed_order"
    return {
        name: field if name == kept else field.where(~mask, instead[name])
        for name, field in found.items()
    }


def _described(
    found: dict[str, xr.DataArray], axis: Axis, comment: str, reasons: str
) -> xr.Dataset:
    name, words = axis.name, f"convergence with {axis.words}"
    numbers = {
        f"{name}_{key}": found[key].assign_attrs(_attributes(key, axis, comment))
        for key in _NUMBERS
    }
    flags = {
        f"{name}_{key}": flagged(found[key], kind, f"{long_name} {axis.words}")
        for key, (kind, long_name) in _FLAGS.items()
        if key != "verdict"
    }
    verdicts = verdict_variables(found["verdict"], AxisVerdict, name, words)
    dataset = xr.Dataset(numbers | flags | verdicts)
    said = {"tolerance": TOLERANCE, "comment": comment}
    for key in ("verdict", "summary"):
        dataset[f"{name}_{key}"].attrs |= said | ({"without_limit": reasons} if reasons else {})
    return dataset


def _attributes(key: str, axis: Axis, comment: str) -> dict[str, str]:
    long_name, units, said = _NUMBERS[key]
    attrs = {"long_name": long_name.format(axis.words), "comment": f"{said} {comment}".strip()}
    return attrs | ({"units": units} if units else {})


_FLAGS: dict[str, tuple[type[Verdict], str]] = {
    "behaviour": (Behaviour, "behaviour of the three finest grids with"),
    "fit_expansion": (Expansion, "form of the error in the least-squares fit with"),
    "uncertainty_from": (How, "what the numerical uncertainty rests on, with"),
    "verdict": (AxisVerdict, "verdict on convergence with"),
}
_NUMBERS = {
    "observed_order": ("observed order of convergence with {}", "1", ""),
    "extrapolated": (
        "Richardson value, extrapolated in {}",
        "",
        "In the unit of response_units; given where the order is credible.",
    ),
    "gci": (
        "grid convergence index of the finest grid, {}",
        "1",
        "Relative to the finest value, infinite where that is zero.",
    ),
    "safety_factor": ("safety factor in the grid convergence index, {}", "1", ""),
    "asymptotic_ratio": (
        "ratio of successive grid convergence indices over r^p, {}",
        "1",
        "1 in the asymptotic range, but near 1 elsewhere, too: not a proof by itself.",
    ),
    "fit_order": (
        "order of the least-squares fit in {}",
        "1",
        "Over four or more grids; assumed, not fitted, where fit_expansion is not `free`.",
    ),
    "fit_extrapolated": (
        "limit of the least-squares fit in {}",
        "",
        "In the unit of response_units; over four or more grids.",
    ),
    "fit_uncertainty": (
        "uncertainty of the finest value by the least-squares fit in {}",
        "1",
        "Relative to the finest value; Eca and Hoekstra (2014), over four or more grids.",
    ),
    "uncertainty": (
        "numerical uncertainty of the finest value, from {}",
        "1",
        "Relative to the finest value; infinite where nothing bounds the error.",
    ),
}
"""Long name, unit and comment of each number."""


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
    """Select runs of beams; those without a stated hardening modulus may harden."""
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
"""Every such response, one entry each."""


def without_limit(runs: xr.Dataset, values: xr.DataArray, axis: str, dim: str) -> xr.DataArray:
    """Return True on (response, *rest of the grid) where there is no limit along `dim`.

    values: the usable responses of the runs on (response, *grid dims).
    """
    largest = values.max(dim)
    found = xr.zeros_like(largest, dtype=bool)
    for entry in _of(axis, values):
        chosen = found["response"] == entry.response
        condition = entry.condition(runs, largest.sel(response=entry.response, drop=True))
        found = found | (chosen & condition)
    return found.transpose(*largest.dims).reset_coords(drop=True)


def _reasons(values: xr.DataArray, axis: str) -> str:
    """Return one line per response of the table: "response: reason"."""
    return "\n".join(f"{entry.response}: {entry.reason}" for entry in _of(axis, values))


def _of(axis: str, values: xr.DataArray) -> list[WithoutLimit]:
    there = np.unique(values["response"].values).tolist()
    return [entry for entry in WITHOUT_LIMIT if entry.axis == axis and entry.response in there]
