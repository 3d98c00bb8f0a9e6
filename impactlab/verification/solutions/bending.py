"""A beam bent beyond yield, loaded once or to and fro, its collapse, and a beam without ends.

Moments have the sign of the curvature here (docs/theory.md's M = B * integral of z sigma dz,
with strain -z kappa, has the opposite one). Loaded once, the material is elastic, then hardens
linearly with h, the sum of the isotropic and the kinematic modulus, which cannot be distinguished
as long as no fibre unloads.

To and fro, a fibre with kinematic hardening is a spring beside a perfectly plastic fibre, whose
stress is clipped anew on every way; with isotropic hardening the elastic range reaches, on both
sides, as far as the stress ever did. No plastic strain is needed.
Sources: any plasticity textbook, e.g. Lubliner, Plasticity Theory (1990), section 4.4; Masing
(1926); Prandtl (1928) and Besseling (1958) for the elements side by side.

Under a load at mid-span the beam is statically determinate, the moment is P x/2 at a distance x
from the support, whatever yields. The deflection follows from the curvature by the unit-load
theorem.

Struck, the rigid-plastic beam deflects as a triangle with one hinge at mid-span. The momentum goes
over into that mode: v_1 = m v_0/(m + mu L/3), the velocity that leaves the least difference of
kinetic energy; then the hinge's 4 M_p/L brakes striker and beam evenly. The hinges that travel
outwards at first are left out, and so is elasticity: it holds where the striker is heavy against
the beam, its energy large against what the beam can store, and the rotation small.
Sources: Prager and Hodge, Theory of Perfectly Plastic Solids (1951), chapter 2; Martin and Symonds,
Mode approximations for impulsively loaded rigid-plastic structures, J. Eng. Mech. Div. ASCE 92
(1966); Jones, Structural Impact (1989), chapter 3.

The infinite elastic beam, struck at x = 0, holds for a finite span until the supports' echo is
back: J. Boussinesq (1885); the Fourier integral of mu w_tt + EI w_xxxx = J delta(x) delta(t),
w(x, t) = J/(pi mu k) * integral of sin(k q^2 t) cos(q x)/q^2 over q > 0, k = sqrt(EI/mu),
mu = rho A.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import fresnel, roots_jacobi, roots_legendre

from impactlab.model.bodies import Beam
from impactlab.model.impact import Impact
from impactlab.model.material import Material
from impactlab.types import Floats


def yield_curvature(beam: Beam) -> float:
    """Return kappa_y = 2 sigma_y/(E H) in 1/m: the outermost fibre yields."""
    return 2.0 * beam.material.yield_stress / (beam.material.youngs_modulus * beam.depth)


def yield_moment(beam: Beam) -> float:
    """Return M_y in N m: the outermost fibre yields, sigma_y B H^2/6."""
    return float(beam.material.yield_stress / beam.section.stress_per_moment)


def plastic_moment(beam: Beam) -> float:
    """Return M_p in N m: every fibre yields, without hardening, sigma_y B H^2/4."""
    return float(beam.material.yield_stress * beam.section.plastic_modulus)


def collapse_load(beam: Beam) -> float:
    """Return the mid-span load in N under which the beam collapses, 4 M_p/L; no hardening."""
    return 4.0 * plastic_moment(beam) / beam.span


def static_deflection(beam: Beam, load: float) -> float:
    """Return the elastic mid-span deflection in m under a `load` (N) there: P L^3/(48 EI)."""
    return load * beam.span**3 / (48.0 * beam.bending_stiffness)


def moment(beam: Beam, curvature: ArrayLike) -> Floats:
    """Return the moment in N m at each `curvature` (1/m, any shape), by closed form.

    Without hardening M_p (1 - (kappa_y/kappa)^2/3) beyond yield. A hardening fibre is an elastic
    one and a perfectly plastic one side by side, and so is the section.
    """
    kappa = np.asarray(curvature, dtype=np.float64)
    beyond = np.maximum(np.abs(kappa) / yield_curvature(beam), 1.0)
    plastic = np.sign(kappa) * plastic_moment(beam) * (1.0 - 1.0 / (3.0 * beyond**2))
    elastic = beam.bending_stiffness * kappa
    perfect = np.where(beyond > 1.0, plastic, elastic)
    share = _elastic_share(beam.material)
    return np.asarray(share * elastic + (1.0 - share) * perfect)


def _elastic_share(material: Material) -> float:
    """Return the tangent modulus beyond yield over Young's modulus: h/(E + h)."""
    hardening = material.isotropic_hardening_modulus + material.kinematic_hardening_modulus
    return hardening / (material.youngs_modulus + hardening)


