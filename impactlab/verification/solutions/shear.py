"""What shear and rotary inertia add to a beam of rectangular section: Timoshenko's theory.

Symbols: k, shear coefficient; a = k G A (N), shear stiffness; q = n pi/L (1/m), wave number;
omega (rad/s).
Source: S. Timoshenko, Phil. Mag. 41 (1921) 744 and 43 (1922) 125.
"""

from __future__ import annotations

import math

from impactlab.model.beam import Beam
from impactlab.model.checks import not_negative, positive
from impactlab.verification.solutions import bending


def shear_stiffness(beam: Beam) -> float:
    """K G A in N, G = E/(2 (1 + nu))."""
    modulus = beam.material.youngs_modulus / (2.0 * (1.0 + beam.material.poissons_ratio))
    return beam.shear_coefficient * modulus * beam.width * beam.depth


def static_deflection(beam: Beam, load: float) -> float:
    """Elastic mid-span deflection in m under a `load` P (N) there: P L^3/(48 EI) + P L/(4 k G A).

    Raises ValueError when the load is negative or not finite.
    """
    force = not_negative("shear", "load", load)
    shear = force * beam.span / (4.0 * shear_stiffness(beam))
    return bending.static_deflection(beam, force) + shear


def bending_frequency(beam: Beam) -> float:
    """omega_1 = (pi/L)^2 sqrt(EI/(rho A)) in rad/s, without shear and rotary inertia."""
    return (math.pi / beam.span) ** 2 * math.sqrt(beam.bending_stiffness / beam.mass_per_length)


def first_frequency(beam: Beam) -> float:
    """omega_1 in rad/s with shear and rotary inertia.

    The smaller root of rho^2 I/(k G) omega^4 - (rho A + rho I q^2 (1 + E/(k G))) omega^2 + EI q^4,
    q = pi/L, divided by rho A and omega_1 of bending squared so that it is one number's root:
    c x^2 - (1 + b) x + 1 = 0, x = (omega/omega_bending)^2.
    """
    r2 = beam.depth**2 / 12.0 * (math.pi / beam.span) ** 2
    ratio = _modulus_ratio(beam)
    b, c = r2 * (1.0 + ratio), r2**2 * ratio
    x = 2.0 / (1.0 + b + math.sqrt((1.0 + b) ** 2 - 4.0 * c))
    return bending_frequency(beam) * math.sqrt(x)


def static_share(beam: Beam) -> float:
    """Static deflection by shear over that by bending: 12 EI/(k G A L^2).

    Equals E/(k G) (H/L)^2; 3.12 (H/L)^2 for nu = 0.3. Where it is small, shear does not matter to
    motions as slow as the beam's first mode; whether it matters to a contact, impact_share tells.
    """
    return _modulus_ratio(beam) * (beam.depth / beam.span) ** 2


def impact_share(beam: Beam, duration: float) -> float:
    """How much shear and rotary inertia slow the waves that a contact of `duration` (s) makes.

    omega = c q^2 (1 - q^2 I (1 + E/(k G))/(2 A) + ...), c = sqrt(EI/(rho A)), of the wave that
    turns by pi during the contact, c q^2 = pi/duration: pi I (1 + E/(k G))/(2 A c duration). It
    goes with depth/duration and not with the span: a short contact feels shear in any beam. The
    paper's case: 0.044, where the peak force changes by half as much.

    Raises ValueError when the duration is not finite and positive.
    """
    wave_constant = math.sqrt(beam.bending_stiffness / beam.mass_per_length)
    square = math.pi / (wave_constant * positive("shear", "duration", duration))
    ratio = _modulus_ratio(beam)
    return 0.5 * square * beam.depth**2 / 12.0 * (1.0 + ratio)


def early_deflection(beam: Beam, load: float, time: float) -> float:
    """Deflection in m under a `load` F (N) that set on suddenly, a short `time` t (s) ago.

    w = F (t/(2 sqrt(a rho A)) + t^3/(24 EI p (p + b)^2)) + O(t^5): first the load meets the
    impedance of two shear waves, then sections begin to turn. p, b: slownesses (s/m) of the shear
    wave, sqrt(rho/(k G)), and of the bar wave, sqrt(rho/E).
    From the Laplace and Fourier transform of the infinite beam,
    W = F/s * 1/(X - a^2 q^2/(Y + a)), X = rho A s^2 + a q^2, Y = rho I s^2 + EI q^2, for large s
    F/s (1/X + a^2 q^2/(X^2 Y) + ...), integrated over q/(2 pi).

    Raises ValueError when load or time is negative or not finite.
    """
    force, t = not_negative("shear", "load", load), not_negative("shear", "time", time)
    a = shear_stiffness(beam)
    shear = math.sqrt(beam.mass_per_length / a)
    bar = math.sqrt(beam.material.density / beam.material.youngs_modulus)
    first = t / (2.0 * math.sqrt(a * beam.mass_per_length))
    third = t**3 / (24.0 * beam.bending_stiffness * shear * (shear + bar) ** 2)
    return force * (first + third)


def _modulus_ratio(beam: Beam) -> float:
    """E/(k G)."""
    area = beam.width * beam.depth
    return beam.material.youngs_modulus * area / shear_stiffness(beam)
