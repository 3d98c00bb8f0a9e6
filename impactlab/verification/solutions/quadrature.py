"""Integration rules on [-1, 1] from scipy's orthogonal polynomials (eigenvalues, no iteration).

Source: Davis and Rabinowitz, Methods of Numerical Integration (1984), section 2.7.
"""

from __future__ import annotations

import numpy as np
from scipy.special import roots_jacobi, roots_legendre

from impactlab.model.checks import integer, one_of
from impactlab.types import Floats

Rule = tuple[Floats, Floats]
"""Positions in ascending order and weights adding up to 2, both of shape (points,)."""


def lobatto(points: int) -> Rule:
    """Return the Gauss-Lobatto rule: both ends, exact up to degree 2 points - 3.

    Between the ends lie the Gauss points for the weight 1 - x^2, which are roots of the Jacobi
    polynomial P^(1,1), their weights divided by 1 - x^2.

    Raises ValueError when points is not a whole number of at least 2.
    """
    count = integer("quadrature", "points", points, 2)
    end = 2.0 / (count * (count - 1))
    if count == 2:
        return np.array([-1.0, 1.0]), np.array([end, end])
    inner, jacobi_weights = roots_jacobi(count - 2, 1.0, 1.0)
    positions = np.concatenate(([-1.0], inner, [1.0]))
    return positions, np.concatenate(([end], jacobi_weights / (1.0 - inner**2), [end]))


def legendre(points: int) -> Rule:
    """Return the Gauss-Legendre rule: no ends, exact up to degree 2 points - 1.

    Raises ValueError when points is not a whole number of at least 2.
    """
    positions, weights = roots_legendre(integer("quadrature", "points", points, 2))
    return positions, weights


def layers(points: int) -> Rule:
    """Return the midpoints of equal layers (Zhang et al.), exact up to degree 1.

    Raises ValueError when points is not a whole number of at least 2.
    """
    count = integer("quadrature", "points", points, 2)
    return (2.0 * np.arange(count) + 1.0) / count - 1.0, np.full(count, 2.0 / count)


_RULES = {"lobatto": lobatto, "legendre": legendre, "layers": layers}


def rule(name: str, points: int) -> Rule:
    """Return the rule of that name: "lobatto", "legendre" or "layers".

    Raises ValueError when the name is unknown or points is not a whole number of at least 2.
    """
    return _RULES[one_of("quadrature", "rule", name, tuple(_RULES))](points)