def path_stresses(material: Material, strains: ArrayLike) -> Floats:
    """Return the stress in Pa along a path of strains, shape (steps, ...), from the virgin fibre.

    Between two steps the strain goes straight. With one kind of hardening, or none.

    Raises ValueError when the material has both kinds.
    """
    path = np.asarray(strains, dtype=np.float64)
    isotropic = material.isotropic_hardening_modulus
    if isotropic and material.kinematic_hardening_modulus:
        raise ValueError("bending: isotropic or kinematic hardening, not both")
    E, share = material.youngs_modulus, _elastic_share(material)
    stresses, stress = [], np.zeros(path.shape[1:])
    limit = (1.0 - share) * material.yield_stress
    farthest = np.full(path.shape[1:], material.yield_stress)
    for before, strain in pairwise(np.concatenate([np.zeros_like(path[:1]), path])):
        if isotropic:
            elastic = stress + E * (strain - before)
            beyond = np.maximum(np.abs(elastic) - farthest, 0.0)
            stress = elastic - np.sign(elastic) * beyond * E / (E + isotropic)
            farthest = np.maximum(farthest, np.abs(stress))
        else:  # the perfectly plastic fibre beside the spring
            stress = np.clip(stress + (1.0 - share) * E * (strain - before), -limit, limit)
        stresses.append(stress)
    fibre = np.array(stresses)
    return fibre if isotropic else np.asarray(share * E * path + fibre)


def path_moments(beam: Beam, curvatures: Floats, positions: Floats, weights: Floats) -> Floats:
    """Return the moment in N m along a path of curvatures (1/m, shape (steps,)) that a rule gives.

    positions, weights: the rule's on [-1, 1], shape (points,). Sign of the curvature.
    """
    z, area = beam.section.fibres(positions, weights)
    stresses = path_stresses(beam.material, np.multiply.outer(curvatures, z))
    return np.asarray(stresses @ (area * z))


def moment_after_turn(beam: Beam, turn: float, curvature: ArrayLike) -> Floats:
    """Return the moment in N m at each `curvature` (1/m), bent to `turn`, then straight back.

    Masing's rule: M = M_t - 2 f((kappa_t - kappa)/2) of the first loading M = f(kappa), as far as
    -kappa_t. For no hardening, and for kinematic hardening.
    """
    back = 0.5 * (turn - np.asarray(curvature, dtype=np.float64))
    return np.asarray(moment(beam, turn) - 2.0 * moment(beam, back))


_FAR = 1e6  # curvature, over the yield curvature, beyond which a section counts as a hinge


def midspan_deflection(beam: Beam, load: float) -> float:
    """Return the mid-span deflection in m under a `load` (N) there that has only grown.

    w = integral of kappa x dx over half the span; with M = P x/2 and by parts
    w = 2/P^2 (kappa_m M_m^2 - integral of M^2 over kappa from 0 to kappa_m), m: at mid-span.

    Raises ValueError when the beam cannot carry the load.
    """
    highest = load * beam.span / 4.0
    curvature = _curvature(beam, highest)
    first = min(curvature, yield_curvature(beam))

    def integrand(logarithm: float) -> float:
        kappa = math.exp(logarithm)
        return float(moment(beam, kappa)) ** 2 * kappa

    # In the logarithm of the curvature, which may grow by orders beyond yield.
    beyond, _ = quad(integrand, math.log(first), math.log(curvature), epsrel=1e-11)
    work = beam.bending_stiffness**2 * first**3 / 3.0 + float(beyond)
    return float(2.0 / load**2 * (curvature * highest**2 - work))


def load_at(beam: Beam, deflection: float) -> float:
    """Return the load in N that gives a mid-span `deflection` (m) on the first loading.

    Without hardening it ends at the collapse load, which deflections of 20/9 times that of first
    yield and more share.
    """
    elastic = deflection / static_deflection(beam, 1.0)  # no beam carries more
    hinge = 0.5 * _FAR * yield_curvature(beam)
    most = min(elastic, 4.0 / beam.span * float(moment(beam, hinge)))
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
    collapse = collapse_load(beam)
    at_yield = 4.0 * yield_moment(beam) / beam.span
    elastic = 0.5 * static_deflection(beam, at_yield) * at_yield
    beyond, _ = quad(lambda load: midspan_deflection(beam, load), at_yield, collapse * (1 - 1e-9))
    return float(elastic + beyond)


def _curvature(beam: Beam, load: float) -> float:
    """Return the curvature (1/m) at which the section carries a moment `load` (N m)."""
    if load <= yield_moment(beam):
        return load / beam.bending_stiffness
    first = yield_curvature(beam)
    far = _FAR * first
    if load > float(moment(beam, far)):
        raise ValueError(f"the beam cannot carry a moment of {load:g} N m")
    return float(brentq(lambda kappa: float(moment(beam, kappa)) - load, first, far))


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
    return mode_energy(impact) / collapse_load(impact.beam)


def mode_duration(impact: Impact) -> float:
    """Return the time in s until the beam stands still: v_1 (m + mu L/3)/(4 M_p/L)."""
    return mode_velocity(impact) * mode_mass(impact) / collapse_load(impact.beam)


def energy_ratio(impact: Impact) -> float:
    """Return the kinetic energy of the striker over what the beam stores elastically at 4 M_p/L."""
    load = collapse_load(impact.beam)
    stored = 0.5 * load * static_deflection(impact.beam, load)
    return 0.5 * impact.sphere.total_mass * impact.velocity**2 / stored


