"""The contact's memory: how far it was loaded, and the curve on which it unloads and reloads.

Loading follows the law; below the largest indentation so far, delta_m, the force is
K (delta - delta_r)^n in both directions (reloading retraces unloading, then loading goes on).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from impactlab.solver.contact.switch import curve
from impactlab.solver.jit import compiled
from impactlab.solver.strain_rate import contact_rate, rate_factor
from impactlab.solver.types import Record, record


class Pair(NamedTuple):
    """Two bodies in contact.

    law: its number; E, R: effective modulus (Pa) and radius (m); S_y, nu: the softer body's yield
    stress (Pa) and Poisson's ratio.
    """

    law: int
    E: float
    R: float
    S_y: float
    nu: float


CONTACT = record("delta_m F_m K delta_r n work delta_w")
"""delta_m (m), F_m (N): furthest point on the loading curve. K (N/m^n), delta_r (m), n: the
unloading curve from there. work (J): integral of the loading force from 0 to delta_w (m)."""

_PANELS = 8
# Gauss-Legendre on [0, 1], 4 points
_GAUSS = (
    (0.06943184420297371, 0.17392742256872693),
    (0.33000947820757187, 0.32607257743127307),
    (0.6699905217924281, 0.32607257743127307),
    (0.9305681557970263, 0.17392742256872693),
)


@compiled
def make_pair(case: Record) -> Pair:
    """Return sphere against flat beam: 1/E* = (1 - nu_s^2)/E_s + (1 - nu_b^2)/E_b, R* = R_s.

    The beam's yield stress is that at its strain rate under the contact (strain_rate.py).
    """
    compliance = (1.0 - case.sphere_poissons_ratio**2) / case.sphere_youngs_modulus + (
        1.0 - case.beam_poissons_ratio**2
    ) / case.beam_youngs_modulus
    E, R = 1.0 / compliance, case.sphere_radius
    factor = rate_factor(
        contact_rate(case, E, R), case.beam_rate_coefficient, case.beam_rate_exponent
    )
    S_y = case.beam_yield_stress * factor
    if S_y <= case.sphere_yield_stress:
        return Pair(case.contact, E, R, S_y, case.beam_poissons_ratio)
    return Pair(case.contact, E, R, case.sphere_yield_stress, case.sphere_poissons_ratio)


@compiled
def load(contact: Record, pair: Pair, delta: float) -> None:
    """Move the furthest point of loading on to delta."""
    contact.delta_m = delta
    contact.F_m, contact.K, contact.delta_r, contact.n = curve(
        pair.law, delta, pair.E, pair.R, pair.S_y, pair.nu
    )


@compiled
def force(contact: Record, pair: Pair, delta: float) -> float:
    """Return the contact force (N) at delta (m); load further where delta exceeds delta_m."""
    if delta > contact.delta_m:
        load(contact, pair, delta)
        return contact.F_m
    over = delta - contact.delta_r
    if over <= 0.0:
        return 0.0
    if contact.n == 1.5:
        return contact.K * over * math.sqrt(over)
    return contact.K * over**contact.n


@compiled
def loading_work(pair: Pair, start: float, stop: float) -> float:
    """Return the integral of the loading force over [start, stop], J.

    Gauss-Legendre with 4 points on panels of the square root of (delta - start), in which
    delta^1.5 is smooth at zero; the panels keep a regime limit of a law from costing accuracy.
    """
    total = 0.0
    for panel in range(_PANELS):
        for point, weight in _GAUSS:
            root = (panel + point) / _PANELS
            delta = start + root * root * (stop - start)
            F, _, _, _ = curve(pair.law, delta, pair.E, pair.R, pair.S_y, pair.nu)
            total += weight * F * 2.0 * root
    return total * (stop - start) / _PANELS


@compiled
def energies(contact: Record, pair: Pair, delta: float) -> tuple[float, float]:
    """Return (stored, dissipated) energy of the contact at delta, J.

    Dissipated is what loading took less what the unloading curve would give back; negative
    where a law creates energy.
    """
    if contact.delta_m > contact.delta_w:
        contact.work += loading_work(pair, contact.delta_w, contact.delta_m)
        contact.delta_w = contact.delta_m
    whole = contact.K * (contact.delta_m - contact.delta_r) ** (contact.n + 1.0) / (contact.n + 1.0)
    over = max(delta - contact.delta_r, 0.0)
    stored = contact.K * over ** (contact.n + 1.0) / (contact.n + 1.0)
    return stored, contact.work - whole
