"""The spring-mass model and the rigid beam, against closed forms and a general integrator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import simulate
from impactlab.verification.cases import Case, elastic
from impactlab.verification.finding import (
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    check,
    curve,
    responses,
    worst,
)
from impactlab.verification.solutions import hertz, lumped, modal
from impactlab.verification.solutions.stronge import stronge_impact

HISTORIES = {
    "contact_force": ("contact force", "N"),
    "midspan_deflection": ("mid-span deflection", "m"),
    "sphere_displacement": ("displacement of the sphere", "m"),
    "indentation": ("indentation", "m"),
}
SPRING_MASS_TOLERANCE = 2e-6
_NODES, _SAMPLES = 101, 401
_AXES = ("time", "s"), ("contact force", "N")

_PAPER = elastic(paper_impact(0.99))
_SLENDER = replace(_PAPER, beam=replace(_PAPER.beam, depth=0.008, width=0.02))
CASES = {
    "the paper's beam": Case(_PAPER, (0.1, 0.99, 5.0, 20.0), 0.5e-3),
    "a slender beam": Case(_SLENDER, (0.2, 1.0), 20e-3),
}
"""A heavy sphere touches the slender beam more than once."""


@check(
    "Spring-mass model",
    "Rayleigh's mass 17/35 rho A L and stiffness 48 EI/L^3, DOP853 of scipy, in "
    "impactlab.verification.solutions.lumped",
)
def spring_mass() -> Finding:
    """Compare histories, responses, the curvature, and the order in the time step.

    The panel shows the model, its integral, and the elastic beam, whose mass resists only
    gradually.
    """
    found: list[Comparison] = []
    for beam, case in CASES.items():
        table = []
        for velocity in case.velocities:
            impact = replace(case.impact, velocity=velocity)
            table.append(_compare(f"{beam}, {velocity:g} m/s", impact, case.duration))
        found += map(worst, zip(*table, strict=True))
    where, duration = "the paper's beam, 0.99 m/s", CASES["the paper's beam"].duration
    exact = lumped.solve_spring_mass(_PAPER, duration)
    runs = [_run_spring_mass(_PAPER, duration, courant) for courant in (1.0, 0.5)]
    gaps = [run.indentation.values - exact.at("indentation", run.time.values) for run in runs]
    coarse, fine = (float(np.sqrt(np.mean(gap**2))) for gap in gaps)
    label, observed = "order of convergence in the time step", float(np.log2(coarse / fine))
    found.append(absolute(label, where, "1", observed, 2.0, 0.1))
    time = np.linspace(0.0, duration, _SAMPLES)
    series = modal.solve(_PAPER, duration)
    curves = [
        Curve("spring-mass model", time, runs[1].contact_force.values),
        Curve("spring-mass model, DOP853", time, exact.at("contact_force", time), True),
        Curve("elastic beam, modal series", time, series.at("contact_force", time), True),
    ]
    return Finding(found, [Panel(where, *_AXES, curves)])


def _run_spring_mass(impact: Impact, duration: float, courant: float = 0.5) -> xr.Dataset:
    grid = Discretisation(nodes=_NODES, points=3, courant=courant)
    model = replace(impact, beam_model="spring_mass")
    return simulate(model, grid, duration=duration, samples=_SAMPLES)


def _compare(where: str, impact: Impact, duration: float) -> list[Comparison]:
    """Compare one impact; curvature with -12 w/L^2.

    Of that curvature the finite differences have (1 - 2/(nodes - 1)^2).
    """
    run = _run_spring_mass(impact, duration)
    exact, time = lumped.solve_spring_mass(impact, duration), run.time.values
    found = []
    for name, (quantity, units) in HISTORIES.items():
        values = run[name].values, exact.at(name, time)
        label = f"history of {quantity}"
        found.append(curve(label, where, units, *values, SPRING_MASS_TOLERANCE))
    label, tolerance = "history of mid-span curvature", 2.5 / (_NODES - 1) ** 2
    curvature = -12.0 / impact.beam.span**2 * exact.at("midspan_deflection", time)
    found.append(curve(label, where, "m-1", run.midspan_curvature.values, curvature, tolerance))
    expected = {"peak_force": exact.peak_force, "contact_duration": exact.contact_duration}
    found += responses(run, where, expected, SPRING_MASS_TOLERANCE)
    count, contacts = run.number_of_contacts.item(), float(len(exact.contacts))
    return [*found, absolute("number of contacts", where, "1", count, contacts, 0.0)]


VELOCITIES = (0.1, 0.99, 5.0, 20.0)
"""In m/s."""
SLOW = 0.02
"""In m/s: gravity adds 11 % to the peak force."""
RIGID_TOLERANCE = 5e-6


@check(
    "Rigid beam",
    "Hertz 1881; Stronge, Impact Mechanics (2000), section 6.4; DOP853 of scipy, in "
    "impactlab.verification.solutions.hertz, .stronge and .lumped",
)
def rigid_beam() -> Finding:
    """Compare Hertz's and Stronge's impact at four velocities, and a slow one under gravity."""
    hertzian, plastic = [], []
    for velocity in VELOCITIES:
        impact = replace(paper_impact(velocity, "hertz"), gravity=0.0)
        args = hertz.arguments(impact)
        expected = {
            "peak_force": hertz.peak_force(*args),
            "contact_duration": hertz.contact_duration(*args),
            "maximum_indentation": hertz.maximum_indentation(*args),
            "restitution": 1.0,
        }
        where, run = f"Hertz contact, {velocity:g} m/s", _run_rigid_beam(impact)
        deflection = absolute("deflection", where, "m", run.maximum_deflection.item(), 0.0, 0.0)
        hertzian.append([*responses(run, where, expected, RIGID_TOLERANCE), deflection])

        impact = replace(impact, contact="stronge")
        law, mass = stronge_impact(impact), impact.sphere.total_mass
        expected = {
            "peak_force": law.peak_force(velocity, mass),
            "maximum_indentation": law.maximum_indentation(velocity, mass),
            "restitution": law.restitution(velocity, mass),
        }
        where, run = f"Stronge contact, {velocity:g} m/s", _run_rigid_beam(impact)
        plastic.append(responses(run, where, expected, RIGID_TOLERANCE))
    found = [
        worst(entries) for table in (hertzian, plastic) for entries in zip(*table, strict=True)
    ]
    slow, panel = _under_gravity()
    return Finding([*found, *slow], [panel])


def _run_rigid_beam(impact: Impact, samples: int = 2) -> xr.Dataset:
    """Solve on a rigid beam until the sphere has left."""
    model, grid = replace(impact, beam_model="rigid"), Discretisation(nodes=11, points=3)
    duration = 2.0 * hertz.contact_duration(*hertz.arguments(impact))
    return simulate(model, grid, duration=duration, samples=samples)


def _under_gravity() -> tuple[list[Comparison], Panel]:
    impact = paper_impact(SLOW, "hertz")
    run = _run_rigid_beam(impact, samples=401)
    duration, time = run.duration.item(), run.time.values
    exact, bare = (lumped.solve(replace(impact, gravity=g), duration) for g in (9.81, 0.0))
    where = f"Hertz contact under gravity, {SLOW:g} m/s"
    ours, force = run.contact_force.values, exact.at("contact_force", time)
    expected = {"peak_force": exact.peak_force, "contact_duration": exact.contact_duration}
    found = [
        curve("history of contact force", where, "N", ours, force, RIGID_TOLERANCE),
        *responses(run, where, expected, RIGID_TOLERANCE),
    ]
    curves = [
        Curve("solver", time, ours),
        Curve("DOP853", time, force, independent=True),
        Curve("DOP853 without gravity", time, bare.at("contact_force", time), independent=True),
    ]
    return found, Panel(f"the paper's sphere on a rigid beam, {SLOW:g} m/s", *_AXES, curves)
