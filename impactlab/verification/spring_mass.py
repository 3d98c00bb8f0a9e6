"""The spring-mass model of the beam under Hertz contact, against a general integrator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact
from impactlab.simulate import simulate
from impactlab.verification.cases import elastic
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
from impactlab.verification.solutions import lumped, modal, spring_mass
from impactlab.verification.solutions.lumped import LumpedSolution

TITLE = "Spring-mass model"
SOURCE = (
    "Rayleigh's mass 17/35 rho A L and stiffness 48 EI/L^3, DOP853 of scipy, in "
    "impactlab.verification.solutions.spring_mass"
)

HISTORIES = {
    "contact_force": ("contact force", "N"),
    "midspan_deflection": ("mid-span deflection", "m"),
    "sphere_displacement": ("displacement of the sphere", "m"),
    "indentation": ("indentation", "m"),
}
TOLERANCE = 2e-6
COURANTS = (1.0, 0.5)
_GRID = Discretisation(nodes=101, points=3)
_SAMPLES = 401


@dataclass(frozen=True)
class Case:
    """An impact to be tried at several velocities (m/s), each over `duration` (s)."""

    impact: Impact
    velocities: tuple[float, ...]
    duration: float


def _slender() -> Impact:
    """A heavy sphere on a slender beam: it touches more than once."""
    impact = paper_impact()
    return replace(impact, beam=replace(impact.beam, depth=0.008, width=0.02))


CASES = {
    "the paper's beam": Case(elastic(paper_impact()), (0.1, 0.99, 5.0, 20.0), 0.5e-3),
    "a slender beam": Case(elastic(_slender()), (0.2, 1.0), 20e-3),
}


def check() -> Finding:
    """Histories, responses, the curvature of the static shape, and the order in the time step."""
    found: list[Comparison] = []
    for beam, case in CASES.items():
        table = [_compare(beam, case, velocity) for velocity in case.velocities]
        found += map(worst, zip(*table, strict=True))
    return Finding([*found, _order()], [_panel()])


def run(impact: Impact, duration: float, courant: float = 0.5) -> xr.Dataset:
    """The solver's spring-mass model over `duration` (s)."""
    model, grid = replace(impact, beam_model="spring_mass"), replace(_GRID, courant=courant)
    return simulate(model, grid, duration=duration, samples=_SAMPLES)


def _compare(beam: str, case: Case, velocity: float) -> list[Comparison]:
    impact, where = replace(case.impact, velocity=velocity), f"{beam}, {velocity:g} m/s"
    ours, exact = run(impact, case.duration), spring_mass.solve(impact, case.duration)
    return [
        *(_history(name, where, ours, exact) for name in HISTORIES),
        _curvature(impact, where, ours, exact),
        *_responses(where, ours, exact),
    ]


def _history(name: str, where: str, ours: xr.Dataset, exact: LumpedSolution) -> Comparison:
    (quantity, units), expected = HISTORIES[name], exact.at(name, ours.time.values)
    label = f"history of {quantity}"
    return curve(label, where, units, ours[name].values, expected, TOLERANCE)


def _curvature(impact: Impact, where: str, ours: xr.Dataset, exact: LumpedSolution) -> Comparison:
    """-12 w/L^2; the static shape of the finite differences has (1 - 2/(nodes - 1)^2) of it."""
    w = exact.at("midspan_deflection", ours.time.values)
    expected = spring_mass.midspan_curvature(impact.beam, 1.0) * w
    label, tolerance = "history of mid-span curvature", 2.5 / (_GRID.nodes - 1) ** 2
    return curve(label, where, "m-1", ours.midspan_curvature.values, expected, tolerance)


def _responses(where: str, ours: xr.Dataset, exact: LumpedSolution) -> list[Comparison]:
    numbers = {
        "peak_force": ("N", exact.peak_force),
        "contact_duration": ("s", exact.contact_duration),
    }
    contacts = float(len(exact.contacts))
    return [
        *(
            relative(name.replace("_", " "), where, units, ours[name].item(), expected, TOLERANCE)
            for name, (units, expected) in numbers.items()
        ),
        absolute("number of contacts", where, "1", ours.number_of_contacts.item(), contacts, 0.0),
    ]


def _order() -> Comparison:
    case = CASES["the paper's beam"]
    exact = spring_mass.solve(case.impact, case.duration)
    errors = [_error(run(case.impact, case.duration, courant), exact) for courant in COURANTS]
    observed = float(np.log2(errors[0] / errors[1]))
    label, where = "order of convergence in the time step", "the paper's beam, 0.99 m/s"
    return absolute(label, where, "1", observed, 2.0, 0.1)


def _error(ours: xr.Dataset, exact: LumpedSolution) -> float:
    """Root mean square of the indentation's error, in m."""
    gap = ours.indentation.values - exact.at("indentation", ours.time.values)
    return float(np.sqrt(np.mean(gap**2)))


def _panel() -> Panel:
    """What the model leaves out, too: its mass resists all at once, the beam's by and by."""
    case = CASES["the paper's beam"]
    ours, time = run(case.impact, case.duration), np.linspace(0.0, case.duration, _SAMPLES)
    rivals: Mapping[str, lumped.LumpedSolution | modal.ModalSolution] = {
        "spring-mass model, DOP853": spring_mass.solve(case.impact, case.duration),
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