def elastic_plastic_deflection(impact: Impact) -> float:
    """Return the permanent deflection in m if the mode's energy follows the static curve.

    w_f and what that curve's rise adds, less the elastic spring back from 4 M_p/L: a beam whose
    striker is so slow that inertia forces are those of the mode alone. Holds above its collapse.
    """
    beam, load = impact.beam, collapse_load(impact.beam)
    return mode_deflection(impact) + missing_work(beam) / load - static_deflection(beam, load)


def rule(name: str, points: int) -> tuple[Floats, Floats]:
    """Return an integration rule on [-1, 1]: ascending positions, weights, both (points,).

    "lobatto": both ends, exact up to degree 2 points - 3; between the ends lie the Gauss points for
    the weight 1 - x^2, which are roots of the Jacobi polynomial P^(1,1), their weights divided by
    1 - x^2. "legendre": no ends, exact up to degree 2 points - 1. "layers": the midpoints of equal
    layers (Zhang et al.), exact up to degree 1.

    Source: Davis and Rabinowitz, Methods of Numerical Integration (1984), section 2.7. Raises
    ValueError when the name is unknown.
    """
    if name == "layers":
        return (2.0 * np.arange(points) + 1.0) / points - 1.0, np.full(points, 2.0 / points)
    if name == "legendre":
        positions, weights = roots_legendre(points)
        return positions, weights
    if name != "lobatto":
        raise ValueError(f"rule = {name!r}: must be one of lobatto, legendre, layers")
    end = 2.0 / (points * (points - 1))
    if points == 2:
        return np.array([-1.0, 1.0]), np.array([end, end])
    inner, jacobi_weights = roots_jacobi(points - 2, 1.0, 1.0)
    positions = np.concatenate(([-1.0], inner, [1.0]))
    return positions, np.concatenate(([end], jacobi_weights / (1.0 - inner**2), [end]))


def deflection_under_impulse(beam: Beam, impulse: float, time: ArrayLike) -> Floats:
    """Return w(0, t) = J sqrt(t)/(mu sqrt(2 pi k)) in m.

    The deflection where an `impulse` J (N s) struck at t = 0, at each `time` (s, any shape).
    """
    return _impulse_scale(beam, impulse) * np.sqrt(np.asarray(time, dtype=np.float64))


def profile_under_impulse(beam: Beam, impulse: float, time: ArrayLike, x: ArrayLike) -> Floats:
    """Return w(x, t) in m at each distance `x` (m) from where an `impulse` J (N s) struck.

    w(x, t) = w(0, t) (cos(a^2) + sin(a^2) - sqrt(2 pi) a (C - S)), a = |x|/(2 sqrt(k t)), with
    Fresnel's integrals C and S at a sqrt(2/pi): w_xx of the Fourier integral, integrated twice.
    time (s) and x broadcast.
    """
    seconds = np.asarray(time, dtype=np.float64)
    a = np.abs(np.asarray(x, dtype=np.float64)) / (2.0 * np.sqrt(_wave_constant(beam) * seconds))
    S, C = fresnel(a * math.sqrt(2.0 / math.pi))
    shape = np.cos(a**2) + np.sin(a**2) - math.sqrt(2.0 * math.pi) * a * (C - S)
    return np.asarray(_impulse_scale(beam, impulse) * np.sqrt(seconds) * shape)


def deflection_under_force(beam: Beam, time: Floats, force: Floats) -> Floats:
    """Return w(0, t) in m at each `time` (s, shape (n,), ascending) under a `force` (N, (n,)).

    The response to an impulse convolved with the force, exactly so for a force that begins at zero
    and is linear between the times: every kink begins a ramp, and a ramp of s (N/s) leaves
    (4/15) s t^2.5/(mu sqrt(2 pi k)).
    """
    return _impulse_scale(beam, 4.0 / 15.0) * _ramps(time, force, 2.5)


def curvature_under_force(beam: Beam, time: Floats, force: Floats) -> Floats:
    """Return w_xx(0, t) = -w_t(0, t)/k in 1/m; see deflection_under_force."""
    return -_impulse_scale(beam, 2.0 / 3.0) / _wave_constant(beam) * _ramps(time, force, 1.5)


def _wave_constant(beam: Beam) -> float:
    """Return k in m2/s."""
    return math.sqrt(beam.bending_stiffness / beam.mass_per_length)


def _impulse_scale(beam: Beam, impulse: float) -> float:
    """Return J/(mu sqrt(2 pi k)), in m s^-0.5 for J in N s."""
    root = math.sqrt(2.0 * math.pi * _wave_constant(beam))
    return impulse / (beam.mass_per_length * root)


def _ramps(time: Floats, force: Floats, power: float) -> Floats:
    """Sum over the kinks of a force, before each time: change of slope x (time since)^power."""
    kinks = np.diff(np.diff(force) / np.diff(time), prepend=0.0)
    since = np.maximum(time[:, np.newaxis] - time[:-1], 0.0)
    return np.asarray(since**power @ kinks)
