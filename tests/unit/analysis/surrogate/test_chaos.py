"""The basis against scipy's polynomials, exact quadrature and a count by brute force."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from scipy.special import eval_legendre

from impactlab.analysis.surrogate.chaos import Chaos, basis, candidates, hyperbolic


def _norm(row: tuple[int, ...]) -> float:
    return sum(part**0.7 for part in row) ** (1 / 0.7)


@pytest.mark.parametrize(("parameters", "degree"), [(1, 5), (2, 7), (3, 6), (4, 5)])
def test_a_set_holds_just_the_terms_of_small_norm(parameters: int, degree: int) -> None:
    every = product(range(degree + 1), repeat=parameters)
    expected = {row for row in every if _norm(row) <= degree + 1e-9}
    found = [tuple(row) for row in hyperbolic(parameters, degree).tolist()]
    assert len(found) == len(expected)
    assert set(found) == expected
    assert not any(found[0])  # the constant


def test_candidates_are_the_largest_set_that_is_allowed() -> None:
    sizes = [len(hyperbolic(3, degree)) for degree in range(6)]
    assert len(candidates(3, sizes[4], highest=20)) == sizes[4]
    assert len(candidates(3, sizes[4] - 1, highest=20)) == sizes[3]
    assert len(candidates(3, 10_000, highest=2)) == sizes[2]


def test_terms_are_products_of_scipys_polynomials() -> None:
    unit = np.random.default_rng(0).random((50, 3))
    degrees = np.array([[0, 0, 0], [4, 0, 1], [0, 12, 0], [1, 2, 3]])
    for row, values in zip(degrees, basis(unit, degrees), strict=True):
        factors = [
            np.sqrt(2 * a + 1) * eval_legendre(a, 2 * u - 1)
            for a, u in zip(row, unit.T, strict=True)
        ]
        np.testing.assert_allclose(values, np.prod(factors, axis=0), rtol=1e-11, atol=1e-12)


def test_the_basis_is_orthonormal() -> None:
    nodes, weights = np.polynomial.legendre.leggauss(8)  # exact up to degree 15
    unit = np.array(list(product((nodes + 1) / 2, repeat=2)))
    weight = np.array([a * b for a, b in product(weights / 2, repeat=2)])
    columns = basis(unit, hyperbolic(2, 7))
    np.testing.assert_allclose(columns * weight @ columns.T, np.eye(len(columns)), atol=1e-12)


def test_a_chaos_is_the_sum_of_its_terms() -> None:
    unit = np.array([[0.0, 0.5], [0.25, 1.0]])
    chaos = Chaos(np.array([[0, 0], [1, 0], [0, 2]]), np.array([2.0, 3.0, 5.0]))
    linear, quadratic = 2 * unit[:, 0] - 1, 1.5 * (2 * unit[:, 1] - 1) ** 2 - 0.5
    expected = 2 + 3 * np.sqrt(3) * linear + 5 * np.sqrt(5) * quadratic
    np.testing.assert_allclose(chaos(unit), expected, rtol=1e-14)
