"""The beam models' answers to the same impact."""

from __future__ import annotations

from dataclasses import replace

import xarray as xr

from impactlab.model import cost
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.simulate import case_table, simulate, solve

MODELS = ("euler_bernoulli", "timoshenko", "spring_mass")
"""In the order of tables and figures."""
_COARSE = 101
"""Nodes that tell the duration of a contact within some percent."""


def beams(impact: Impact, discretisation: Discretisation, duration: float) -> xr.Dataset:
    """What `simulate` gives for each of MODELS, on the dimension `beam_model`.

    All take the leapfrog scheme, the only one that they share. duration: in s.
    """
    grid = replace(discretisation, scheme="leapfrog")
    runs = [
        simulate(replace(impact, beam_model=model), grid, duration=duration) for model in MODELS
    ]
    return xr.concat(runs, "beam_model", combine_attrs="override")


def beam_seconds(impact: Impact, discretisation: Discretisation, duration: float) -> float:
    """About how long `beams` takes, in s."""
    grid = replace(discretisation, scheme="leapfrog")
    tables = [
        case_table(replace(impact, beam_model=model), grid, duration=duration) for model in MODELS
    ]
    return float(sum(cost.work(table).sum() for table in tables) / cost.A_SECOND)


def first_contact(impact: Impact, discretisation: Discretisation, longest: float) -> float:
    """Duration of the Euler-Bernoulli beam's first contact in s; NaN if it outlasts `longest`.

    Roughly: on a coarse grid, which is quick for any duration.
    """
    plain = replace(impact, beam_model=MODELS[0])
    nodes = min(discretisation.nodes, _COARSE)
    grid = replace(discretisation, nodes=nodes, scheme="leapfrog")
    answers = solve(case_table(plain, grid, duration=longest))
    return float(answers.responses[0]["contact_duration"])
