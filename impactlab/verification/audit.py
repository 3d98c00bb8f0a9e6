"""Energy and momentum of one impact, summed over its dataset and not by the solver.

What the dataset has no field of, the beam's velocity, comes from the deflections of two more runs,
which end one time step earlier and one later. Squares of velocities are products of those half a
step before and half a step after, which is what central differences conserve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.simulate import case_table, simulate
from impactlab.solver.contact.history import make_pair
from impactlab.solver.leapfrog import discretise
from impactlab.solver.section import make_section
from impactlab.verification.finding import Floats
from impactlab.verification.solutions import quadrature


@dataclass(frozen=True)
class Audit:
    """Sums over one run.

    energy, momentum: what is in excess at the end, as a share of what the sphere brings and gravity
    adds; momentum: the sphere's alone. contact: integral of the force over the indentation,
    plastic: of the yield stress over the PEEQ, both in J. brought: the energy brought, in J.
    """

    run: xr.Dataset
    energy: float
    momentum: float
    contact: float
    plastic: float
    brought: float


def audit(impact: Impact, grid: Discretisation, duration: float) -> Audit:
    """Solve the impact three times, and sum. duration in s, made a whole number of time steps."""
    dt = _time_step(impact, grid)
    steps = round(duration / dt)
    duration = dt * steps
    run = simulate(impact, grid, duration=duration, samples=steps + 1)
    mass, gravity = impact.sphere.total_mass, impact.gravity
    earlier, later = _final_velocities(run)
    force = run["contact_force"].values
    impulse = float(np.trapezoid(force, run["time"].values))
    contact = float(np.trapezoid(force, run["indentation"].values))
    plastic, stored = _strain_energies(impact, grid, run)
    fallen = run["sphere_displacement"].values
    start = impact.velocity**2 - (0.5 * gravity * dt) ** 2  # a product, too
    brought = 0.5 * mass * start + mass * gravity * float(fallen.max())
    spent = mass * gravity * float(fallen.max() - fallen[-1])
    kinetic = 0.5 * mass * earlier * later + _kinetic_energy(impact, grid, run, dt)
    pushed = mass * (impact.velocity + gravity * duration)
    return Audit(
        run=run,
        energy=(kinetic + spent + contact + stored + plastic) / brought - 1.0,
        momentum=(0.5 * mass * (earlier + later) + impulse) / pushed - 1.0,
        contact=contact,
        plastic=plastic,
        brought=brought,
    )


def _final_velocities(run: xr.Dataset) -> tuple[float, float]:
    """The sphere's, in m/s, half a step before the end and half a step after it."""
    fallen, time = run["sphere_displacement"].values, run["time"].values
    dt = time[-1] - time[-2]
    earlier = float((fallen[-1] - fallen[-2]) / dt)
    force, mass = float(run["contact_force"][-1]), run["sphere_mass"].item()
    return earlier, earlier + float(dt) * (run["gravity"].item() - force / mass)


def _time_step(impact: Impact, grid: Discretisation) -> float:
    """The solver's, in s, for durations of many steps; a hair less.

    In single precision, so that durations are exact multiples of it: runs that end a step apart
    then take the very same steps, and their difference is free of rounding.
    """
    case = case_table(impact, grid, duration=1.0)[0]
    dt = np.float32(discretise(case, make_pair(case), make_section(case))[0].dt)
    return float(np.nextafter(dt, np.float32(0.0)))


def _kinetic_energy(impact: Impact, grid: Discretisation, run: xr.Dataset, dt: float) -> float:
    """Of the beam at the end, in J."""
    end, here = run["duration"].item(), run["deflection"].values
    before, after = (
        simulate(impact, grid, duration=end + shift, samples=2)["deflection"].values
        for shift in (-dt, dt)
    )
    product = (here - before) * (after - here) / dt**2
    return float(0.5 * impact.beam.mass_per_length * np.trapezoid(product, run["x"].values))


def _strain_energies(impact: Impact, grid: Discretisation, run: xr.Dataset) -> tuple[float, float]:
    """(dissipated, stored) in J, fibre by fibre."""
    beam, material = impact.beam, impact.beam.material
    _, weights = quadrature.rule(grid.rule, grid.points)
    area = 0.5 * beam.depth * beam.width * weights
    strain, peeq = run["plastic_strain"].values, run["equivalent_plastic_strain"].values
    curvature = _curvature(run["deflection"].values, run["x"].values)
    elastic = -np.multiply.outer(curvature, run["z"].values) - strain
    kept = 0.5 * material.youngs_modulus * elastic**2
    kept += 0.5 * material.kinematic_hardening_modulus * strain**2
    lost = (material.yield_stress + 0.5 * material.isotropic_hardening_modulus * peeq) * peeq
    return _along(lost @ area, run), _along(kept @ area, run)


def _curvature(deflection: Floats, x: Floats) -> Floats:
    curvature = np.zeros_like(deflection)
    curvature[1:-1] = np.diff(deflection, 2) / (x[1] - x[0]) ** 2
    return curvature


def _along(density: Floats, run: xr.Dataset) -> float:
    return float(np.trapezoid(density, run["x"].values))
