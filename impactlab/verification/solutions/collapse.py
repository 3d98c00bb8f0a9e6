"""The beam beyond yield: a slowly growing load at mid-span, and one plastic hinge under a striker.

Static load: the beam is statically determinate, the moment is P x/2 at a distance x from the
support, whatever yields. The deflection follows from the curvature by the unit-load theorem.

Striker: the rigid-plastic beam deflects as a triangle with one hinge at mid-span. Striking, the
momentum goes over into that mode: v_1 = m v_0/(m + mu L/3), the velocity that leaves the least
difference of kinetic energy; then the hinge's 4 M_p/L brakes striker and beam evenly. The hinges
that travel outwards at first are left out, and so is elasticity: it holds where the striker is
heavy against the beam, its energy large against what the beam can store, and the rotation small.
Sources: Prager and Hodge, Theory of Perfectly Plastic Solids (1951), chapter 2; Martin and Symonds,
Mode approximations for impulsively loaded rigid-plastic structures, J. Eng. Mech. Div. ASCE 92
(1966); Jones, Structural Impact (1989), chapter 3.
"""

from __future__ import annotations

import math

from scipy.integrate import quad
from scipy.optimize import brentq

from impactlab.model.bodies import Beam
from impactlab.model.impact import Impact
from impactlab.verification.solutions import bending

_FAR = 1e6  # curvature, over the yield curvature, beyond which a section counts as a hinge


def midspan_deflection(beam: Beam, load: float) -> float:
    """Return the mid-span deflection in m under a `load` (N) there that has only grown.

    w = integral of kappa x dx over half the span; with M = P x/2 and by parts
    w = 2/P^2 (kappa_m M_m^2 - integral of M^2 over kappa from 0 to kappa_m), m: at mid-span.

    Raises ValueError when the beam cannot carry the load.
    """
    highest = load * beam.span / 4.0
    curvature = _curvature(beam, highest)
    first = min(curvature, bending.yield_curvature(beam))

    def integrand(logarithm: float) -> float:
        kappa = math.exp(logarithm)
        return float(bending.moment(beam, kappa)) ** 2 * kappa

    # In the logarithm of the curvature, which may grow by orders beyond yield.
    beyond, _ = quad(integrand, math.log(first), math.log(curvature), epsrel=1e-11)
    work = beam.bending_stiffness**2 * first**3 / 3.0 + float(beyond)
    return float(2.0 / load**2 * (curvature * highest**2 - work))


def load_at(beam: Beam, deflection: float) -> float:
    """Return the load in N that gives a mid-span `deflection` (m) on the first loading.

    Without hardening it ends at the collapse load, which deflections of 20/9 times that of first
    yield and more share.
    """
    elastic = deflection / bending.static_deflection(beam, 1.0)  # no beam carries more
    hinge = 0.5 * _FAR * bending.yield_curvature(beam)
    most = min(elastic, 4.0 / beam.span * float(bending.moment(beam, hinge)))
    if midspan_deflection(beam, most) <= deflection:
        return most
    least = 2.0 / 3.0 * most  # the plastic moment is 1.5 times that of first yield
    while midspan_deflection(beam, least) > deflection:
        least *= 0.5
    return float(brentq(lambda load: midspan_deflection(beam, load) - deflection, least, most))


def missing_work(beam: Beam) -> float:
    """Return the work in J by which collapse falls short of the collapse load all the way.

    The integral of P_c - P over the deflection, that is of the deflection over P; without
    hardening.
    """
    collapse = bending.collapse_load(beam)
    at_yield = 4.0 * bending.yield_moment(beam) / beam.span
    elastic = 0.5 * bending.static_deflection(beam, at_yield) * at_yield
    beyond, _ = quad(lambda load: midspan_deflection(beam, load), at_yield, collapse * (1 - 1e-9))
    return float(elastic + beyond)


def _curvature(beam: Beam, moment: float) -> float:
    """Return the curvature (1/m) at which the section carries `moment` (N m)."""
    if moment <= bending.yield_moment(beam):
        return moment / beam.bending_stiffness
    first = bending.yield_curvature(beam)
    far = _FAR * first
    if moment > float(bending.moment(beam, far)):
        raise ValueError(f"the beam cannot carry a moment of {moment:g} N m")
    return float(brentq(lambda kappa: float(bending.moment(beam, kappa)) - moment, first, far))


def mode_mass(impact: Impact) -> float:
    """Return m + mu L/3 in kg: the striker and the triangle's share of the beam."""
    return impact.sphere.total_mass + impact.beam.mass_per_length * impact.beam.span / 3.0


def mode_velocity(impact: Impact) -> float:
    """Return v_1 = m v_0/(m + mu L/3) in m/s: at mid-span once the mode has formed."""
    return impact.sphere.total_mass * impact.velocity / mode_mass(impact)


def mode_energy(impact: Impact) -> float:
    """Return (m + mu L/3) v_1^2/2 in J: the energy left to the hinge after the striking."""
    return 0.5 * mode_mass(impact) * mode_velocity(impact) ** 2


def mode_deflection(impact: Impact) -> float:
    """Return w_f in m: the hinge takes all of the mode's energy, 4 M_p/L w_f, without gravity."""
    return mode_energy(impact) / bending.collapse_load(impact.beam)


def mode_duration(impact: Impact) -> float:
    """Return the time in s until the beam stands still: v_1 (m + mu L/3)/(4 M_p/L)."""
    return mode_velocity(impact) * mode_mass(impact) / bending.collapse_load(impact.beam)


def energy_ratio(impact: Impact) -> float:
    """Return the kinetic energy of the striker over what the beam stores elastically at 4 M_p/L."""
    load = bending.collapse_load(impact.beam)
    stored = 0.5 * load * bending.static_deflection(impact.beam, load)
    return 0.5 * impact.sphere.total_mass * impact.velocity**2 / stored


def elastic_plastic_deflection(impact: Impact) -> float:
    """Return the permanent deflection in m if the mode's energy follows the static curve.

    w_f and what that curve's rise adds, less the elastic spring back from 4 M_p/L: a beam whose
    striker is so slow that inertia forces are those of the mode alone. Holds above its collapse.
    """
    beam, load = impact.beam, bending.collapse_load(impact.beam)
    return (
        mode_deflection(impact) + missing_work(beam) / load - bending.static_deflection(beam, load)
    )
