"""Symmetries of the model: similarity and systems of units, and reversal of time."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import PARAMETERS, flatten, with_values
from impactlab.simulate import case_table, simulate
from impactlab.solver.beam import Beam, Grid, make_beam, move_virgin, strike
from impactlab.solver.contact import LAWS
from impactlab.solver.contact.history import CONTACT, Pair, force, make_pair
from impactlab.solver.section import Section, make_section
from impactlab.solver.stability import discretise
from impactlab.types import Floats
from impactlab.variables import HISTORIES, PROFILES, RESPONSES
from impactlab.verification.cases import elastic, with_beam_material
from impactlab.verification.finding import (
    Check,
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    curve,
    worst,
)

_DIMENSIONS = {
    "kg": (1, 0, 0),
    "m": (0, 1, 0),
    "s": (0, 0, 1),
    "N": (1, 1, -2),
    "Pa": (1, -1, -2),
    "J": (1, 2, -2),
}
"""Powers of mass, length and time in each unit."""

_SCALED_GRID = Discretisation(nodes=101, points=21)
_SCALED_DURATION = 2e-3
SCALED_TOLERANCE = 1e-9
"""Round-off, the only allowed effect of the scale."""


@dataclass(frozen=True)
class Scale:
    """Factors on every mass, length and time."""

    mass: float
    length: float
    time: float

    def factor(self, units: str) -> float:
        """Return the factor on a quantity in `units` (UDUNITS, as in impactlab.variables)."""
        powers = np.zeros(3)
        for name, power in re.findall(r"([A-Za-z]+)(-?\d*)", units):
            powers += np.array(_DIMENSIONS[name]) * int(power or 1)
        return float(np.prod(np.array([self.mass, self.length, self.time]) ** powers))

    def impact(self, impact: Impact) -> Impact:
        """Return `impact` with each of its parameters scaled."""
        values = {
            name: value * self.factor(PARAMETERS[name].units)
            for name, value in flatten(impact, _SCALED_GRID).items()
            if PARAMETERS[name].units != "1" and not isinstance(value, str)
        }
        return with_values(impact, _SCALED_GRID, values)[0]


def same_speed(size: float) -> Scale:
    """Scale lengths and times by `size`, hence forces by size^2; materials and velocity stay."""
    return Scale(size**3, size, size)


def other_material(stiffness: float, density: float) -> Scale:
    """Scale pressures by `stiffness`, densities by `density`, velocities by the ratio's root."""
    return Scale(density, 1.0, math.sqrt(density / stiffness))


SCALES = {
    "a scale model, 1 to 7": same_speed(1.0 / 7.0),
    "a scale model, 30 to 1": same_speed(30.0),
    "moduli by 0.3, densities by 1.7": other_material(0.3, 1.7),
    "in t, mm and s": Scale(1e-3, 1e3, 1.0),
    "in g, cm and us": Scale(1e3, 1e2, 1e6),
}


def yielding(contact: str) -> Impact:
    """Return the paper's case at 15 m/s with both kinds of hardening: sub-impacts while yielding.

    With gravity, which scales as every acceleration does.
    """
    return with_beam_material(
        paper_impact(15.0, contact),
        isotropic_hardening_modulus=5e9,
        kinematic_hardening_modulus=3e9,
    )


def check_similarity() -> Finding:
    """Compare every response, history and profile of the scaled impact with the original.

    The independent part is dimensional analysis: a constant with a unit, hidden in the code, would
    break it.
    """
    found: list[Comparison] = []
    for contact in LAWS:
        impact = yielding(contact)
        run = simulate(impact, _SCALED_GRID, duration=_SCALED_DURATION)
        for name, scale in SCALES.items():
            found += _compare(f"{contact}, {name}", run, _scaled(impact, scale), scale)
    return Finding(found, [_scaled_panel()])


SIMILARITY = Check(
    "similarity",
    "Similarity and units",
    "Buckingham, Phys. Rev. 4 (1914) 345: on physically similar systems",
    check_similarity,
)


def _scaled(impact: Impact, scale: Scale) -> xr.Dataset:
    return simulate(
        scale.impact(impact), _SCALED_GRID, duration=_SCALED_DURATION * scale.factor("s")
    )


def _compare(where: str, run: xr.Dataset, scaled: xr.Dataset, scale: Scale) -> list[Comparison]:
    """Compare the worst of the responses, and the worst of the curves."""
    responses = [_response(name, where, run, scaled, scale) for name in RESPONSES]
    curves = [
        curve(
            f"worst curve: {entry.long_name}",
            where,
            entry.units,
            scaled[name].values.ravel() / scale.factor(entry.units),
            run[name].values.ravel(),
            SCALED_TOLERANCE,
        )
        for name, entry in (HISTORIES | PROFILES).items()
    ]
    return [worst(responses), worst(curves)]


def _response(
    name: str, where: str, run: xr.Dataset, scaled: xr.Dataset, scale: Scale
) -> Comparison:
    """Compare a response by the difference over its scale; missing in both runs is no error."""
    entry = RESPONSES[name]
    expected, ours = run[name].item(), scaled[name].item() / scale.factor(entry.units)
    error = (ours - expected) / _yardsticks(run).get(name, abs(expected) or 1.0)
    if math.isnan(ours) and math.isnan(expected):
        error = 0.0
    quantity = f"worst response: {entry.long_name}"
    return Comparison(
        quantity, where, entry.units, ours, expected, error, SCALED_TOLERANCE, "of its yardstick"
    )


def _yardsticks(run: xr.Dataset) -> Mapping[str, float]:
    """Return the scales of answers that are small differences of large ones."""
    energy = float(0.5 * run.sphere_mass * run.velocity**2)
    return {
        "contact_dissipation": energy,
        "plastic_dissipation": energy,
        "energy_error": 1.0,
    }


