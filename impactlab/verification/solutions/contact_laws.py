"""Every contact law written anew from its formulas, and its restitution by quadrature.

A sphere on a rigidly backed half-space: no gravity, no waves. Sources: docs/contact_laws.md and the
papers named there; Stronge's law with force continuity is in closed form, too.
Functions of plain numbers, all in SI: indentation d (m), effective modulus E (Pa) and radius R (m),
the softer body's yield stress S (Pa) and Poisson's ratio nu.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from impactlab.model.impact import Impact
from impactlab.verification.solutions import hertz as hertz_forms

YIELD_RATIOS, DEPTHS = (400.0, 505.0), (0.045, 0.024)
"""d/R beyond which the force of `finite_element` is linear at two E/S; between, interpolated."""
TERMS = (
    (0.032851, 0.16033, -0.05834),
    (0.14274, -0.074368, 0.18104),
    (0.30428, 0.099069, -0.20538),
    (0.52193, -0.0031981, 0.10893),
    (-0.34967, -0.023661, -0.0060407),
    (0.27275, 0.94754, -0.12506),
    (-0.63772, -1.8158, 0.35514),
    (-0.013167, 0.88056, -0.33247),
    (0.091938, -0.0044365, 0.015418),
    (-0.26216, 0.18624, -0.24951),
    (-0.11338, -0.45118, 0.44905),
    (-0.16653, 0.46002, 0.16059),
    (0.086868, -0.034504, -0.057829),
)
"""Of the fit to finite elements for bodies of one modulus: constant, linear and quadratic in
4 (nu - 0.3). Force: of w^2 to w^5 and w^2 ln x; of what is recovered, and of the exponent: of w^2
to w^4 and w^2 ln x; w = 1 - 1/sqrt(x)."""
STRAINS = (
    (-0.0048984, -0.003187, -0.0013478),
    (-0.0033468, -0.0016657, 0.0074778),
    (-0.0022506, 0.017417, 0.0075581),
)
"""Of w sqrt(x) (force), w^2 sqrt(x): constant, times 100 S/E, and that times 4 (nu - 0.3)."""

# Loading: F(d, E, R, S, nu) in N.


def hertz(d: float, E: float, R: float, S: float, nu: float) -> float:
    """Return F = (4/3) E sqrt(R) d^1.5."""
    return 4.0 / 3.0 * E * math.sqrt(R * d) * d


def stronge(d: float, E: float, R: float, S: float, nu: float) -> float:
    """Return pi a^2 p, a^2 = R (2 d - d_y): p = 1.1 S + S ln(u)/3, at most 2.8 S."""
    d_y = R * (0.825 * math.pi * S / E) ** 2
    if d <= d_y:
        return hertz(d, E, R, S, nu)
    u = 2.0 * d / d_y - 1.0
    pressure = min(1.1 * S + S * math.log(u) / 3.0, 2.8 * S)
    return math.pi * R * (2.0 * d - d_y) * pressure


def stronge_consistent(d: float, E: float, R: float, S: float, nu: float) -> float:
    """Return Stronge's force, at most that of Hertz."""
    return min(stronge(d, E, R, S, nu), hertz(d, E, R, S, nu))


def finite_element(d: float, E: float, R: float, S: float, nu: float) -> float:
    """Return the fit to finite elements for two like metals: Hertz bent down; linear at the end."""
    if d <= R * (0.825 * math.pi * S / E) ** 2:
        return hertz(d, E, R, S, nu)
    end = min(d, _largest(E, R, S))
    w, root, terms, strain = _fit(end, E, R, S, nu)
    powers = (w**2, w**3, w**4, w**5, 2.0 * w**2 * math.log(root))
    exponent = math.fsum(map(math.prod, zip(terms[:5], powers, strict=True)))
    bend = min(exponent + strain[0] * w * root, 0.0)
    return hertz(end, E, R, S, nu) * math.exp(bend) * d / end


def _largest(E: float, R: float, S: float) -> float:
    """Return the indentation at which the fit to finite elements ends."""
    return float(np.interp(E / S, YIELD_RATIOS, DEPTHS)) * R


