"""The spring-mass model and the rigid beam, against closed forms and a general integrator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import simulate
from impactlab.verification.cases import Case, elastic
from impactlab.verification.finding import (
    Check,
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    curve,
    relative,
    worst,
)
from impactlab.verification.solutions import hertz, lumped, modal
from impactlab.verification.solutions.lumped import LumpedSolution
from impactlab.verification.solutions.stronge import stronge_impact

HISTORIES = {
    "contact_force": ("contact force", "N"),
    "midspan_deflection": ("mid-span deflection", "m"),
    "sphere_displacement": ("displacement of the sphere", "m"),
    "indentation": ("indentation", "m"),
}
SPRING_MASS_TOLERANCE = 2e-6
COURANTS = (1.0, 0.5)
_SPRING_MASS_GRID = Discretisation(nodes=101, points=3)
_SAMPLES = 401


def _slender() -> Impact:
    """Return a heavy sphere on a slender beam, which it touches more than once."""
    impact = paper_impact()
    return replace(impact, beam=replace(impact.beam, depth=0.008, width=0.02))


CASES = {
    "the paper's beam": Case(elastic(paper_impact()), (0.1, 0.99, 5.0, 20.0), 0.5e-3),
    "a slender beam": Case(elastic(_slender()), (0.2, 1.0), 20e-3),
}


def check_spring_mass() -> Finding:
    """Compare histories, responses, the curvature, and the order in the time step."""
    found: list[Comparison] = []
    for beam, case in CASES.items():
        table = [_compare(beam, case, velocity) for velocity in case.velocities]
        found += map(worst, zip(*table, strict=True))
    return Finding([*found, _order()], [_panel()])


SPRING_MASS = Check(
    "spring_mass",
    "Spring-mass model",
    "Rayleigh's mass 17/35 rho A L and stiffness 48 EI/L^3, DOP853 of scipy, in "
    "impactlab.verification.solutions.lumped",
    check_spring_mass,
)


def _run_spring_mass(impact: Impact, duration: float, courant: float = 0.5) -> xr.Dataset:
    """Solve the spring-mass model over `duration` (s)."""
    model, grid = (
        replace(impact, beam_model="spring_mass"),
        replace(_SPRING_MASS_GRID, courant=courant),
    )
    return simulate(model, grid, duration=duration, samples=_SAMPLES)


def _compare(beam: str, case: Case, velocity: float) -> list[Comparison]:
    impact, where = replace(case.impact, velocity=velocity), f"{beam}, {velocity:g} m/s"
    ours, exact = (
        _run_spring_mass(impact, case.duration),
        lumped.solve_spring_mass(impact, case.duration),
    )
    return [
        *(_history(name, where, ours, exact) for name in HISTORIES),
        _curvature(impact, where, ours, exact),
        *_responses(where, ours, exact),
    ]


def _history(name: str, where: str, ours: xr.Dataset, exact: LumpedSolution) -> Comparison:
    (quantity, units), expected = HISTORIES[name], exact.at(name, ours.time.values)
    label = f"history of {quantity}"
    return curve(label, where, units, ours[name].values, expected, SPRING_MASS_TOLERANCE)


def _curvature(impact: Impact, where: str, ours: xr.Dataset, exact: LumpedSolution) -> Comparison:
    """Compare with -12 w/L^2, of which the finite differences have (1 - 2/(nodes - 1)^2)."""
    w = exact.at("midspan_deflection", ours.time.values)
    expected = lumped.midspan_curvature(impact.beam, 1.0) * w
    label, tolerance = "history of mid-span curvature", 2.5 / (_SPRING_MASS_GRID.nodes - 1) ** 2
    return curve(label, where, "m-1", ours.midspan_curvature.values, expected, tolerance)


def _responses(where: str, ours: xr.Dataset, exact: LumpedSolution) -> list[Comparison]:
    numbers = {
        "peak_force": ("N", exact.peak_force),
        "contact_duration": ("s", exact.contact_duration),
    }
    contacts = float(len(exact.contacts))
    return [
        *(
            relative(
                name.replace("_", " "),
                where,
                units,
                ours[name].item(),
                expected,
                SPRING_MASS_TOLERANCE,
            )
            for name, (units, expected) in numbers.items()
        ),
        absolute("number of contacts", where, "1", ours.number_of_contacts.item(), contacts, 0.0),
    ]


def _order() -> Comparison:
    case = CASES["the paper's beam"]
    exact = lumped.solve_spring_mass(case.impact, case.duration)
    errors = [
        _error(_run_spring_mass(case.impact, case.duration, courant), exact) for courant in COURANTS
    ]
    observed = float(np.log2(errors[0] / errors[1]))
    label, where = "order of convergence in the time step", "the paper's beam, 0.99 m/s"
    return absolute(label, where, "1", observed, 2.0, 0.1)


def _error(ours: xr.Dataset, exact: LumpedSolution) -> float:
    """Return the root mean square of the indentation's error, in m."""
    gap = ours.indentation.values - exact.at("indentation", ours.time.values)
    return float(np.sqrt(np.mean(gap**2)))


