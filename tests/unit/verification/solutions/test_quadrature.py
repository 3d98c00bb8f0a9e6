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
@pytest.mark.parametrize("points", [2, 3, 4, 5, 9, 16, 33, 64])
def test_rule_is_exact_up_to_its_degree_and_no_further(name, points):
    error, degree = errors(name, points), DEGREE[name](points)
    assert error[: degree + 1].max() < 1e-13
    assert error[degree + 1] > 1e-4


def test_an_unknown_rule_is_named():
    with pytest.raises(ValueError, match="rule"):
        rule("simpson", 3)