def _fit(
    d: float, E: float, R: float, S: float, nu: float
) -> tuple[float, float, list[float], list[float]]:
    """Return 1 - 1/sqrt(x), sqrt(x) and the coefficients for bodies of one modulus."""
    root, v = math.sqrt(d / R) / (0.825 * math.pi * S / E), 4.0 * (nu - 0.3)
    terms = [c + linear * v + quadratic * v**2 for c, linear, quadratic in TERMS]
    m = 100.0 / min(max(E / S, 60.0), 1500.0)
    strain = [c + (flow + constraint * v) * m for c, flow, constraint in STRAINS]
    return 1.0 - 1.0 / root, root, terms, strain


def jackson_green(
    d: float, E: float, R: float, S: float, nu: float, modified: bool = False
) -> float:
    """Return the force of Jackson and Green 2005.

    modified: with the hardness H of Ghaednia, Brake, Berryhill and Jackson 2019, no hardening.
    """
    C = 1.295 * math.exp(0.736 * nu)
    d_c = R * (math.pi * C * S / (2.0 * E)) ** 2
    if d <= 1.9 * d_c:
        return hertz(d, E, R, S, nu)
    a = math.sqrt(R * d * (d / (1.9 * d_c)) ** (0.14 * math.exp(23.0 * S / E)))
    if modified:
        H = S * (1.92 + 0.92 * math.cos(math.pi * a / R))
    else:
        H = 2.84 * S * (1.0 - math.exp(-0.82 / (a / R) ** 0.7))
    y, F_c = d / d_c, 4.0 / 3.0 * (R / E) ** 2 * (math.pi * C * S / 2.0) ** 3
    faded = math.exp(-math.pow(y, 5.0 / 12.0) / 4.0)
    grown = 1.0 - math.exp(-math.pow(y, 5.0 / 9.0) / 25.0)
    return F_c * (faded * math.pow(y, 1.5) + 4.0 * H / (C * S) * grown * y)


def mjg(d: float, E: float, R: float, S: float, nu: float) -> float:
    """Return the modified force of Jackson and Green."""
    return jackson_green(d, E, R, S, nu, modified=True)


def thornton(d: float, E: float, R: float, S: float, nu: float) -> float:
    """Return the force of Thornton 1997 with the limiting pressure 1.6 S."""
    p_y = 1.6 * S
    d_y = R * (math.pi * p_y / (2.0 * E)) ** 2
    if d <= d_y:
        return hertz(d, E, R, S, nu)
    F_y = (R / E) ** 2 * (math.pi * p_y) ** 3 / 6.0
    return F_y + math.pi * p_y * R * (d - d_y)


def kogut_etsion(d: float, E: float, R: float, S: float, nu: float) -> float:
    """Return the force of Kogut and Etsion 2002; F_c = (2/3) pi K H R d_c."""
    K, H = 0.454 + 0.41 * nu, 2.8 * S
    d_c = R * (math.pi * K * H / (2.0 * E)) ** 2
    y, F_c = d / d_c, 2.0 / 3.0 * math.pi * K * H * R * d_c
    if y <= 1.0:
        return hertz(d, E, R, S, nu)
    if y <= 6.0:
        return F_c * 1.03 * math.pow(y, 1.425)
    if y <= 110.0:
        return F_c * 1.40 * math.pow(y, 1.263)
    return F_c * 3.0 / K * y


Unloading = tuple[float, float, float]
"""Unloading from d: (force at its start in N, indentation at its end in m, exponent)."""


def elastic_unloading(d: float, F: float, E: float, R: float, S: float, nu: float) -> Unloading:
    """Return the unloading of Hertz's law."""
    return F, 0.0, 1.5


def wang_unloading(d: float, F: float, E: float, R: float, S: float, nu: float) -> Unloading:
    """Return the paper's Eqs. 15 to 17: R_e = sqrt(3 F/(4 E)) (R/d_y)^(3/4)."""
    d_y = R * (0.825 * math.pi * S / E) ** 2
    if d <= d_y:
        return F, 0.0, 1.5
    R_e = math.sqrt(3.0 * F / (4.0 * E)) * (R / d_y) ** 0.75
    return F, d - d_y * R_e / R, 1.5


def stronge_unloading(d: float, F: float, E: float, R: float, S: float, nu: float) -> Unloading:
    """Recover d_y sqrt(2 d/d_y - 1) from the force F_y (2 d/d_y - 1) on (Stronge 2000)."""
    d_y = R * (0.825 * math.pi * S / E) ** 2
    if d <= d_y:
        return F, 0.0, 1.5
    u = 2.0 * d / d_y - 1.0
    return 1.1 * math.pi * S * R * d_y * u, d - d_y * math.sqrt(u), 1.5


