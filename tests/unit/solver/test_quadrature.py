"""The rules computed by Newton's method against scipy's eigenvalues and exact integrals."""

import numpy as np
import pytest

from impactlab.solver import RULES
from impactlab.solver.section import rule_points, upper_half
from impactlab.verification.solutions import quadrature

COUNTS = [*range(2, 22), 32, 33, 48, 63, 64]
DEGREE = {"lobatto": lambda n: 2 * n - 3, "legendre": lambda n: 2 * n - 1, "layers": lambda n: 1}


def half(rule, points):
    positions, weights = np.full(points // 2, np.nan), np.full(points // 2, np.nan)
    upper_half(RULES.index(rule), points, positions, weights)
    return positions, weights


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("points", COUNTS)
def test_points_and_weights_are_those_of_scipy(rule, points):
    positions, weights = half(rule, points)
    expected_positions, expected_weights = quadrature.rule(rule, points)
    above = slice(None, -(points // 2) - 1, -1)  # outermost first, the axis left out
    np.testing.assert_allclose(positions, expected_positions[above], rtol=1e-13, atol=0)
    np.testing.assert_allclose(weights, expected_weights[above], rtol=1e-11, atol=0)
    np.testing.assert_allclose(rule_points(rule, points), expected_positions, rtol=0, atol=1e-14)
    assert np.any(rule_points(rule, points) == 0) == points % 2


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("points", COUNTS)
def test_even_powers_are_integrated_up_to_the_rules_degree_and_no_further(rule, points):
    positions, weights = half(rule, points)
    degree = DEGREE[rule](points)

    def error(power):
        return 2 * (weights @ positions**power) * (power + 1) / 2 - 1

    for power in range(2, degree + 1, 2):
        assert abs(error(power)) < 1e-12
    if points < 20:  # then the error is above rounding
        first_missed = max(2, degree + 1 + (degree + 1) % 2)
        assert abs(error(first_missed)) > 1e-13
