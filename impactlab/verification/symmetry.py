"""Symmetries of the model: similarity and systems of units, and reversal of time."""

import math
import re
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.model.case_table import case_table
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import PARAMETERS, flatten, with_values
from impactlab.simulate import run_dataset
from impactlab.solve import fibre_section
from impactlab.solver.beam import make_beam, move_virgin, strike
from impactlab.solver.contact import LAWS
from impactlab.solver.contact.history import CONTACT, force, make_pair
from impactlab.solver.contact.switch import DAMPED
from impactlab.solver.modes import make_modes, move_modes
from impactlab.solver.stability import discretise
from impactlab.types import Floats
from impactlab.variables import HISTORIES, PROFILES, RESPONSES
from impactlab.verification.cases import elastic, with_beam_material
from impactlab.verification.finding import (
    ROUNDING,
    Comparison,
    Comparisons,
    Curve,
    CurvePanel,
    Finding,
    Reference,
    check,
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

TOLERANCE = 1e-9  # round-off, the only allowed effect of the scale, and of the way back
_SCALED_GRIDS = {
    "leapfrog": Discretisation(nodes=101, points=21),
    "modal": Discretisation(nodes=41, points=21, scheme="modal"),
}


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

    def simulate(self, impact: Impact, grid: Discretisation) -> xr.Dataset:
        """Simulate `impact` with its parameters, the grid's and the duration scaled."""
        values = {
            name: value * self.factor(PARAMETERS[name].units)
            for name, value in flatten(impact, grid).items()
            if PARAMETERS[name].units != "1" and not isinstance(value, str)
        }
        scaled, _ = with_values(impact, grid, values)
        return run_dataset(scaled, grid, duration=2e-3 * self.factor("s"))


UNSCALED = Scale(1.0, 1.0, 1.0)
# In a model of the same materials and velocity, forces go with the square of the size. Velocities
# go with the root of modulus over density.
SCALES = {
    "a scale model, 1 to 7": Scale((1.0 / 7.0) ** 3, 1.0 / 7.0, 1.0 / 7.0),
    "a scale model, 30 to 1": Scale(30.0**3, 30.0, 30.0),
    "moduli by 0.3, densities by 1.7": Scale(1.7, 1.0, math.sqrt(1.7 / 0.3)),
    "in t, mm and s": Scale(1e-3, 1e3, 1.0),
    "in g, cm and µs": Scale(1e3, 1e2, 1e6),
}


def _yielding(contact: str) -> Impact:
    """Return the paper's case at 15 m/s with both hardenings: sub-impacts while yielding."""
    moduli = {"isotropic_hardening_modulus": 5e9, "kinematic_hardening_modulus": 3e9}
    return with_beam_material(paper_impact(15.0, contact), **moduli)


@check(
    "Similarity and units",
    "Buckingham, Phys. Rev. 4 (1914) 345: on physically similar systems",
    Reference("identity", ROUNDING, "rounding of the scales"),
)
def similarity() -> Finding:
    """Compare every response, history and profile of the scaled impact with the original.

    The independent part is dimensional analysis: a constant with a unit, hidden in the code, would
    break it. A damper's (s/m) is the metal's, so such laws are compared where velocities stay.
    """
    comparisons = Comparisons()
    panels: list[CurvePanel] = []
    for scheme, grid in _SCALED_GRIDS.items():
        curves = []
        for contact in LAWS if scheme == "leapfrog" else ("stronge",):
            impact = _yielding(contact)
            run = UNSCALED.simulate(impact, grid)
            damped = LAWS.index(contact) in DAMPED
            for name, scale in {"the impact": UNSCALED, **SCALES}.items():
                if damped and not math.isclose(scale.factor("m s-1"), 1.0):
                    continue
                scaled, where = scale.simulate(impact, grid), f"{scheme}, {contact}, {name}"
                if scale is not UNSCALED:
                    comparisons += _compare(where, run, scaled, scale)
                if contact == "stronge":
                    time = scaled.time.values / scale.factor("s")
                    newtons = scaled.contact_force.values / scale.factor("N")
                    curves.append(Curve(name, time, newtons, scale is UNSCALED))
        axes = ("time", "s"), ("contact force", "N")
        panels.append(CurvePanel(f"{scheme}, scaled back", *axes, curves))
    return Finding(comparisons, panels)


def _compare(
    where: str, run: xr.Dataset, scaled: xr.Dataset, scale: Scale
) -> tuple[Comparison, Comparison]:
    """Compare the worst of the responses, and the worst of the curves."""
    energy = float(0.5 * run.sphere_mass * run.velocity**2)
    # small differences of large numbers are compared by the scale of those
    yardsticks = {"contact_dissipation": energy, "plastic_dissipation": energy, "energy_error": 1.0}
    answers = []
    for name, entry in RESPONSES.items():
        expected, ours = run[name].item(), scaled[name].item() / scale.factor(entry.units)
        error = (ours - expected) / yardsticks.get(name, abs(expected) or 1.0)
        if math.isnan(ours) and math.isnan(expected):  # missing in both
            error = 0.0
        label, values = f"worst response: {entry.long_name}", (ours, expected, error)
        answers.append(
            Comparison(label, where, entry.units, *values, TOLERANCE, "of its yardstick")
        )
    curves = Comparisons(where)
    for name, entry in (HISTORIES | PROFILES).items():
        ours = scaled[name].values.ravel() / scale.factor(entry.units)
        label = f"worst curve: {entry.long_name}"
        curves.curve(label, entry.units, ours, run[name].values.ravel(), TOLERANCE)
    return worst(answers), worst(curves)


class _March(ABC):
    """The kernels' own beam and contact, one step at a time.

    simulate() begins at first touch only; here the motion may begin anywhere. w: what the beam
    deflects by (m), its nodes' or its modes'; u = dt w'. w_s, u_s: the sphere's. midspan (m).
    """

    w: Floats
    u: Floats
    midspan = 0.0
    w_s = 0.0

    def __init__(self, impact: Impact, discretisation: Discretisation, duration: float) -> None:
        case = case_table(impact, discretisation, duration=duration)[0]
        self.impact, self.pair, self.section = impact, make_pair(case), fibre_section(case)
        self.grid, self.steps = discretise(case, self.pair, self.section)
        self.contact = np.zeros(1, CONTACT)  # Hertz contact has no memory
        self.contact[0].n = 1.5
        self.u_s = impact.velocity * self.grid.dt - 0.5 * impact.gravity * self.grid.dt**2

    @abstractmethod
    def move(self, newtons: float) -> None:
        """Move the beam by a step under a force (N)."""

    @abstractmethod
    def undo(self) -> None:
        """Take w back to the step before, where u has been reversed."""

    def step(self) -> float:
        """Advance by one step; return the force (N) at its beginning."""
        newtons = float(force(self.contact[0], self.pair, self.w_s - self.midspan))
        self.move(newtons)
        gravity = self.impact.gravity - newtons / self.impact.sphere.total_mass
        self.u_s += self.grid.dt**2 * gravity
        self.w_s += self.u_s
        return newtons

    def turn(self) -> None:
        """Reverse all velocities at the present positions."""
        self.step()  # for the velocities half a step later
        self.u *= -1.0
        self.u_s *= -1.0
        self.undo()
        self.w_s += self.u_s


class _LeapfrogMarch(_March):
    def __init__(self, impact: Impact, discretisation: Discretisation, duration: float) -> None:
        super().__init__(impact, discretisation, duration)
        self.beam, self.now = make_beam(self.grid), 0
        self.w, self.u = self.beam.w[0], self.beam.u

    def move(self, newtons: float) -> None:
        w, grid = self.beam.w, self.grid
        move_virgin(w, self.now, self.u, 2, grid.mid + 1, grid, self.section.yield_curvature)
        strike(w, self.now, self.u, newtons, grid)
        self.undo()

    def undo(self) -> None:
        """Turn to the other row of the beam's w: the next step, or the one before."""
        self.now = 1 - self.now
        self.w = self.beam.w[self.now]
        self.midspan = float(self.w[self.grid.mid])


class _ModalMarch(_March):
    def __init__(self, impact: Impact, discretisation: Discretisation, duration: float) -> None:
        super().__init__(impact, discretisation, duration)
        bending = self.section.stiffness, self.section.yield_curvature
        self.modes = make_modes(self.grid, *bending)
        self.w, self.u = self.modes.q, self.modes.u

    def move(self, newtons: float) -> None:
        q, u, k2, d, push, source, _, seen, _, slack = self.modes[:10]
        self.midspan = move_modes(q, u, d, push, source, k2, seen, slack, newtons)

    def undo(self) -> None:
        self.w += self.u
        self.midspan = float(self.w.sum())


_MARCHES = {
    _LeapfrogMarch: Discretisation(nodes=201, points=3),
    _ModalMarch: Discretisation(nodes=51, points=3, scheme="modal"),
}


@check(
    "Time reversal",
    "Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), section V.1: leapfrog of "
    "nodes or of modes, and an elastic law have no arrow of time",
    Reference("identity", ROUNDING, "rounding"),
)
def time_reversal() -> Finding:
    """Compare forces there and, after all velocities are reversed, back; and the final state.

    The march uses the kernels' beam and contact, and is shown to be that of simulate().
    """
    impact, duration = elastic(paper_impact(0.99)), 0.5e-3
    comparisons = Comparisons()
    curves: list[Curve] = []
    for kind, grid in _MARCHES.items():
        march = kind(impact, grid, duration)
        steps, velocity = march.steps, march.u_s
        forward = np.array([march.step() for _ in range(steps)])
        largest = float(np.max(np.abs(march.w)))
        march.turn()
        back = np.array([march.step() for _ in range(steps)])[::-1]
        march.turn()
        solver = run_dataset(impact, grid, duration=duration, samples=steps + 1)
        time, newtons = solver.time.values, solver.contact_force.values
        where = f"{grid.scheme}: the paper's case, elastic, {steps} steps there and back"
        label = "contact force of the march and of simulate()"
        moving, left = (float(np.max(np.abs(values))) for values in (march.u, march.w))
        ends = {
            "sphere's velocity over the first": (march.u_s / velocity, 1.0),
            "sphere's place over deflection": (march.w_s / largest, 0.0),
            "beam's velocity over the sphere's": (moving / velocity, 0.0),
            "deflection left over the largest": (left / largest, 0.0),
        }
        # The force at the turn belongs to the way back, the force at first touch to the way there.
        comparisons.at(where).curve(label, "N", forward, newtons[:-1], TOLERANCE)
        comparisons.curve("contact force, back and there", "N", back[:-1], forward[1:], TOLERANCE)
        for name, values in ends.items():
            comparisons.absolute(name, "1", *values, TOLERANCE)
        curves += [
            Curve(f"{grid.scheme}: there", time[:-1], forward),
            Curve(f"{grid.scheme}: back, in reverse", time[1:], back, independent=True),
        ]
    axes = ("time since first touch", "s"), ("contact force", "N")
    return Finding(comparisons, [CurvePanel("the paper's case, elastic", *axes, curves)])