def jackson_unloading(d: float, F: float, E: float, R: float, S: float, nu: float) -> Unloading:
    """Return Jackson, Chusoipin and Green 2005; at least 1 % is recovered."""
    d_c = R * (math.pi * 1.295 * math.exp(0.736 * nu) * S / (2.0 * E)) ** 2
    if d <= d_c:
        return F, 0.0, 1.5
    share = 1.02 - 1.02 * (6.9 / (d / d_c + 5.9)) ** 0.54
    return F, d * min(share, 0.99), 1.5


def finite_unloading(d: float, F: float, E: float, R: float, S: float, nu: float) -> Unloading:
    """Return the fit to finite elements for two like metals."""
    v, d_y = nu - 0.3, R * (0.825 * math.pi * S / E) ** 2
    first = 0.97744 + 0.72573 * v + 0.34947 * v**2 + 0.13914 * v**3
    if d <= d_y * min(first, 1.0) ** 2:
        return F, 0.0, 1.5
    w, root, terms, strain = _fit(min(d, _largest(E, R, S)), E, R, S, nu)
    late, w = max(1.0 - first / root, 0.0), max(w, 0.0)
    powers = (w**2, w**3, w**4, 2.0 * w**2 * math.log(root))
    shares, exponents = (
        math.fsum(map(math.prod, zip(terms[i : i + 4], powers, strict=True))) for i in (5, 9)
    )
    share = 1.0 + 0.36 * w + shares + strain[1] * w**2 * root
    n = 1.5 - 0.074 * w + exponents + strain[2] * w**2 * root
    dent = d - share * d_y * math.sqrt(F / hertz(d_y, E, R, S, nu))
    early = np.interp(late, (0.35, 0.5), (1.0, 0.0))
    shallow = math.exp(-0.589 + 0.352 * late) * late**1.627
    shallow *= 0.5**0.218 * late ** (-0.241 * math.log(0.5))
    n += early * (1.5 - min(2.0 * shallow, 0.23 * math.sqrt(shallow)) - n)
    return F, dent + early * (d * shallow - dent), float(n)


def thornton_unloading(d: float, F: float, E: float, R: float, S: float, nu: float) -> Unloading:
    """Follow Hertz on R_p = (4 E/(3 F)) ((2 F + F_y)/(2 pi p_y))^1.5 (Thornton 1997)."""
    p_y = 1.6 * S
    F_y = (R / E) ** 2 * (math.pi * p_y) ** 3 / 6.0
    if d <= (math.pi * p_y / (2.0 * E)) ** 2 * R:
        return F, 0.0, 1.5
    a_squared = (2.0 * F + F_y) / (2.0 * math.pi * p_y)
    R_p = 4.0 * E / (3.0 * F) * a_squared**1.5
    return F, d - (9.0 * F**2 / (16.0 * E**2 * R_p)) ** (1.0 / 3.0), 1.5


def etsion_unloading(d: float, F: float, E: float, R: float, S: float, nu: float) -> Unloading:
    """Return Etsion, Kligerman and Kadin 2005."""
    y = d / (R * (1.4 * math.pi * (0.454 + 0.41 * nu) * S / E) ** 2)
    if y <= 1.0:
        return F, 0.0, 1.5
    return F, d * (1.0 - 1.0 / y**0.28) * (1.0 - 1.0 / y**0.69), 1.5 / y**0.0331


def brake_unloading(d: float, F: float, E: float, R: float, S: float, nu: float) -> Unloading:
    """Return Brake 2015, elastic until the loading leaves Hertz's."""
    onset = 1.9 * R * (math.pi * 1.295 * math.exp(0.736 * nu) * S / (2.0 * E)) ** 2
    if d <= onset:
        return F, 0.0, 1.5
    return F, d * (1.0 - F / hertz(d, E, R, S, nu)), 1.5


