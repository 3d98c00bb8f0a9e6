"""The largest time steps, of each model of the beam and scheme in time.

The paper's beam by leapfrog: omega^2 <= 16 (EI)_q/(rho A dx^4) + k_c (1/(rho A dx) + 1/m_s);
dt_critical = 2/omega (physics.md, in the place of the paper's bar-wave limit).
"""

from __future__ import annotations

import math

from impactlab.solver.contact.history import Pair, loading_work
from impactlab.solver.contact.switch import curve
from impactlab.solver.jit import compiled
from impactlab.solver.types import Record

_GROWTH = 1.25
_LARGEST_SHARE = 0.01
"""Of the loading work, in energy that a jump at the turn may bring at the critical time step."""


@compiled
def _stiffness(pair: Pair, delta: float) -> float:
    """Return the largest tangent stiffness (N/m) of loading and of unloading at delta.

    A jump of the force at the limit of a regime is no stiffness: it falls into the difference
    to one side alone. Where unloading begins with a jump, up to a step is made under the wrong
    force, which brings an energy of jump^2 dt^2/m; with dt^2/m = 4/k it is a share 4 jump^2/(k W)
    of the loading work W, of which 0.4 F delta is taken.
    """
    F, K, delta_r, n = curve(pair.law, delta, pair.E, pair.R, pair.S_y, pair.nu)
    small = 1e-4 * delta
    after, _, _, _ = curve(pair.law, delta + small, pair.E, pair.R, pair.S_y, pair.nu)
    before, _, _, _ = curve(pair.law, delta - small, pair.E, pair.R, pair.S_y, pair.nu)
    loading = min(after - F, F - before) / small
    start = K * max(delta - delta_r, 0.0) ** n
    unloading = n * start / (delta - delta_r)
    turning = 10.0 * (F - start) ** 2 / (_LARGEST_SHARE * F * delta)
    return max(loading, unloading, turning)


@compiled
def stiffest_contact(case: Record, pair: Pair) -> float:
    """Return k_c in N/m, over all indentations that the sphere's energy can drive.

    The indentation is raised until loading has taken all of that energy: no impact on a beam,
    which takes a part of it, goes deeper.
    """
    energy = 0.5 * case.sphere_mass * case.velocity**2
    hertz = 4.0 / 3.0 * pair.E * math.sqrt(pair.R)
    delta = 0.1 * (2.5 * energy / hertz) ** 0.4
    work, k_c = 0.0, 0.0
    while work < energy + case.sphere_mass * case.gravity * delta and delta < pair.R:
        k_c = max(k_c, _stiffness(pair, delta))
        work += loading_work(pair, delta, _GROWTH * delta)
        delta *= _GROWTH
    return max(k_c, _stiffness(pair, delta))


@compiled
def critical_time_step(case: Record, pair: Pair, bending_stiffness: float, dx: float) -> float:
    """Return the largest stable time step (s) for node spacing dx (m) and the rule's EI (N m2)."""
    mu = case.beam_density * case.beam_width * case.beam_depth
    k_c = stiffest_contact(case, pair)
    omega_squared = 16.0 * bending_stiffness / (mu * dx**4)
    omega_squared += k_c * (1.0 / (mu * dx) + 1.0 / case.sphere_mass)
    return 2.0 / math.sqrt(omega_squared)


@compiled
def timoshenko_time_step(
    case: Record, pair: Pair, bending_stiffness: float, shear_stiffness: float, dx: float
) -> float:
    """Return the largest stable time step (s) of the Timoshenko beam; shear_stiffness: k G A in N.

    omega^2 <= 4 (EI)_q/(rho I dx^2) + k G A/(rho I) + 4 k G A/(rho A dx^2) and the contact's.
    """
    mu = case.beam_density * case.beam_width * case.beam_depth
    inertia = mu * case.beam_depth**2 / 12.0
    omega_squared = (4.0 * bending_stiffness / dx**2 + shear_stiffness) / inertia
    omega_squared += 4.0 * shear_stiffness / (mu * dx**2)
    omega_squared += stiffest_contact(case, pair) * (1.0 / (mu * dx) + 1.0 / case.sphere_mass)
    return 2.0 / math.sqrt(omega_squared)


_LUMPED_STEPS = 1000.0


@compiled
def lumped_time_step(case: Record, pair: Pair, mass: float, stiffness: float) -> float:
    """Return the largest time step (s) of the spring-mass model or, with mass = 0, the rigid beam.

    A thousandth of the critical one, for accuracy: no wave asks for small steps here.
    """
    k_c = stiffest_contact(case, pair)
    omega_squared = k_c / case.sphere_mass
    if mass > 0.0:
        omega_squared += (k_c + stiffness) / mass
    return 2.0 / math.sqrt(omega_squared) / _LUMPED_STEPS


@compiled
def semi_implicit_time_step(case: Record, pair: Pair, dx: float) -> float:
    """Return the largest time step (s) of the semi-implicit scheme for node spacing dx (m).

    Half of what a bar wave takes over a spacing, for accuracy; and the contact spring between the
    bare masses of node and sphere, for stability: the filter makes the node's mass larger.
    """
    mu = case.beam_density * case.beam_width * case.beam_depth
    wave = 0.5 * dx * math.sqrt(case.beam_density / case.beam_youngs_modulus)
    k_c = stiffest_contact(case, pair)
    return min(wave, 2.0 / math.sqrt(k_c * (1.0 / (mu * dx) + 1.0 / case.sphere_mass)))
