"""Scale models and other systems of units: the same answers, scaled by their dimensions."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact
from impactlab.model.parameters import PARAMETERS, flatten, with_values
from impactlab.simulate import simulate
from impactlab.solver.contact import LAWS
from impactlab.variables import HISTORIES, PROFILES, RESPONSES
from impactlab.verification.cases import with_beam_material
from impactlab.verification.finding import Comparison, Curve, Finding, Panel, curve, worst

TITLE = "Similarity and units"
SOURCE = "Buckingham, Phys. Rev. 4 (1914) 345: on physically similar systems"

_DIMENSIONS = {
    "kg": (1, 0, 0),
    "m": (0, 1, 0),
    "s": (0, 0, 1),
    "N": (1, 1, -2),
    "Pa": (1, -1, -2),
    "J": (1, 2, -2),
}
"""Powers of mass, length and time in each unit."""

_GRID = Discretisation(nodes=101, points=21)
_DURATION = 2e-3
TOLERANCE = 1e-9
"""Round-off: no answer may tell the scale by more."""


@dataclass(frozen=True)
class Scale:
    """Factors on every mass, length and time."""

    mass: float
    length: float
    time: float

    def factor(self, units: str) -> float:
        """Factor on a quantity in `units` (UDUNITS, as in impactlab.variables)."""
        powers = np.zeros(3)
        for name, power in re.findall(r"([A-Za-z]+)(-?\d*)", units):
            powers += np.array(_DIMENSIONS[name]) * int(power or 1)
        return float(np.prod(np.array([self.mass, self.length, self.time]) ** powers))

    def impact(self, impact: Impact) -> Impact:
        """`impact` with each of its parameters scaled."""
        values = {
            name: value * self.factor(PARAMETERS[name].units)
            for name, value in flatten(impact, _GRID).items()
            if PARAMETERS[name].units != "1" and not isinstance(value, str)
        }
        return with_values(impact, _GRID, values)[0]


def same_speed(size: float) -> Scale:
    """Lengths by `size`, materials and velocity as they are: times by size, forces by size^2."""
    return Scale(size**3, size, size)


def other_material(stiffness: float, density: float) -> Scale:
    """Pressures by `stiffness`, densities by `density`: velocities by the root of their ratio."""
    return Scale(density, 1.0, math.sqrt(density / stiffness))


SCALES = {
    "a scale model, 1 to 7": same_speed(1.0 / 7.0),
    "a scale model, 30 to 1": same_speed(30.0),
    "moduli by 0.3, densities by 1.7": other_material(0.3, 1.7),
    "in t, mm and s": Scale(1e-3, 1e3, 1.0),
    "in g, cm and us": Scale(1e3, 1e2, 1e6),
}


def yielding(contact: str) -> Impact:
    """The paper's case at 15 m/s, with both kinds of hardening: sub-impacts on a yielding beam.

    With gravity, which scales as every acceleration does.
    """
    return with_beam_material(
        paper_impact(15.0, contact),
        isotropic_hardening_modulus=5e9,
        kinematic_hardening_modulus=3e9,
    )


def check() -> Finding:
    """Every response, history and profile of the scaled impact, against those of the impact.

    Dimensional analysis is all that is independent here; a constant with a unit, hidden in the
    code, would break it.
    """
    found: list[Comparison] = []
    for contact in LAWS:
        impact = yielding(contact)
        run = simulate(impact, _GRID, duration=_DURATION)
        for name, scale in SCALES.items():
            found += _compare(f"{contact}, {name}", run, _scaled(impact, scale), scale)
    return Finding(found, [_panel()])


def _scaled(impact: Impact, scale: Scale) -> xr.Dataset:
    return simulate(scale.impact(impact), _GRID, duration=_DURATION * scale.factor("s"))


def _compare(where: str, run: xr.Dataset, scaled: xr.Dataset, scale: Scale) -> list[Comparison]:
    """The worst of the responses, and the worst of the curves."""
    responses = [_response(name, where, run, scaled, scale) for name in RESPONSES]
    curves = [
        curve(
            f"worst curve: {entry.long_name}",
            where,
            entry.units,
            scaled[name].values.ravel() / scale.factor(entry.units),
            run[name].values.ravel(),
            TOLERANCE,
        )
        for name, entry in (HISTORIES | PROFILES).items()
    ]
    return [worst(responses), worst(curves)]


def _response(
    name: str, where: str, run: xr.Dataset, scaled: xr.Dataset, scale: Scale
) -> Comparison:
    """A response, by the difference over its yardstick; missing in both is the same."""
    entry = RESPONSES[name]
    expected, ours = run[name].item(), scaled[name].item() / scale.factor(entry.units)
    error = (ours - expected) / _yardsticks(run).get(name, abs(expected) or 1.0)
    if math.isnan(ours) and math.isnan(expected):
        error = 0.0
    quantity = f"worst response: {entry.long_name}"
    return Comparison(
        quantity, where, entry.units, ours, expected, error, TOLERANCE, "of its yardstick"
    )


def _yardsticks(run: xr.Dataset) -> Mapping[str, float]:
    """What answers that are small differences of large ones are measured by."""
    energy = float(0.5 * run.sphere_mass * run.velocity**2)
    return {
        "contact_dissipation": energy,
        "plastic_dissipation": energy,
        "energy_error": 1.0,
    }


def _panel() -> Panel:
    impact = yielding("stronge")
    curves = []
    for name, scale in {"the impact": Scale(1.0, 1.0, 1.0), **SCALES}.items():
        run = _scaled(impact, scale)
        time, force = run.time.values / scale.factor("s"), run.contact_force.values
        curves.append(Curve(name, time, force / scale.factor("N"), name == "the impact"))
    return Panel("scaled back", ("time", "s"), ("contact force", "N"), curves)