LAWS: dict[str, tuple[Callable[..., float], Callable[..., Unloading]]] = {
    "hertz": (hertz, elastic_unloading),
    "stronge": (stronge, wang_unloading),
    "stronge_original": (stronge, stronge_unloading),
    "jackson_green": (jackson_green, jackson_unloading),
    "mjg": (mjg, jackson_unloading),
    "thornton": (thornton, thornton_unloading),
    "kogut_etsion": (kogut_etsion, etsion_unloading),
    "brake": (mjg, brake_unloading),
    "stronge_consistent": (stronge_consistent, wang_unloading),
    "finite_element": (finite_element, finite_unloading),
}
"""Loading and unloading of each law, by name."""


def joints(E: float, R: float, S: float, nu: float) -> list[float]:
    """Return the indentations (m) at which some law changes its form, ascending."""
    stronge_y = R * (0.825 * math.pi * S / E) ** 2
    jackson_c = R * (math.pi * 1.295 * math.exp(0.736 * nu) * S / (2.0 * E)) ** 2
    thornton_y = R * (0.8 * math.pi * S / E) ** 2
    kogut_c = R * (1.4 * math.pi * (0.454 + 0.41 * nu) * S / E) ** 2
    plastic = 0.5 * (math.exp(5.1) + 1.0)
    capped = 15.415907653904072  # where x^1.5 = (2 x - 1) (1 + ln(2 x - 1)/3.3)
    steps = (
        (stronge_y, (1.0, capped, plastic)),
        (jackson_c, (1.0, 1.9)),
        (kogut_c, (1.0, 6.0, 110.0)),
    )
    ends = thornton_y, _largest(E, R, S)
    return sorted([*ends, *(d * x for d, shares in steps for x in shares)])


@dataclass(frozen=True)
class LawOnHalfSpace:
    """A law between two bodies: effective_modulus, yield_stress in Pa, effective_radius in m."""

    law: str
    effective_modulus: float
    effective_radius: float
    yield_stress: float
    poissons_ratio: float

    @property
    def pair(self) -> tuple[float, float, float, float]:
        """E, R, S, nu, as the functions above take them."""
        bodies = self.effective_modulus, self.effective_radius
        return (*bodies, self.yield_stress, self.poissons_ratio)

    def loading_force(self, indentation: float) -> float:
        """Return F in N at a monotonically reached indentation (m)."""
        return LAWS[self.law][0](indentation, *self.pair)

    def unloading(self, indentation: float) -> Unloading:
        """Return the unloading after `indentation` (m)."""
        return LAWS[self.law][1](indentation, self.loading_force(indentation), *self.pair)

    def unloading_force(self, indentation: float, deepest: float) -> float:
        """Return F in N on the way back from `deepest` to `indentation` (both in m)."""
        force, end, exponent = self.unloading(deepest)
        return force * math.pow(max(indentation - end, 0.0) / (deepest - end), exponent)

    def residual_indentation(self, indentation: float) -> float:
        """Return the residual of `indentation`, in m."""
        return self.unloading(indentation)[1]

    def loading_work(self, indentation: float) -> float:
        """Integrate the force up to `indentation`, in J: adaptive quadrature between joints."""
        inner = [d for d in joints(*self.pair) if d < indentation]
        ends = [0.0, *inner, indentation]
        return sum(_quadrature(self, *piece) for piece in pairwise(ends))

    def released_work(self, indentation: float) -> float:
        """Return the integral of the unloading curve, in J: a power law."""
        force, end, exponent = self.unloading(indentation)
        return force * (indentation - end) / (exponent + 1.0)

    def maximum_indentation(self, velocity: float, mass: float) -> float:
        """Find where the loading work is the energy of `mass` (kg) at `velocity` (m/s), in m."""
        energy = 0.5 * mass * velocity**2
        high = hertz_forms.maximum_indentation(mass, velocity, *self.pair[:2])
        while self.loading_work(high) < energy:
            high *= 2.0
        low = 0.5 * high
        while self.loading_work(low) > energy:
            low *= 0.5
        return float(
            brentq(lambda d: self.loading_work(d) - energy, low, high, xtol=1e-16, rtol=1e-13)
        )

    def restitution(self, velocity: float, mass: float) -> float:
        """Return sqrt(released/put in) of `mass` (kg) at `velocity` (m/s)."""
        deepest = self.maximum_indentation(velocity, mass)
        return math.sqrt(self.released_work(deepest) / self.loading_work(deepest))


