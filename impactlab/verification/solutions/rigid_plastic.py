"""A heavy striker on a rigid-plastic beam: the mode with one hinge at mid-span.

The struck beam deflects as a triangle. Striking, the momentum goes over into that mode:
v_1 = m v_0/(m + mu L/3), the velocity that leaves the least difference of kinetic energy; then the
hinge's 4 M_p/L brakes striker and beam evenly. The hinges that travel outwards at first are left
out, and so is elasticity: it holds where the striker is heavy against the beam, its energy large
against what the beam can store, and the rotation small.
Sources: Martin and Symonds, Mode approximations for impulsively loaded rigid-plastic structures,
J. Eng. Mech. Div. ASCE 92 (1966); Jones, Structural Impact (1989), chapter 3.
"""

from __future__ import annotations

from impactlab.model.impact import Impact
from impactlab.verification.solutions import bending, static_loading


def mode_mass(impact: Impact) -> float:
    """m + mu L/3 in kg: the striker and the triangle's share of the beam."""
    return impact.sphere.total_mass + impact.beam.mass_per_length * impact.beam.span / 3.0


def mode_velocity(impact: Impact) -> float:
    """v_1 = m v_0/(m + mu L/3) in m/s: at mid-span once the mode has formed."""
    return impact.sphere.total_mass * impact.velocity / mode_mass(impact)


def mode_energy(impact: Impact) -> float:
    """(m + mu L/3) v_1^2/2 in J: what the striking leaves for the hinge."""
    return 0.5 * mode_mass(impact) * mode_velocity(impact) ** 2


def final_deflection(impact: Impact) -> float:
    """w_f in m: the hinge takes all of the mode's energy, 4 M_p/L w_f. Gravity is left out."""
    return mode_energy(impact) / bending.collapse_load(impact.beam)


def duration(impact: Impact) -> float:
    """Time in s until the beam stands still: v_1 (m + mu L/3)/(4 M_p/L)."""
    return mode_velocity(impact) * mode_mass(impact) / bending.collapse_load(impact.beam)


def energy_ratio(impact: Impact) -> float:
    """Kinetic energy of the striker over what the beam stores elastically at 4 M_p/L."""
    load = bending.collapse_load(impact.beam)
    stored = 0.5 * load * bending.static_deflection(impact.beam, load)
    return 0.5 * impact.sphere.total_mass * impact.velocity**2 / stored


def elastic_plastic_deflection(impact: Impact) -> float:
    """Permanent deflection in m when the mode's energy follows the static load-deflection curve.

    w_f and what that curve's rise adds, less the elastic spring back from 4 M_p/L: a beam whose
    striker is so slow that inertia forces are those of the mode alone. Holds above its collapse.
    """
    beam, load = impact.beam, bending.collapse_load(impact.beam)
    rise = static_loading.missing_work(beam) / load
    return final_deflection(impact) + rise - bending.static_deflection(beam, load)
