"""Convergence of all responses along an axis of the discretisation, as labelled variables.

The axes are the nodes and the time step; models of wings have further ones.

Some responses have no limit in the model itself: no grid makes them converge, and no number is
given. Source: Bazant and Planas (1998), Fracture and Size Effect, ch. 8 (localisation of strain in
materials that do not harden).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
import xarray as xr

from impactlab import wings
from impactlab.analysis.convergence.extrapolation import Behaviour, Expansion
from impactlab.analysis.convergence.judgement import AxisVerdict, How, Judgement, judge
from impactlab.methods.runs import usable
from impactlab.types import Floats
from impactlab.verdicts import TOLERANCE, Verdict, flagged, verdict_variables


@dataclass(frozen=True)
class Growth:
    """The runs whose peak plastic strain, where they yield, has no limit along an axis, and why."""

    reason: str
    affected: Callable[[xr.Dataset], xr.DataArray]


@dataclass(frozen=True)
class Axis:
    """An axis of the discretisation that is refined.

    name: prefix of the variables; label: the axis in titles, such as "the nodes". spacings: by
    dimension of the runs, the function from its values to what tends to zero, in any unit. comment:
    what to know about the order, from the runs. growth: of what has no limit, if anything.
    """

    name: str
    label: str
    spacings: Mapping[str, Callable[[Floats], Floats]]
    comment: Callable[[xr.Dataset], str]
    growth: Growth | None = None

    def analysis(self, runs: xr.Dataset) -> xr.Dataset:
        """Judge every response at every point of the rest of the grid.

        Returns the fields of Judgement as <axis>_<field> on (response, *other grid dims), flags as
        CF flags; beside them <axis>_summary (response). What has no limit by design keeps its
        observed order alone. Raises ValueError for a repeated value on the axis.
        """
        dim = next(name for name in self.spacings if name in runs.dims)
        values = usable(runs)
        spacings = self.spacings[dim](values[dim].values.astype(float))
        finest_first = np.argsort(spacings)
        values, spacings = values.isel({dim: finest_first}), spacings[finest_first]
        columns = xr.apply_ufunc(
            partial(judge, spacings=spacings),
            values,
            input_core_dims=[[dim]],
            output_core_dims=[[]] * len(Judgement._fields),
            output_dtypes=[np.int8 if name in _FLAGS else float for name in Judgement._fields],
            vectorize=True,
        )
        fields = dict(zip(Judgement._fields, columns, strict=True))
        limited = ~without_limit(runs, values, self.growth, dim)
        judged = {
            name: field.where(limited, _WITHOUT_LIMIT.get(name, np.nan))
            for name, field in fields.items()
        }
        judged["observed_order"] = fields["observed_order"]
        comment = self.comment(runs)
        remarks = {"tolerance": TOLERANCE, "comment": comment}
        if self.growth and _STRAIN in values["response"].values:
            remarks["without_limit"] = f"{_STRAIN}: {self.growth.reason}"
        dataset = xr.Dataset()
        for key, long_name in _NUMBERS.items():
            about = f"{_COMMENTS.get(key, '')} {comment}".strip()
            attrs = {"long_name": long_name.format(self.label), "comment": about}
            attrs |= {} if key.endswith("extrapolated") else {"units": "1"}
            dataset[f"{self.name}_{key}"] = judged[key].assign_attrs(attrs)
        for key, (kind, long_name) in _FLAGS.items():
            dataset[f"{self.name}_{key}"] = flagged(judged[key], kind, f"{long_name} {self.label}")
        subject = f"convergence with {self.label}"
        dataset.update(verdict_variables(judged["verdict"], AxisVerdict, self.name, subject))
        for key in ("verdict", "summary"):
            dataset[f"{self.name}_{key}"].attrs |= remarks
        return dataset


_FLAGS: dict[str, tuple[type[Verdict], str]] = {
    "behaviour": (Behaviour, "behaviour of the three finest grids with"),
    "fit_expansion": (Expansion, "form of the error in the least-squares fit with"),
    "uncertainty_from": (How, "what the numerical uncertainty rests on, with"),
    "verdict": (AxisVerdict, "verdict on convergence with"),
}
_NUMBERS = {
    "observed_order": "observed order of convergence with {}",
    "extrapolated": "Richardson value, extrapolated in {}",
    "gci": "grid convergence index of the finest grid, {}",
    "safety_factor": "safety factor in the grid convergence index, {}",
    "asymptotic_ratio": "ratio of successive grid convergence indices over r^p, {}",
    "fit_order": "order of the least-squares fit in {}",
    "fit_extrapolated": "limit of the least-squares fit in {}",
    "fit_uncertainty": "uncertainty of the finest value by the least-squares fit in {}",
    "uncertainty": "numerical uncertainty of the finest value, from {}",
}
"""Long name of each number; extrapolated ones have the unit of the response, others none."""
_COMMENTS = {
    "extrapolated": "In the unit of response_units; given where the order is credible.",
    "gci": "Relative to the finest value, infinite where that is zero.",
    "asymptotic_ratio": "1 in the asymptotic range, but near 1 elsewhere, too: not a proof by "
    "itself.",
    "fit_order": "Over four or more grids; assumed, not fitted, where fit_expansion is not `free`.",
    "fit_extrapolated": "In the unit of response_units; over four or more grids.",
    "fit_uncertainty": "Relative to the finest value; Eca and Hoekstra (2014), over four or more "
    "grids.",
    "uncertainty": "Relative to the finest value; infinite where nothing bounds the error.",
}
_WITHOUT_LIMIT = {
    "uncertainty": np.inf,
    "fit_expansion": Expansion.NONE,
    "uncertainty_from": How.NOTHING,
    "behaviour": Behaviour.NOT_CONVERGENT_BY_DESIGN,
    "verdict": AxisVerdict.NOT_CONVERGENT_BY_DESIGN,
}
"""What is stored where there is no limit; of other fields, NaN."""
_STRAIN = "peak_plastic_strain"


def without_limit(
    runs: xr.Dataset, values: xr.DataArray, growth: Growth | None, dim: str
) -> xr.DataArray:
    """Return True on (response, *rest of the grid) where there is no limit along `dim`.

    values: the usable responses of the runs on (response, *grid dims).
    """
    largest = values.max(dim)
    endless = xr.zeros_like(largest, dtype=bool)
    if growth:
        endless = (largest["response"] == _STRAIN) & (largest > 0) & growth.affected(runs)
    return endless.transpose(*largest.dims).reset_coords(drop=True)


def _beams_that_do_not_harden(runs: xr.Dataset) -> xr.DataArray:
    models: xr.DataArray = runs.coords.get("beam_model", xr.DataArray(""))
    affected = ~models.isin(list(wings.models()))
    for kind in ("isotropic", "kinematic"):  # without a stated modulus it may harden
        affected = affected & (runs.get(f"beam_{kind}_hardening_modulus", np.nan) == 0)
    return affected


_STEPS = {
    "leapfrog": "the square of the spacing (leapfrog)",
    "modal": "the spacing (modal scheme)",
    "timoshenko": "the spacing (Timoshenko beam)",
    "von_karman": "the square of the spacing, coarse grids the spacing (von Karman's beam)",
}
"""What the time step follows, by the scheme of bending beams or the model of others."""


def coupling(runs: xr.Dataset) -> str:
    """Describe what is refined along with the spacing; "" if the time step is independent of it."""
    models, schemes = (
        np.unique(runs.coords[name].values).tolist() if name in runs.coords else []
        for name in ("beam_model", "scheme")
    )
    bending = {"euler_bernoulli", "elastic"} & set(models)
    tied = [_STEPS[scheme] for scheme in schemes if bending]
    tied += [_STEPS[model] for model in models if model in _STEPS]
    if not tied:
        return ""
    held = "each courant" if "courant" in runs.dims else "the same courant"
    return (
        f"At {held} the time step shrinks with {' or '.join(tied)}: the order is that of space and "
        "time together. Vary courant at fixed nodes to see time alone."
    )


NODES = Axis(
    "nodes",
    "the nodes",
    {"nodes": lambda nodes: 1.0 / (nodes - 1.0)},
    coupling,
    Growth(
        "in a beam that does not harden, plastic strain gathers at the node that is struck: its "
        "peak grows with the nodes, up to twice as much with each halving of the spacing",
        _beams_that_do_not_harden,
    ),
)
"""spacing = span/(nodes - 1)."""

TIME_STEP = Axis(
    "time_step",
    "the time step",
    {"courant": lambda courant: courant},
    lambda runs: (
        "The nodes stay the same, so that the order is that of time alone; the limit is the answer "
        "of these nodes at an infinitesimal time step, not that of the beam."
    ),
)
"""The time step is proportional to courant."""