@cache
def _quadrature(law: LawOnHalfSpace, start: float, stop: float) -> float:
    return float(quad(law.loading_force, start, stop, epsabs=0.0, epsrel=1e-11)[0])


def law_on_half_space(impact: Impact) -> LawOnHalfSpace:
    """Return the law and the bodies of `impact` as if the beam were a half-space."""
    sphere, beam = impact.sphere.material, impact.beam.material
    softer = beam if beam.yield_stress <= sphere.yield_stress else sphere
    bodies = hertz_forms.effective_modulus(impact), impact.sphere.radius
    return LawOnHalfSpace(impact.contact, *bodies, softer.yield_stress, softer.poissons_ratio)


CONSTRAINT = 1.1  # th: mean contact pressure over yield stress at first yield
HARDNESS = 2.8  # mean contact pressure over yield stress when fully plastic
U_PLASTIC = math.exp(3.0 * (HARDNESS - CONSTRAINT))
"""u = 164.02 (x = 82.511), where the two plastic branches meet without a jump."""


class StrongeImpact(LawOnHalfSpace):
    """Stronge's law with force continuity, its work of loading in closed form.

    Sources: W. J. Stronge, Impact Mechanics (2000), section 6.4, for loading; Wang et al., as the
    paper takes it (its Table 1 and Eqs. 15 to 17), for unloading. With x = delta/delta_y, it leaves
    a bulge for 1 < x < 1.998, and gives back more than was put in for 1 < x < 2.673 (a restitution
    of at most 1.101, at x = 1.415), whatever the bodies. u = 2 x - 1.
    """

    def __init__(self, modulus: float, radius: float, yield_stress: float) -> None:
        """Take the bodies; the law does not depend on Poisson's ratio."""
        super().__init__("stronge", modulus, radius, yield_stress, math.nan)

    @property
    def yield_indentation(self) -> float:
        """delta_y = (3 pi th sigma_y/(4 E*))^2 R* in m."""
        pressure = CONSTRAINT * self.yield_stress
        return (0.75 * math.pi * pressure / self.effective_modulus) ** 2 * self.effective_radius

    @property
    def yield_force(self) -> float:
        """F_y = (4/3) E* sqrt(R*) delta_y^1.5 in N."""
        stiffness = hertz_forms.stiffness(self.effective_modulus, self.effective_radius)
        return stiffness * math.pow(self.yield_indentation, 1.5)

    def loading_work(self, indentation: float) -> float:
        """Return the energy in J put in up to a monotonically reached `indentation` (m)."""
        x = indentation / self.yield_indentation
        return self.yield_force * self.yield_indentation * _work(x)

    def maximum_indentation(self, velocity: float, mass: float) -> float:
        """Return delta_m in m, where the loading work is the energy of `mass` (kg)."""
        energy = 0.5 * mass * velocity**2
        scaled = energy / (self.yield_force * self.yield_indentation)
        if scaled <= 0.4:
            return self.yield_indentation * math.pow(scaled / 0.4, 0.4)
        # F >= F_y u, hence the work is at least 0.4 + (u^2 - 1)/4: this bounds u.
        limit = 0.5 + 0.5 * math.sqrt(1.0 + 4.0 * scaled)
        root = brentq(lambda x: _work(x) - scaled, 1.0, limit, xtol=1e-13, rtol=1e-14)
        return self.yield_indentation * float(root)


def stronge_impact(impact: Impact) -> StrongeImpact:
    """Return the bodies of `impact` on a half-space; its contact law and gravity are ignored."""
    return StrongeImpact(
        hertz_forms.effective_modulus(impact),
        impact.sphere.radius,
        min(impact.sphere.material.yield_stress, impact.beam.material.yield_stress),
    )


def _work(x: float) -> float:
    """Return the loading work over F_y delta_y."""
    if x <= 1.0:
        return 0.4 * math.pow(x, 2.5)
    u = 2.0 * x - 1.0
    mixed = min(u, U_PLASTIC)
    logarithm = mixed**2 * math.log(mixed) / 2.0 - mixed**2 / 4.0 + 0.25
    elastic_plastic = ((mixed**2 - 1.0) / 2.0 + logarithm / (3.0 * CONSTRAINT)) / 2.0
    return 0.4 + elastic_plastic + HARDNESS / CONSTRAINT * (u**2 - mixed**2) / 4.0
