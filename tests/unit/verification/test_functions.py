"""Indices in closed form, against integrals of the functions by tensor quadrature."""

import numpy as np
import pytest
from known_indices import INDICES

from impactlab.verification.functions import FUNCTIONS

A = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0])


def partial_variances(function, which, nodes):
    """Var E[f | x_which]/Var f by Gauss-Legendre on the named parameters; others by products."""
    low, high = np.array(list(function.ranges.values())).T
    at, weight = np.polynomial.legendre.leggauss(nodes)
    grids = np.meshgrid(*[at] * low.size, indexing="ij")
    x = low + 0.5 * (high - low) * (1 + np.stack([grid.ravel() for grid in grids], axis=1))
    f = function.value(x).reshape([nodes] * low.size)
    half = 0.5 * weight
    mean_over = [axis for axis in range(low.size) if axis not in which]
    for axis in sorted(mean_over, reverse=True):
        f = np.tensordot(f, half, axes=(axis, 0))
    mean = f
    square = f**2
    for _ in which:
        mean, square = np.tensordot(half, mean, axes=(0, 0)), np.tensordot(half, square, (0, 0))
    return float(square - mean**2)


def test_ishigami():
    ishigami = INDICES["ishigami"]
    part = {
        w: partial_variances(FUNCTIONS["ishigami"], w, 24)
        for w in ((0,), (1,), (2,), (0, 2), (0, 1, 2))
    }
    variance = part[0, 1, 2]
    expected = np.array([part[w,] for w in range(3)]) / variance
    np.testing.assert_allclose(ishigami.first_order, expected, atol=1e-9)
    pair = (part[0, 2] - part[0,] - part[2,]) / variance
    assert ishigami.second_order[0, 2] == pytest.approx(pair, abs=1e-9)
    total = expected + np.array([pair, 0.0, pair])
    np.testing.assert_allclose(ishigami.total_order, total, atol=1e-9)
    assert np.nansum(ishigami.first_order) + pair == pytest.approx(1.0)


def test_g_by_its_factors():
    g = INDICES["g"]
    x = (np.arange(20_000) + 0.5) / 20_000
    factors = (np.abs(4 * x - 2)[:, None] + A) / (1 + A)
    parts = factors.var(axis=0)
    variance = np.prod(1 + parts) - 1
    np.testing.assert_allclose(g.first_order, parts / variance, rtol=1e-6)
    others = [np.prod(1 + np.delete(parts, at)) for at in range(A.size)]
    np.testing.assert_allclose(g.total_order, parts * others / variance, rtol=1e-6)
    assert g.second_order[0, 1] == pytest.approx(parts[0] * parts[1] / variance, rel=1e-6)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_are_those_whose_indices_are_known(name):
    function, known = FUNCTIONS[name], INDICES[name]
    np.testing.assert_allclose(function.total_order, known.total_order, rtol=1e-12)
    low, high = np.array(list(function.ranges.values())).T
    unit = np.random.default_rng(1).random((9, known.size))
    values = function.value(low + (high - low) * unit)
    np.testing.assert_allclose(values, known.of_unit(unit), rtol=1e-12)