def _scaled_panel() -> Panel:
    impact = yielding("stronge")
    curves = []
    for name, scale in {"the impact": Scale(1.0, 1.0, 1.0), **SCALES}.items():
        run = _scaled(impact, scale)
        time, force = run.time.values / scale.factor("s"), run.contact_force.values
        curves.append(Curve(name, time, force / scale.factor("N"), name == "the impact"))
    return Panel("scaled back", ("time", "s"), ("contact force", "N"), curves)


_REVERSED_GRID = Discretisation(nodes=201, points=3)
_REVERSED_DURATION = 0.5e-3
REVERSED_TOLERANCE = 1e-9


@dataclass
class State:
    """The beam, and the row of its w that is now; the sphere's w_s and u_s = dt w_s' (m)."""

    beam: Beam
    now: int
    w_s: float
    u_s: float

    @property
    def w(self) -> Floats:
        """Deflection in m, as in solver.beam, (n + 4,)."""
        return np.asarray(self.beam.w[self.now])


@dataclass(frozen=True)
class March:
    """The kernels' own beam and contact, one step at a time.

    simulate() begins at first touch only; here the motion may begin anywhere.
    """

    impact: Impact
    grid: Grid
    pair: Pair
    section: Section
    steps: int

    def step(self, state: State) -> float:
        """Advance by one step; return the force (N) at its beginning."""
        contact = np.zeros(1, CONTACT)  # Hertz contact has no memory
        contact[0].n = 1.5
        newtons = float(force(contact[0], self.pair, state.w_s - state.w[self.grid.mid]))
        w, u, now = state.beam.w, state.beam.u, state.now
        move_virgin(w, now, u, 2, self.grid.mid + 1, self.grid, self.section.yield_curvature)
        strike(w, now, u, newtons, self.grid)
        gravity = self.impact.gravity - newtons / self.impact.sphere.total_mass
        state.u_s += self.grid.dt**2 * gravity
        state.w_s += state.u_s
        state.now = 1 - now
        return newtons

    def run(self, state: State) -> Floats:
        """Advance by all steps; return the force (N) at the beginning of each, shape (steps,)."""
        return np.array([self.step(state) for _ in range(self.steps)])

    def turn(self, state: State) -> None:
        """Reverse all velocities at the present positions."""
        self.step(state)  # for the velocities half a step later
        state.beam.u[:] *= -1.0
        state.u_s *= -1.0
        state.now = 1 - state.now
        state.w_s += state.u_s


def prepare(impact: Impact, grid: Discretisation, duration: float) -> tuple[March, State]:
    """Return the march that simulate() makes, and its state at first touch."""
    case = case_table(impact, grid, duration=duration)[0]
    pair, section = make_pair(case), make_section(case)
    cut, steps = discretise(case, pair, section)
    before = impact.velocity * cut.dt - 0.5 * impact.gravity * cut.dt**2
    return March(impact, cut, pair, section, steps), State(make_beam(cut), 0, 0.0, before)


def check_time_reversal() -> Finding:
    """Compare forces there and, after all velocities are reversed, back; and the final state.

    The march uses the kernels' beam and contact, and is shown to be that of simulate().
    """
    impact = elastic(paper_impact(0.99))
    march, state = prepare(impact, _REVERSED_GRID, _REVERSED_DURATION)
    sphere = state.u_s
    there = march.run(state)
    largest = float(np.max(np.abs(state.w)))
    march.turn(state)
    back = march.run(state)[::-1]
    march.turn(state)
    solver = simulate(impact, _REVERSED_GRID, duration=_REVERSED_DURATION, samples=march.steps + 1)
    where = f"the paper's case, elastic, {march.steps} steps there and back"
    # The force at the turn belongs to the way back, the force at first touch to the way there.
    found = [
        curve(
            "contact force of the march and of simulate()",
            where,
            "N",
            there,
            solver.contact_force.values[:-1],
            REVERSED_TOLERANCE,
        ),
        curve(
            "contact force, back and there", where, "N", back[:-1], there[1:], REVERSED_TOLERANCE
        ),
        *_returned(where, state, sphere, largest),
    ]
    return Finding(found, [_reversed_panel(solver.time.values, there, back)])


TIME_REVERSAL = Check(
    "time_reversal",
    "Time reversal",
    "Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), section V.1: leapfrog and an "
    "elastic law have no arrow of time",
    check_time_reversal,
)


def _returned(where: str, state: State, sphere: float, largest: float) -> list[Comparison]:
    """Compare with the start; sphere: u_s there (m), largest: deflection at the turn (m)."""
    velocity = state.u_s / sphere
    beam = float(np.max(np.abs(state.beam.u))) / sphere
    return [
        absolute("sphere's velocity over the first", where, "1", velocity, 1.0, REVERSED_TOLERANCE),
        absolute(
            "sphere's place over deflection",
            where,
            "1",
            state.w_s / largest,
            0.0,
            REVERSED_TOLERANCE,
        ),
        absolute("beam's velocity over the sphere's", where, "1", beam, 0.0, REVERSED_TOLERANCE),
        absolute(
            "deflection left over the largest",
            where,
            "1",
            float(np.max(np.abs(state.w))) / largest,
            0.0,
            REVERSED_TOLERANCE,
        ),
    ]


def _reversed_panel(time: Floats, there: Floats, back: Floats) -> Panel:
    return Panel(
        "the paper's case, elastic",
        ("time since first touch", "s"),
        ("contact force", "N"),
        [
            Curve("there", time[:-1], there),
            Curve("back, in reverse", time[1:], back, independent=True),
        ],
    )
