"""An elastic impact, run backwards from its end: the leapfrog is reversible in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact
from impactlab.simulate import case_table, simulate
from impactlab.solver.beam import Beam, Grid, make_beam, move_virgin, strike
from impactlab.solver.contact.history import CONTACT, Pair, force, make_pair
from impactlab.solver.leapfrog import discretise
from impactlab.solver.section import Section, make_section
from impactlab.verification.cases import elastic
from impactlab.verification.finding import Comparison, Curve, Finding, Panel, absolute, curve

TITLE = "Time reversal"
SOURCE = (
    "Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), section V.1: leapfrog and an "
    "elastic law have no arrow of time"
)

Floats = NDArray[np.float64]

_GRID = Discretisation(nodes=201, points=3)
_DURATION = 0.5e-3
TOLERANCE = 1e-9


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
        """One step on; returns the force (N) at its beginning."""
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
        """All the steps; the force (N) at the beginning of each, shape (steps,)."""
        return np.array([self.step(state) for _ in range(self.steps)])

    def turn(self, state: State) -> None:
        """Turn all velocities round, where the bodies now are."""
        self.step(state)  # for the velocities half a step later
        state.beam.u[:] *= -1.0
        state.u_s *= -1.0
        state.now = 1 - state.now
        state.w_s += state.u_s


def prepare(impact: Impact, grid: Discretisation, duration: float) -> tuple[March, State]:
    """The march that simulate() makes, and its state at first touch."""
    case = case_table(impact, grid, duration=duration)[0]
    pair, section = make_pair(case), make_section(case)
    cut, steps = discretise(case, pair, section)
    before = impact.velocity * cut.dt - 0.5 * impact.gravity * cut.dt**2
    return March(impact, cut, pair, section, steps), State(make_beam(cut), 0, 0.0, before)


def check() -> Finding:
    """There, turned round, back: the same forces in reverse, and the sphere as it came.

    The march uses the kernels' beam and contact, and is shown to be that of simulate().
    """
    impact = elastic(paper_impact(0.99))
    march, state = prepare(impact, _GRID, _DURATION)
    sphere = state.u_s
    there = march.run(state)
    largest = float(np.max(np.abs(state.w)))
    march.turn(state)
    back = march.run(state)[::-1]
    march.turn(state)
    solver = simulate(impact, _GRID, duration=_DURATION, samples=march.steps + 1)
    where = f"the paper's case, elastic, {march.steps} steps there and back"
    # the force at the turning point belongs to the way back, that at first touch to the way there
    found = [
        curve(
            "contact force of the march and of simulate()",
            where,
            "N",
            there,
            solver.contact_force.values[:-1],
            TOLERANCE,
        ),
        curve("contact force, back and there", where, "N", back[:-1], there[1:], TOLERANCE),
        *_returned(where, state, sphere, largest),
    ]
    return Finding(found, [_panel(solver.time.values, there, back)])


def _returned(where: str, state: State, sphere: float, largest: float) -> list[Comparison]:
    """Against the start; sphere: u_s there (m), largest: the deflection when it turned (m)."""
    velocity = state.u_s / sphere
    beam = float(np.max(np.abs(state.beam.u))) / sphere
    return [
        absolute("sphere's velocity over the first", where, "1", velocity, 1.0, TOLERANCE),
        absolute("sphere's place over deflection", where, "1", state.w_s / largest, 0.0, TOLERANCE),
        absolute("beam's velocity over the sphere's", where, "1", beam, 0.0, TOLERANCE),
        absolute(
            "deflection left over the largest",
            where,
            "1",
            float(np.max(np.abs(state.w))) / largest,
            0.0,
            TOLERANCE,
        ),
    ]


def _panel(time: Floats, there: Floats, back: Floats) -> Panel:
    return Panel(
        "the paper's case, elastic",
        ("time since first touch", "s"),
        ("contact force", "N"),
        [
            Curve("there", time[:-1], there),
            Curve("back, in reverse", time[1:], back, independent=True),
        ],
    )
