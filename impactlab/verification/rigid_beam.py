"""The rigid beam: Hertz's and Stronge's closed forms, and gravity by a general integrator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact
from impactlab.simulate import simulate
from impactlab.verification.finding import (
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    curve,
    relative,
    worst,
)
from impactlab.verification.solutions import hertz, rigid_beam
from impactlab.verification.solutions.stronge import stronge_impact

TITLE = "Rigid beam"
SOURCE = (
    "Hertz 1881; Stronge, Impact Mechanics (2000), section 6.4; DOP853 of scipy, in "
    "impactlab.verification.solutions.hertz, .stronge and .rigid_beam"
)

VELOCITIES = (0.1, 0.99, 5.0, 20.0)
"""In m/s."""
SLOW = 0.02
"""In m/s: gravity adds 11 % to the peak force."""
TOLERANCE = 5e-6
_GRID = Discretisation(nodes=11, points=3)


def check() -> Finding:
    """Hertz's and Stronge's impact at four velocities, and a slow one under gravity."""
    hertzian = [_against_hertz(velocity) for velocity in VELOCITIES]
    plastic = [_against_stronge(velocity) for velocity in VELOCITIES]
    found = [
        worst(entries) for table in (hertzian, plastic) for entries in zip(*table, strict=True)
    ]
    slow, panel = _under_gravity()
    return Finding([*found, *slow], [panel])


def run(impact: Impact, samples: int = 2) -> tuple[xr.Dataset, float]:
    """The solver on a rigid beam, and the time (s) until the sphere has left."""
    modulus, radius = hertz.effective_modulus(impact), hertz.effective_radius(impact)
    args = (impact.sphere.total_mass, impact.velocity, modulus, radius)
    duration = 2.0 * hertz.contact_duration(*args)
    model = replace(impact, beam_model="rigid")
    return simulate(model, _GRID, duration=duration, samples=samples), duration


def _against_hertz(velocity: float) -> list[Comparison]:
    impact = replace(paper_impact(velocity, "hertz"), gravity=0.0)
    modulus, radius = hertz.effective_modulus(impact), hertz.effective_radius(impact)
    args = (impact.sphere.total_mass, velocity, modulus, radius)
    ours, _ = run(impact)
    where = f"Hertz contact, {velocity:g} m/s"
    return [
        *_relative(
            ours,
            where,
            ("peak_force", "N", hertz.peak_force(*args)),
            ("contact_duration", "s", hertz.contact_duration(*args)),
            ("maximum_indentation", "m", hertz.maximum_indentation(*args)),
            ("restitution", "1", 1.0),
        ),
        absolute("deflection", where, "m", ours.maximum_deflection.item(), 0.0, 0.0),
    ]


def _against_stronge(velocity: float) -> list[Comparison]:
    impact = replace(paper_impact(velocity, "stronge"), gravity=0.0)
    law, mass = stronge_impact(impact), impact.sphere.total_mass
    ours, _ = run(impact)
    return _relative(
        ours,
        f"Stronge contact, {velocity:g} m/s",
        ("peak_force", "N", law.peak_force(velocity, mass)),
        ("maximum_indentation", "m", law.maximum_indentation(velocity, mass)),
        ("restitution", "1", law.restitution(velocity, mass)),
    )


def _under_gravity() -> tuple[list[Comparison], Panel]:
    impact = paper_impact(SLOW, "hertz")
    ours, duration = run(impact, samples=401)
    exact, bare = (rigid_beam.solve(replace(impact, gravity=g), duration) for g in (9.81, 0.0))
    where, time = f"Hertz contact under gravity, {SLOW:g} m/s", ours.time.values
    force, expected = ours.contact_force.values, exact.at("contact_force", time)
    responses = _relative(
        ours,
        where,
        ("peak_force", "N", exact.peak_force),
        ("contact_duration", "s", exact.contact_duration),
    )
    history = curve("history of contact force", where, "N", force, expected, TOLERANCE)
    panel = Panel(
        f"the paper's sphere on a rigid beam, {SLOW:g} m/s",
        ("time", "s"),
        ("contact force", "N"),
        [
            Curve("solver", time, force),
            Curve("DOP853", time, np.asarray(expected), independent=True),
            Curve("DOP853 without gravity", time, bare.at("contact_force", time), True),
        ],
    )
    return [history, *responses], panel


def _relative(ours: xr.Dataset, where: str, *expected: tuple[str, str, float]) -> list[Comparison]:
    return [
        relative(name.replace("_", " "), where, units, ours[name].item(), value, TOLERANCE)
        for name, units, value in expected
    ]
