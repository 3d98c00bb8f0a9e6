"""Polynomials orthonormal with respect to the distribution of a parameter.

Their variable is the parameter itself, or its logarithm where the distribution is logarithmic,
less its mean, over its standard deviation: in probabilities a normal parameter would be S-shaped,
which no polynomial follows at the ends. The recurrence coefficients come from Stieltjes' procedure
on a fine quadrature of the density, so that one procedure covers every distribution: Gautschi
(2004), Orthogonal Polynomials, section 2.2.3 (recalled, not read). For a uniform parameter they are
Legendre's, for a normal one Hermite's: Xiu and Karniadakis (2002), SIAM J. Sci. Comput. 24, 619.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from impactlab.methods.distributions import Distribution
from impactlab.types import Floats

HIGHEST_DEGREE = 20


@dataclass(frozen=True)
class Polynomials:
    """The polynomials of one parameter, up to HIGHEST_DEGREE.

    logarithmic: whether they take the logarithm of the value. centre, scale: mean and standard
    deviation of what they take. diagonal, beside: recurrence coefficients a_n and b_n, n from 0
    (b_0 is not used), for the standardised variable z:
    b_(n+1) p_(n+1) = (z - a_n) p_n - b_n p_(n-1).
    """

    logarithmic: bool
    centre: float
    scale: float
    diagonal: tuple[float, ...]
    beside: tuple[float, ...]

    def standardised(self, values: Floats) -> Floats:
        """Return values in SI units less their mean, over their standard deviation."""
        plain = np.log(values) if self.logarithmic else values
        return np.asarray((plain - self.centre) / self.scale)

    def __call__(self, standardised: Floats, highest: int) -> Floats:
        """Return the polynomials of degree 0 to `highest`, (degrees, points)."""
        polynomials = np.ones((highest + 1, standardised.size))
        below = np.zeros(standardised.size)
        for n in range(highest):
            raised = (standardised - self.diagonal[n]) * polynomials[n] - self.beside[n] * below
            below, polynomials[n + 1] = polynomials[n], raised / self.beside[n + 1]
        return polynomials


@cache
def orthonormal(distribution: Distribution) -> Polynomials:
    """Return the polynomials of a distribution."""
    nodes, weights = distribution.quadrature()
    centre = float(weights @ nodes)
    scale = float(np.sqrt(weights @ (nodes - centre) ** 2))
    z = (nodes - centre) / scale
    diagonal, beside = [], [0.0]
    below, present = np.zeros(z.size), np.ones(z.size)
    for _ in range(HIGHEST_DEGREE + 1):
        diagonal.append(float(weights @ (z * present**2)))
        raised = (z - diagonal[-1]) * present - beside[-1] * below
        beside.append(float(np.sqrt(weights @ raised**2)))
        below, present = present, raised / beside[-1]
    return Polynomials(distribution.is_logarithmic, centre, scale, tuple(diagonal), tuple(beside))
