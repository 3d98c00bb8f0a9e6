"""Impact on a yielding beam by fibre elements, implicit in time, as programs for frames solve it.

Half the beam in cubic elements of two Gauss sections each, denser towards mid-span, with consistent
mass; sections of fibres; the sphere and the contact law in the same equations. Newmark's average
acceleration with Newton's iterations; OpenSees' dispBeamColumn elements do the same. Sources:
N. M. Newmark, J. Eng. Mech. Div. 85 (1959) 67; Simo, Hughes, Computational Inelasticity (1998),
box 1.5, for the fibres; F. McKenna, Comput. Sci. Eng. 13 (2011) 58.

Degrees of freedom: deflection (m) and slope of each node from the support to mid-span, without the
support's deflection and mid-span's slope; then the sphere. All are of half the impact.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solveh_banded
from scipy.sparse import csr_array

from impactlab.model.bodies import Beam
from impactlab.model.impact import Impact
from impactlab.types import Floats
from impactlab.verification.solutions import bending
from impactlab.verification.solutions.contact_laws import LawOnHalfSpace, law_on_half_space

_GRADING = 1.5  # distances from mid-span go with this power of the element's number
_MOST_ITERATIONS, _CLOSE = 30, 1e-10


@dataclass(frozen=True)
class FibreRun:
    """Histories, (steps + 1,), in SI units, and the plastic dissipation at the end in J."""

    time: Floats
    contact_force: Floats
    midspan_deflection: Floats
    plastic_dissipation: float

    @property
    def peak_force(self) -> float:
        """Largest contact force at the end of a step, in N."""
        return float(self.contact_force.max())


def solve(
    impact: Impact,
    duration: float,
    *,
    elements: int,
    steps: int,
    rule: str = "lobatto",
    points: int = 9,
) -> FibreRun:
    """Solve the impact over `duration` (s), with so many elements in the half beam.

    Raises RuntimeError when Newton's iterations do not converge.
    """
    beam, law, dt = impact.beam, law_on_half_space(impact), duration / steps
    material = beam.material
    E, H_i, H_k = (
        material.youngs_modulus,
        material.isotropic_hardening_modulus,
        material.kinematic_hardening_modulus,
    )
    z, area = beam.section.fibres(*bending.rule(rule, points))
    bend, length, mass = _elements(beam, elements)
    mass[-1, -1] = 0.5 * impact.sphere.total_mass
    size = len(mass)
    # Lower bands of symmetric matrices; those of the stiffness per EI of the sections.
    inertia = np.stack([_padded(np.diag(mass, -d), size) for d in range(4)])
    inertia *= 4.0 / dt**2
    pairs = [_padded(length * (bend[:, d:] * bend[:, : size - d]).T, size) for d in range(4)]
    per_section = csr_array(np.concatenate(pairs))
    weight = mass[-1] * impact.gravity
    bend, mass = csr_array(bend), csr_array(mass)
    strain_p, peeq = np.zeros((2, length.size, points))
    x, v, a = np.zeros((3, size))
    v[-1], a[-1] = impact.velocity, impact.gravity
    deepest, samples = 0.0, np.zeros((2, steps + 1))
    for step in range(1, steps + 1):
        new, change = x + dt * v, np.full(size, np.inf)
        pushed = mass @ (4.0 / dt**2 * new + a) + weight
        for _ in range(_MOST_ITERATIONS):
            strain = -np.multiply.outer(bend @ new, z)
            trial = E * (strain - strain_p)
            away = trial - H_k * strain_p
            slip = np.maximum(np.abs(away) - (material.yield_stress + H_i * peeq), 0.0)
            slip /= E + H_i + H_k
            flow = np.sign(away) * slip
            delta = float(new[-1] - new[-2])
            force, slope = _contact(law, delta, deepest)
            if np.max(np.abs(change[-2:])) <= _CLOSE * np.max(np.abs(new[-2:])):
                break
            moment = length * ((trial - E * flow) @ (area * z))
            modulus = np.where(slip > 0.0, E * (H_i + H_k) / (E + H_i + H_k), E)
            stiffness = (per_section @ (modulus @ (area * z**2))).reshape(4, size) + inertia
            stiffness[0, -2:] += 0.5 * slope
            stiffness[1, -2] -= 0.5 * slope
            left = pushed - 4.0 / dt**2 * (mass @ new) + bend.T @ moment
            left[-2:] += 0.5 * force, -0.5 * force
            change = solveh_banded(stiffness, left, lower=True, check_finite=False)
            new += change
        else:
            raise RuntimeError(f"fibre elements: no convergence in step {step}")
        strain_p, peeq, deepest = strain_p + flow, peeq + slip, max(deepest, delta)
        moved = new - x
        x, v, a = new, 2.0 / dt * moved - v, 4.0 / dt**2 * moved - 4.0 / dt * v - a
        samples[:, step] = force, x[-2]
    lost = (material.yield_stress + 0.5 * H_i * peeq) * peeq
    time, dissipation = np.linspace(0.0, duration, steps + 1), 2.0 * float(length @ lost @ area)
    return FibreRun(time, samples[0], samples[1], dissipation)


def _padded(entries: Floats, size: int) -> Floats:
    """Return entries, (n,) or (n, sections), with zeros beneath up to (size,) of them."""
    return np.concatenate([entries, np.zeros((size - len(entries), *entries.shape[1:]))])


def _contact(law: LawOnHalfSpace, delta: float, deepest: float) -> tuple[float, float]:
    """Return the force (N) at an indentation (m) after a deepest one, and its slope (N/m)."""

    def force(d: float) -> float:
        if d >= deepest:
            return law.loading_force(d) if d > 0.0 else 0.0
        return law.unloading_force(d, deepest) if deepest > 0.0 else 0.0

    apart = 1e-7 * max(abs(delta), 1e-9)
    value = force(delta)
    return value, (force(delta + apart) - value) / apart


def _elements(beam: Beam, elements: int) -> tuple[Floats, Floats, Floats]:
    """Return (curvatures, lengths, mass) of the sections and degrees of freedom.

    curvatures of the sections per degree of freedom, (2 elements, 2 elements + 1); lengths of the
    sections in m; mass in kg, the sphere's left at zero.
    """
    ends = 0.5 * beam.span * (1.0 - np.linspace(1.0, 0.0, elements + 1) ** _GRADING)
    gauss, weights = bending.rule("legendre", 2)
    s = 0.5 * (gauss + 1.0)
    size = 2 * elements + 2
    bend, lengths = np.zeros((2 * elements, size)), np.zeros(2 * elements)
    mass = np.zeros((size, size))
    for e, h in enumerate(np.diff(ends)):
        dofs = slice(2 * e, 2 * e + 4)
        two = slice(2 * e, 2 * e + 2)
        shapes = (12 * s - 6) / h**2, (6 * s - 4) / h, (6 - 12 * s) / h**2, (6 * s - 2) / h
        bend[two, dofs] = np.column_stack(shapes)
        lengths[two] = 0.5 * h * weights
        coefficients = [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]
        scale = np.array([1.0, h, 1.0, h])
        mass[dofs, dofs] += beam.mass_per_length * h / 420 * np.outer(scale, scale) * coefficients
    # Without the support's deflection, and the sphere in the place of mid-span's slope.
    bend[:, -1], mass[-1], mass[:, -1] = 0.0, 0.0, 0.0
    return bend[:, 1:], lengths, mass[1:, 1:]
