"""The beam models' answers to the same impact, and each response beside the 3-D FE model's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model import cost
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.simulate import case_table, simulate, solve
from impactlab.variables import RESPONSES, UNLIKE, attributes, status_bits

MODELS = ("euler_bernoulli", "timoshenko", "spring_mass")
"""In the order of tables and figures."""
_COARSE = 101
"""Nodes that resolve the duration of a contact within some percent."""


def simulate_beams(impact: Impact, discretisation: Discretisation, duration: float) -> xr.Dataset:
    """Return the answers of `simulate` for each of MODELS, on the dimension `beam_model`.

    All take the leapfrog scheme, the only one that they share. duration: in s.
    """
    grid = replace(discretisation, scheme="leapfrog")
    runs = [
        simulate(replace(impact, beam_model=model), grid, duration=duration) for model in MODELS
    ]
    return xr.concat(runs, "beam_model", combine_attrs="override")


def beam_seconds(impact: Impact, discretisation: Discretisation, duration: float) -> float:
    """Return about how long `simulate_beams` takes, in s."""
    grid = replace(discretisation, scheme="leapfrog")
    tables = [
        case_table(replace(impact, beam_model=model), grid, duration=duration) for model in MODELS
    ]
    return float(sum(cost.work(table).sum() for table in tables) / cost.A_SECOND)


def first_contact(impact: Impact, discretisation: Discretisation, longest: float) -> float:
    """Return the duration of the Euler-Bernoulli beam's first contact in s; NaN beyond `longest`.

    Roughly: on a coarse grid, which is quick for any duration.
    """
    plain = replace(impact, beam_model=MODELS[0])
    nodes = min(discretisation.nodes, _COARSE)
    grid = replace(discretisation, nodes=nodes, scheme="leapfrog")
    answers = solve(case_table(plain, grid, duration=longest))
    return float(answers.responses[0]["contact_duration"])


SOLID = "solid"
"""Name of the 3-D FE model among the beam models."""
COUNTS = ("number_of_contacts",)


def compared(solid: xr.Dataset, beams: xr.Dataset) -> xr.Dataset:
    """Return `value` and `difference` on (response, model), and `status` on (model).

    value: in SI units, as `units` (response) has them; NaN where a model gives none, and `status`
    says why. difference: relative to the 3-D FE model; NaN for responses that are UNLIKE and for
    COUNTS.
    """
    names = [name for name in RESPONSES if name in solid]
    models = [SOLID, *beams["beam_model"].values.tolist()]
    value = np.array([[*_valid(solid, name), *_valid(beams, name)] for name in names])
    with np.errstate(divide="ignore", invalid="ignore"):
        difference = value / value[:, :1] - 1.0
    difference[~np.isfinite(difference)] = np.nan
    difference[:, 0] = np.nan
    difference[[name in UNLIKE or name in COUNTS for name in names]] = np.nan
    status = [*np.atleast_1d(solid["status"]), *beams["status"].values]
    return xr.Dataset(
        {
            "value": (("response", "model"), value),
            "difference": (("response", "model"), difference),
            "status": ("model", np.array(status, dtype=np.int32)),
        },
        coords={
            "response": names,
            "model": models,
            "units": ("response", [attributes(name)["units"] for name in names]),
        },
    )


def _valid(runs: xr.Dataset, name: str) -> list[float]:
    """Return a response of each run, NaN where the status says that it does not hold."""
    sound = (runs["status"] & status_bits([name])) == 0
    values: list[float] = np.atleast_1d(runs[name].where(sound).values).astype(float).tolist()
    return values
