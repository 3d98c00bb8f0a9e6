"""Integration rules on [-1, 1] from scipy's orthogonal polynomials (eigenvalues, no iteration).

Source: Davis and Rabinowitz, Methods of Numerical Integration (1984), section 2.7.
"""

import numpy as np
from scipy.special import roots_jacobi, roots_legendre

from impactlab.types import Floats


def rule(name: str, points: int) -> tuple[Floats, Floats]:
    """Return positions in ascending order and weights adding up to 2, both of shape (points,).

    "lobatto": both ends, exact up to degree 2 points - 3; between the ends lie the Gauss points for
    the weight 1 - x^2, which are roots of the Jacobi polynomial P^(1,1), their weights divided by
    1 - x^2. "legendre": no ends, exact up to degree 2 points - 1. "layers": the midpoints of equal
    layers (Zhang et al.), exact up to degree 1.

    Raises ValueError when the name is unknown.
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
