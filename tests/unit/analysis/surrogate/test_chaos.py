"""Polynomial chaos: its terms, their values, and its Sobol indices."""

from itertools import product

import numpy as np
import pytest
from scipy.special import eval_legendre

from impactlab.analysis.surrogate.chaos import (
    Chaos,
    basis,
    candidates,
    fit,
    hyperbolic,
    indices,
    influence,
)

from .conftest import UNIT


def _norm(row):
    return sum(part**0.7 for part in row) ** (1 / 0.7)


@pytest.mark.parametrize(("parameters", "degree"), [(1, 5), (2, 7), (3, 6), (4, 5)])
def test_a_set_holds_just_the_terms_of_small_norm(parameters, degree):
    every = product(range(degree + 1), repeat=parameters)
    expected = {row for row in every if _norm(row) <= degree + 1e-9}
    found = [tuple(row) for row in hyperbolic(parameters, degree).tolist()]
    assert len(found) == len(expected)
    assert set(found) == expected
    assert not any(found[0])  # the constant


def test_candidates_are_the_largest_set_that_is_allowed():
    sizes = [len(hyperbolic(3, degree)) for degree in range(6)]
    assert len(candidates(3, sizes[4], highest=20)) == sizes[4]
    assert len(candidates(3, sizes[4] - 1, highest=20)) == sizes[3]
    assert len(candidates(3, 10_000, highest=2)) == sizes[2]


def test_terms_are_products_of_scipys_polynomials():
    unit = np.random.default_rng(0).random((50, 3))
    degrees = np.array([[0, 0, 0], [4, 0, 1], [0, 12, 0], [1, 2, 3]])
    for row, values in zip(degrees, basis(unit, degrees, [UNIT] * unit.shape[1]), strict=True):
        factors = [
            np.sqrt(2 * a + 1) * eval_legendre(a, 2 * u - 1)
            for a, u in zip(row, unit.T, strict=True)
        ]
        np.testing.assert_allclose(values, np.prod(factors, axis=0), rtol=1e-11, atol=1e-12)
    # the basis is orthonormal
    nodes, weights = np.polynomial.legendre.leggauss(8)  # exact up to degree 15
    unit = np.array(list(product((nodes + 1) / 2, repeat=2)))
    weight = np.array([a * b for a, b in product(weights / 2, repeat=2)])
    columns = basis(unit, hyperbolic(2, 7), [UNIT] * unit.shape[1])
    np.testing.assert_allclose(columns * weight @ columns.T, np.eye(len(columns)), atol=1e-12)
    # a chaos is the sum of its terms
    unit = np.array([[0.0, 0.5], [0.25, 1.0]])
    chaos = Chaos(np.array([[0, 0], [1, 0], [0, 2]]), np.array([2.0, 3.0, 5.0]), (UNIT, UNIT))
    linear, quadratic = 2 * unit[:, 0] - 1, 1.5 * (2 * unit[:, 1] - 1) ** 2 - 0.5
    expected = 2 + 3 * np.sqrt(3) * linear + 5 * np.sqrt(5) * quadratic
    np.testing.assert_allclose(chaos(unit), expected, rtol=1e-14)


Z95 = 1.959964


def _indices(unit, values, groups, rmse=0.0, missed=0.0):
    chaos = fit(unit, values, 0, [UNIT] * unit.shape[1])
    pull = influence(chaos, unit, values, np.arange(len(unit)), rmse)
    return indices(chaos, list(groups), pull, missed, 0.95)


def test_two_parameters_and_their_product():
    """x + y + x y on the unit square: 3/16 each, and 1/144 together."""
    unit = np.random.default_rng(0).random((200, 2))
    found = _indices(unit, unit[:, 0] + unit[:, 1] + unit.prod(axis=1), "xy")
    alone, whole = 3 / 16, 3 / 8 + 1 / 144
    np.testing.assert_allclose(found["first_order"], alone / whole, rtol=1e-10)
    np.testing.assert_allclose(found["total_order"], (alone + 1 / 144) / whole, rtol=1e-10)
    np.testing.assert_allclose(found["first_order_interval"], 0.0, atol=1e-10)
    # groups take their parameters together
    unit = np.random.default_rng(0).random((200, 3))
    found = _indices(unit, unit[:, 0] + unit[:, 1] + unit[:, 0] * unit[:, 2], "aba")
    # f = const + 3/2 u + v + w/2 + u w, u, v, w with a variance of 1/12 each
    both = (9 / 4 + 1 / 4) / 12 + 1 / 144
    np.testing.assert_allclose(found["first_order"], np.array([both, 1 / 12]) / (both + 1 / 12))
    np.testing.assert_allclose(found["total_order"], found["first_order"])
    # the share that is missed widens every interval
    unit = np.random.default_rng(0).random((200, 2))
    found = _indices(unit, unit[:, 0], "xy", missed=0.07)
    for half_width in (found["first_order_interval"], found["total_order_interval"]):
        np.testing.assert_allclose(half_width, 0.07, atol=1e-9)
    # a constant has no indices
    unit = np.random.default_rng(0).random((50, 2))
    chaos = Chaos(np.zeros((1, 2), dtype=int), np.array([3.0]), (UNIT, UNIT))
    pull = influence(chaos, unit, unit[:, 0], np.arange(50), 0.0)
    found = indices(chaos, ["x", "y"], pull, 0.0, 0.95)
    assert np.isnan(found["first_order"]).all()
    assert np.isnan(found["total_order_interval"]).all()


@pytest.mark.parametrize("copies", [1, 4])
def test_intervals_tell_the_scatter_of_repeated_fits(copies):
    """Noise that whole blocks share: copies of a run bring no knowledge."""
    random, found = np.random.default_rng(1), []
    for _ in range(60):
        unit = random.random((300, 2))
        noise = 0.3 * random.standard_normal(300)
        values = np.repeat(unit[:, 0] + 0.5 * unit[:, 1] + noise, copies)
        unit, block = np.repeat(unit, copies, axis=0), np.repeat(np.arange(300), copies)
        degrees = np.array([[0, 0], [1, 0], [0, 1]])
        chaos = Chaos(
            degrees,
            np.linalg.lstsq(basis(unit, degrees, [UNIT] * unit.shape[1]).T, values)[0],
            (UNIT, UNIT),
        )
        pull = influence(chaos, unit, values, block, 0.3)
        one = indices(chaos, ["x", "y"], pull, 0.0, 0.95)
        found.append([one["first_order"][0], one["first_order_interval"][0] / Z95])
    scatter, stated = np.std([row[0] for row in found]), np.mean([row[1] for row in found])
    assert 0.75 < stated / scatter < 1.33


def test_the_error_on_runs_held_out_is_what_scatters():
    """Not the residual, which a fit of many terms makes small."""
    unit = np.random.default_rng(0).random((200, 2))
    values = np.abs(unit[:, 0] - 0.3) + unit[:, 1]
    one, other = (_indices(unit, values, "xy", rmse) for rmse in (0.01, 0.03))
    np.testing.assert_allclose(other["first_order_interval"], 3 * one["first_order_interval"])
    assert (one["first_order_interval"] > 0).all()
