"""Polynomials of each distribution: orthonormal, those of textbooks, and straight at the ends."""

from typing import Any

import numpy as np
import pytest
import scipy.stats
from numpy.polynomial.hermite_e import hermevander
from numpy.polynomial.legendre import legvander
from scipy.special import factorial

from impactlab.analysis.surrogate.chaos import fit, indices, influence, orthonormal
from impactlab.methods.distributions import distribution_of

YIELD = {
    "distribution": "truncated_normal",
    "mean": 345e6,
    "standard_deviation": 25e6,
    "low": 270e6,
    "high": 420e6,
}
KINDS: list[dict[str, Any]] = [
    YIELD,
    YIELD | {"mean": 60e6, "standard_deviation": 4e6},  # what is left of a far tail
    YIELD | {"low": 0.0, "high": 1e15},
    {"distribution": "uniform", "low": -1.0, "high": 3.0},
    {"distribution": "log_uniform", "low": 0.1, "high": 20.0},
    {"distribution": "normal", "mean": 2e11, "standard_deviation": 4e9},
    {"distribution": "lognormal", "median": 0.03, "geometric_standard_deviation": 1.04},
    {"distribution": "triangular", "low": 190e9, "mode": 190e9, "high": 230e9},
    {"distribution": "triangular", "low": 0.0264, "mode": 0.0275, "high": 0.0292},
]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind["distribution"])
def test_polynomials_are_orthonormal_under_their_distribution(kind):
    """Integrated over probabilities, which the recurrence never sees."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    edges = np.array([*10.0 ** np.arange(-15, 0), *np.linspace(0.15, 0.85, 21)])
    edges = np.unique(
        [0.0, *edges, *(1 - edges), distribution_of(kind).cumulative(kind.get("mode", -np.inf))]
    )
    half = np.diff(edges)[:, np.newaxis] / 2
    probabilities = (edges[:-1, np.newaxis] + half * (1 + nodes)).ravel()
    polynomials = orthonormal(distribution_of(kind))
    values = polynomials(polynomials.standardised(distribution_of(kind).quantile(probabilities)), 4)
    products = values * (half * weights).ravel() @ values.T
    np.testing.assert_allclose(products, np.eye(5), atol=2e-5)


@pytest.mark.parametrize("kind", KINDS[3:7], ids=lambda kind: kind["distribution"])
def test_uniform_is_legendre_and_normal_is_hermite(kind):
    z, degrees = np.linspace(-1.7, 1.7, 9), np.arange(21)
    if "uniform" in kind["distribution"]:
        expected = np.sqrt(2 * degrees + 1) * legvander(z / np.sqrt(3), 20)
    else:
        expected = hermevander(z, 20) / np.sqrt(factorial(degrees))
    np.testing.assert_allclose(
        orthonormal(distribution_of(kind))(z, 20), expected.T, rtol=1e-9, atol=1e-11
    )


def _stress(kind, seed, runs=300):
    kinds = [kind, {"distribution": "uniform", "low": 0.0, "high": 1.0}]
    unit = scipy.stats.qmc.LatinHypercube(2, rng=np.random.default_rng(seed)).random(runs)
    inputs = np.column_stack(
        [distribution_of(k).quantile(u) for k, u in zip(kinds, unit.T, strict=True)]
    )
    return (
        kinds,
        inputs,
        tuple(orthonormal(distribution_of(kind)) for kind in kinds),
        lambda x: (x[:, 0] / 345e6) ** 1.5 + x[:, 1],
    )


def test_a_power_law_is_straight_at_the_bounds_of_a_truncated_normal():
    """In probabilities the same runs gave errors of 2 % of the response there."""
    _, inputs, polynomials, response = _stress(YIELD, 0)
    chaos = fit(inputs, response(inputs), 0, polynomials)
    bounds = np.array([[270e6, 0.5], [420e6, 0.5], [270e6, 0.0], [420e6, 1.0]])
    np.testing.assert_allclose(chaos(bounds), response(bounds), rtol=1e-6)
    # The variances of the parts of a sum are known by quadrature.
    _, inputs, polynomials, response = _stress(YIELD, 1)
    chaos = fit(inputs, response(inputs), 0, polynomials)
    pull = influence(chaos, inputs, response(inputs), np.arange(len(inputs)), 0.0)
    found = indices(chaos, ["stress", "other"], pull, 0.0, 0.95)
    density = scipy.stats.truncnorm(-3, 3, 345e6, 25e6)
    first, second = (density.expect(lambda s, p=p: (s / 345e6) ** p) for p in (1.5, 3.0))
    variances = np.array([second - first**2, 1 / 12])
    np.testing.assert_allclose(found["first_order"], variances / variances.sum(), rtol=1e-5)
