"""The cost of a run, estimated before it is made."""

from __future__ import annotations

from typing import Any

import numpy as np

from impactlab.model.section import section_of
from impactlab.solver import BEAM_MODELS, SCHEMES

A_SECOND = 3e8
"""Node-steps per second of one core; half of it or twice is possible."""
SOLVED = 0.5
"""Share of the nodes that the kernels solve: those of half the beam (solver/beam.py)."""


def node_steps(cases: Any) -> Any:
    """Return the estimated cost per run: half the nodes times the time steps.

    cases: a record of solver.types.CASE, or an array of them. Their largest step is that of bending
    for the paper's beam by leapfrog, a bar wave's over a spacing for the modal scheme, and half of
    it, roughly, for the other models of the beam.
    """
    dx, section = cases["beam_span"] / (cases["nodes"] - 1), section_of(cases)
    wave = dx * np.sqrt(cases["beam_density"] / cases["beam_youngs_modulus"])
    bending = 0.5 * wave * dx * np.sqrt(section.area / section.second_moment)
    bends = cases["beam_model"] <= BEAM_MODELS.index("elastic")
    modal = cases["scheme"] == SCHEMES.index("modal")
    largest = np.where(modal, wave, np.where(bends, bending, 0.5 * wave))
    return SOLVED * cases["nodes"] * cases["duration"] / (cases["courant"] * largest)


_RATES = (1.0, 1.0, 1.5, 4.0, 4.0)  # cost of a node per step over the paper's, by beam model
_BESIDES = 20.0  # cost of a step beside its nodes, in nodes
_MODE, _MODES_BESIDES = 0.15, 12.0
"""Cost of a mode per step in contact over that of a node, and of a step beside its modes."""
_YIELDING = 1.2
"""Cost of a mode per step with yielding sections, which alone make the modal scheme go step by step
after the contact."""
_CONTACTS = 3.0  # time in contact, sub-impacts and all, over that of Hertz on a half-space
_LUMPED = 1000.0  # steps of a lumped model in the largest one


def work(cases: Any) -> Any:
    """Return the estimated time per run, in node-steps of the paper's beam.

    Beyond `node_steps`, this counts the time step that a light sphere or a stiff contact needs
    (Hertz's stiffness at the indentation that takes all of the sphere's energy) and the cost per
    step of each beam model and scheme. Yielding fibres may cost leapfrog several times as much.
    """
    nodes, model = cases["nodes"], cases["beam_model"]
    lumped = model >= BEAM_MODELS.index("spring_mass")
    radius, mass = cases["sphere_radius"], cases["sphere_mass"]
    hertz, indentation = _hertz(cases)
    stiffness = 1.5 * hertz * np.sqrt(np.minimum(indentation, radius))
    dx = cases["beam_span"] / (nodes - 1)
    node = section_of(cases).mass_per_length(cases["beam_density"]) * dx
    # the largest step of the sphere, and of the beam's middle node if any, on that spring
    step = 2.0 / np.sqrt(stiffness * (1.0 / mass + np.where(lumped, 0.0, 1.0 / node)))
    contact = cases["duration"] / (cases["courant"] * step)
    bending = node_steps(cases) / (SOLVED * nodes)
    steps = 1.0 + np.where(lumped, _LUMPED * contact, np.hypot(bending, contact))
    leapfrog = steps * (SOLVED * nodes * np.take(_RATES, model) + _BESIDES)
    in_contact = _CONTACTS * 2.94 * indentation / cases["velocity"] / cases["duration"]
    touching = SOLVED * nodes * _MODE + _MODES_BESIDES
    yielding = SOLVED * nodes * _YIELDING + _MODES_BESIDES
    # A beam that is given the velocity v at a point has there the strain sqrt(3) v/c, c of a bar
    # wave (Boussinesq). The share of steps in which sections yield, or are about to, grows from
    # none where this yields to all at four times it, as fitted to measured times.
    stress = np.sqrt(3.0 * cases["beam_density"] * cases["beam_youngs_modulus"]) * cases["velocity"]
    beyond = np.clip((stress / cases["beam_yield_stress"] - 1.0) / 3.0, 0.0, 1.0)
    share = np.where(model == BEAM_MODELS.index("elastic"), 0.0, beyond * beyond)
    modal = np.minimum(in_contact, 1.0) * touching + share * yielding
    return np.where(cases["scheme"] == SCHEMES.index("modal"), steps * modal, leapfrog)


def contact_time(cases: Any) -> Any:
    """Return an upper estimate of the time in contact of a run, or of each, in s."""
    _, indentation = _hertz(cases)
    return _CONTACTS * 2.94 * indentation / cases["velocity"]


def swing(cases: Any) -> Any:
    """Return an upper estimate of the time in s in which sphere and beam swing once, of each run.

    That is the period of one mass on the bending stiffness, with 17/35 of the mass of a beam that
    is struck at mid-span (Cox), and the time in which a plastic hinge there stops the sphere. A
    rigid beam does not swing.
    """
    span, section = cases["beam_span"], section_of(cases)
    stiffness = 48.0 * section.bending_stiffness(cases["beam_youngs_modulus"]) / span**3
    beam = section.mass_per_length(cases["beam_density"]) * span
    mass = cases["sphere_mass"] + 17.0 / 35.0 * beam
    yields = cases["beam_model"] != BEAM_MODELS.index("elastic")
    collapse = 4.0 * cases["beam_yield_stress"] * section.plastic_modulus / span
    hinge = yields * cases["sphere_mass"] * cases["velocity"] / collapse
    period = 2.0 * np.pi * np.sqrt(mass / stiffness)
    return np.where(cases["beam_model"] == BEAM_MODELS.index("rigid"), 0.0, period + hinge)


def _hertz(cases: Any) -> tuple[Any, Any]:
    """Return Hertz's F/d^1.5, and the indentation that takes all of the sphere's energy; SI."""
    compliance = sum(
        (1.0 - cases[f"{body}_poissons_ratio"] ** 2) / cases[f"{body}_youngs_modulus"]
        for body in ("sphere", "beam")
    )
    hertz = 4.0 / 3.0 / compliance * np.sqrt(cases["sphere_radius"])
    return hertz, (1.25 * cases["sphere_mass"] * cases["velocity"] ** 2 / hertz) ** 0.4


def memory(cases: Any) -> Any:
    """Return the estimated memory of the march per run, in bytes."""
    modes = np.where(cases["scheme"] == SCHEMES.index("modal"), 2.0 * cases["nodes"], 0.0)
    return cases["nodes"] * (80.0 + 4.0 * cases["points"] + modes)
