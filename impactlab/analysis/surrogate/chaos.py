"""A polynomial chaos: a sum of products of Legendre polynomials on the unit cube."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

from impactlab.analysis.surrogate.terms import Degrees

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Chaos:
    """A fitted response: called with points, it predicts.

    degrees: (terms, parameters). coefficients: (terms,), in the response's unit.
    """

    degrees: Degrees
    coefficients: Array

    def __call__(self, unit: Array) -> Array:
        """The response at points of the unit cube, (points, parameters) to (points,)."""
        return np.asarray(self.coefficients @ basis(unit, self.degrees))


def basis(unit: Array, degrees: Degrees) -> Array:
    """Every term at every point of the unit cube: (terms, points) from (points, parameters).

    A term is a product of Legendre polynomials sqrt(2 a + 1) P_a(2 u - 1), by recurrence: of mean
    zero and variance one, and uncorrelated with every other term, where u is uniform.
    """
    highest = int(degrees.max(initial=0))
    scale = np.sqrt(2 * np.arange(highest + 1) + 1)[:, np.newaxis]
    product = np.ones((len(degrees), len(unit)))
    for values, column in zip(unit.T, degrees.T, strict=True):
        single = scale * legvander(2 * values - 1, highest).T
        active = np.flatnonzero(column)
        product[active] *= single[column[active]]
    return product