def _panel() -> Panel:
    """Draw the model, its integral, and the elastic beam, whose mass resists only gradually."""
    case = CASES["the paper's beam"]
    ours, time = (
        _run_spring_mass(case.impact, case.duration),
        np.linspace(0.0, case.duration, _SAMPLES),
    )
    rivals: Mapping[str, LumpedSolution | modal.ModalSolution] = {
        "spring-mass model, DOP853": lumped.solve_spring_mass(case.impact, case.duration),
        "elastic beam, modal series": modal.solve(case.impact, case.duration),
    }
    return Panel(
        "the paper's beam, 0.99 m/s",
        ("time", "s"),
        ("contact force", "N"),
        [
            Curve("spring-mass model", time, ours.contact_force.values),
            *(Curve(label, time, s.at("contact_force", time), True) for label, s in rivals.items()),
        ],
    )


VELOCITIES = (0.1, 0.99, 5.0, 20.0)
"""In m/s."""
SLOW = 0.02
"""In m/s: gravity adds 11 % to the peak force."""
RIGID_TOLERANCE = 5e-6
_RIGID_GRID = Discretisation(nodes=11, points=3)


def check_rigid_beam() -> Finding:
    """Compare Hertz's and Stronge's impact at four velocities, and a slow one under gravity."""
    hertzian = [_against_hertz(velocity) for velocity in VELOCITIES]
    plastic = [_against_stronge(velocity) for velocity in VELOCITIES]
    found = [
        worst(entries) for table in (hertzian, plastic) for entries in zip(*table, strict=True)
    ]
    slow, panel = _under_gravity()
    return Finding([*found, *slow], [panel])


RIGID_BEAM = Check(
    "rigid_beam",
    "Rigid beam",
    "Hertz 1881; Stronge, Impact Mechanics (2000), section 6.4; DOP853 of scipy, in "
    "impactlab.verification.solutions.hertz, .stronge and .lumped",
    check_rigid_beam,
)


def _run_rigid_beam(impact: Impact, samples: int = 2) -> tuple[xr.Dataset, float]:
    """Solve on a rigid beam; return the run and the time (s) until the sphere has left."""
    args = hertz.arguments(impact)
    duration = 2.0 * hertz.contact_duration(*args)
    model = replace(impact, beam_model="rigid")
    return simulate(model, _RIGID_GRID, duration=duration, samples=samples), duration


def _against_hertz(velocity: float) -> list[Comparison]:
    impact = replace(paper_impact(velocity, "hertz"), gravity=0.0)
    args = hertz.arguments(impact)
    ours, _ = _run_rigid_beam(impact)
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
    ours, _ = _run_rigid_beam(impact)
    return _relative(
        ours,
        f"Stronge contact, {velocity:g} m/s",
        ("peak_force", "N", law.peak_force(velocity, mass)),
        ("maximum_indentation", "m", law.maximum_indentation(velocity, mass)),
        ("restitution", "1", law.restitution(velocity, mass)),
    )


def _under_gravity() -> tuple[list[Comparison], Panel]:
    impact = paper_impact(SLOW, "hertz")
    ours, duration = _run_rigid_beam(impact, samples=401)
    exact, bare = (
        lumped.solve_rigid_beam(replace(impact, gravity=g), duration) for g in (9.81, 0.0)
    )
    where, time = f"Hertz contact under gravity, {SLOW:g} m/s", ours.time.values
    force, expected = ours.contact_force.values, exact.at("contact_force", time)
    responses = _relative(
        ours,
        where,
        ("peak_force", "N", exact.peak_force),
        ("contact_duration", "s", exact.contact_duration),
    )
    history = curve("history of contact force", where, "N", force, expected, RIGID_TOLERANCE)
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
        relative(name.replace("_", " "), where, units, ours[name].item(), value, RIGID_TOLERANCE)
        for name, units, value in expected
    ]
