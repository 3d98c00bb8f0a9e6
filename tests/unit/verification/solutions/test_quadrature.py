"""Integration rules against the integrals of powers and the tabled points."""

import numpy as np
import pytest

from impactlab.verification.solutions.bending import rule

DEGREE = {"lobatto": lambda n: 2 * n - 3, "legendre": lambda n: 2 * n - 1, "layers": lambda n: 1}


def errors(name, points):
    """Errors in the integral of each Legendre polynomial from degree 0 to 2 n + 1."""
    positions, weights = rule(name, points)
    table = np.polynomial.legendre.legvander(positions, 2 * points + 1)
    exact = np.zeros(2 * points + 2)
    exact[0] = 2.0
    return np.abs(weights @ table - exact)


@pytest.mark.parametrize("name", DEGREE)
@pytest.mark.parametrize("points", [2, 3, 5, 64])
def test_rule_is_exact_up_to_its_degree_and_no_further(name, points):
    error, degree = errors(name, points), DEGREE[name](points)
    assert error[: degree + 1].max() < 1e-13
    assert error[degree + 1] > 1e-4


def test_lobatto_points_are_the_tabled_ones():
    positions, weights = rule("lobatto", 5)
    np.testing.assert_allclose(positions, [-1, -np.sqrt(3 / 7), 0, np.sqrt(3 / 7), 1], atol=1e-15)
    np.testing.assert_allclose(weights, [1 / 10, 49 / 90, 32 / 45, 49 / 90, 1 / 10], atol=1e-15)
    # legendre points are the tabled ones
    positions, weights = rule("legendre", 3)
    np.testing.assert_allclose(positions, [-np.sqrt(0.6), 0, np.sqrt(0.6)], atol=1e-15)
    np.testing.assert_allclose(weights, [5 / 9, 8 / 9, 5 / 9], atol=1e-15)
    # layers are the midpoints
    positions, weights = rule("layers", 4)
    np.testing.assert_allclose(positions, [-0.75, -0.25, 0.25, 0.75])
    np.testing.assert_allclose(weights, 0.5)


def test_an_unknown_rule_is_named():
    with pytest.raises(ValueError, match="rule"):
        rule("simpson", 3)
