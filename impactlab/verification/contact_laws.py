"""Every contact law on a beam too heavy to move: restitution and dent, against its quadrature."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.simulate import simulate
from impactlab.solver.contact import LAWS
from impactlab.verification.cases import rigid_backed
from impactlab.verification.finding import (
    Comparison,
    Curve,
    Finding,
    Floats,
    Panel,
    absolute,
    relative,
    worst,
)
from impactlab.verification.solutions.contact_laws import LawOnHalfSpace, law_on_half_space

TITLE = "All contact laws on a half-space"
SOURCE = (
    "each law from its formulas, integrated by adaptive quadrature: "
    "impactlab.verification.solutions.contact_laws, which names the papers"
)

VELOCITIES = (0.012, 0.03, 0.1, 0.3, 0.99, 3.0, 10.0)
"""In m/s: from just beyond the first yield of all laws but Hertz's."""
DRAWN = 0.99
"""m/s; the curves of force against indentation are those of this velocity."""
# a small Courant number: here the contact alone sets the time step
_GRID = Discretisation(nodes=11, points=3, courant=0.005)
TOLERANCE = 1e-4
"""Larger than for smooth laws: a jump of the force falls within some step."""
_QUADRATURE = "quadrature of the law"


@dataclass(frozen=True)
class Tried:
    """A law's quadrature, and the solver's runs at VELOCITIES; mass: of the sphere, in kg."""

    law: LawOnHalfSpace
    mass: float
    runs: list[xr.Dataset]


def check() -> Finding:
    """Restitution, dent and dissipation: of each law, the velocity that comes out worst.

    Laws that create energy do so here, too: a restitution above 1 has to come out as it is.
    """
    tried = {name: _try(name) for name in LAWS}
    found = [
        worst(
            [
                make(velocity, run, entry)
                for velocity, run in zip(VELOCITIES, entry.runs, strict=True)
            ]
        )
        for entry in tried.values()
        for make in (_restitution, _peak_force, _dent, _lost)
    ]
    return Finding(found, [_forces(tried), _restitutions(tried), _dents(tried)])


def _try(name: str) -> Tried:
    impact = rigid_backed(DRAWN, name)
    runs = [_run(name, velocity) for velocity in VELOCITIES]
    return Tried(law_on_half_space(impact), impact.sphere.total_mass, runs)


def _run(name: str, velocity: float) -> xr.Dataset:
    """Until the sphere has left: at most Hertz's contact time and that of full plasticity."""
    duration = 0.5e-3 * (DRAWN / velocity) ** 0.2 + 0.2e-3
    return simulate(rigid_backed(velocity, name), _GRID, duration=duration, samples=401)


def _where(velocity: float, entry: Tried) -> str:
    return f"{entry.law.law}, {velocity:.3g} m/s"


def _restitution(velocity: float, run: xr.Dataset, entry: Tried) -> Comparison:
    expected = entry.law.restitution(velocity, entry.mass)
    ours = run.restitution.item()
    return absolute("restitution", _where(velocity, entry), "1", ours, expected, TOLERANCE)


def _peak_force(velocity: float, run: xr.Dataset, entry: Tried) -> Comparison:
    expected = entry.law.loading_force(entry.law.maximum_indentation(velocity, entry.mass))
    ours = run.peak_force.item()
    return relative("peak force", _where(velocity, entry), "N", ours, expected, TOLERANCE)


def _dent(velocity: float, run: xr.Dataset, entry: Tried) -> Comparison:
    """In units of the deepest indentation, because it passes through zero."""
    deepest = entry.law.maximum_indentation(velocity, entry.mass)
    expected = entry.law.residual_indentation(deepest) / deepest
    ours = run.permanent_indentation.item() / deepest
    where = _where(velocity, entry)
    return absolute("dent over indentation", where, "1", ours, expected, TOLERANCE)


def _lost(velocity: float, run: xr.Dataset, entry: Tried) -> Comparison:
    ours = run.contact_dissipation.item() / (0.5 * entry.mass * velocity**2)
    expected = 1.0 - entry.law.restitution(velocity, entry.mass) ** 2
    where = _where(velocity, entry)
    return absolute("share of energy lost", where, "1", ours, expected, TOLERANCE)


def _forces(tried: dict[str, Tried]) -> Panel:
    curves = []
    for name, entry in tried.items():
        run = entry.runs[VELOCITIES.index(DRAWN)]
        touching = run.contact_force.values > 0
        depth, force = run.indentation.values[touching], run.contact_force.values[touching]
        curves += [Curve(name, depth, force), _loading(entry)]
    title = f"force against indentation at {DRAWN} m/s"
    return Panel(title, ("indentation", "m"), ("contact force", "N"), curves)


def _loading(entry: Tried) -> Curve:
    deepest = entry.law.maximum_indentation(DRAWN, entry.mass)
    depth = np.linspace(1e-3, 1.0, 101) * deepest
    force = np.array([entry.law.loading_force(float(d)) for d in depth])
    return Curve(_QUADRATURE, depth, force, independent=True)


def _restitutions(tried: dict[str, Tried]) -> Panel:
    y = ("coefficient of restitution", "1")
    curves = []
    for name, entry in tried.items():
        fine = _fine()
        expected = np.array([entry.law.restitution(float(v), entry.mass) for v in fine])
        ours = np.array([run.restitution.item() for run in entry.runs])
        curves += [_ours(name, ours), Curve(_QUADRATURE, fine, expected, independent=True)]
    return Panel("restitution against velocity", ("velocity", "m s-1"), y, curves, log=True)


def _dents(tried: dict[str, Tried]) -> Panel:
    y = ("permanent indentation", "m")
    curves = []
    for name, entry in tried.items():
        fine = _fine()
        expected = np.array([_dent_after(float(v), entry) for v in fine])
        ours = np.array([run.permanent_indentation.item() for run in entry.runs])
        curves += [_ours(name, ours), Curve(_QUADRATURE, fine, expected, independent=True)]
    title = "permanent indentation against velocity"
    return Panel(title, ("velocity", "m s-1"), y, curves, log=True)


def _ours(name: str, values: Floats) -> Curve:
    return Curve(name, np.array(VELOCITIES), values)


def _dent_after(velocity: float, entry: Tried) -> float:
    return entry.law.residual_indentation(entry.law.maximum_indentation(velocity, entry.mass))


def _fine() -> Floats:
    """Velocities of the independent curves, in m/s."""
    return np.geomspace(VELOCITIES[0], VELOCITIES[-1], 61)
