"""Indices against closed forms; the scatter of coefficients against a Monte Carlo of whole fits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from impactlab.analysis.surrogate.chaos import Chaos, Errors, Fitted, Indices, basis, indices
from impactlab.analysis.surrogate.fitting import fit

Z95 = 1.959964


EXACT = Errors(q2=1.0, rmse=0.0)


def _indices(unit: Any, values: Any, groups: str, errors: Errors = EXACT) -> Indices:
    fitted = Fitted(unit, values, np.arange(len(unit)))
    return indices(fit(unit, values, 0), list(groups), fitted, errors, 0.95)


def test_two_parameters_and_their_product() -> None:
    """x + y + x y on the unit square: 3/16 each, and 1/144 together."""
    unit = np.random.default_rng(0).random((200, 2))
    found = _indices(unit, unit[:, 0] + unit[:, 1] + unit.prod(axis=1), "xy")
    alone, whole = 3 / 16, 3 / 8 + 1 / 144
    np.testing.assert_allclose(found.first_order, alone / whole, rtol=1e-10)
    np.testing.assert_allclose(found.total_order, (alone + 1 / 144) / whole, rtol=1e-10)
    np.testing.assert_allclose(found.first_order_interval, 0.0, atol=1e-10)


def test_groups_take_their_parameters_together() -> None:
    unit = np.random.default_rng(0).random((200, 3))
    found = _indices(unit, unit[:, 0] + unit[:, 1] + unit[:, 0] * unit[:, 2], "aba")
    # f = const + 3/2 u + v + w/2 + u w, u, v, w with a variance of 1/12 each
    both = (9 / 4 + 1 / 4) / 12 + 1 / 144
    np.testing.assert_allclose(found.first_order, np.array([both, 1 / 12]) / (both + 1 / 12))
    np.testing.assert_allclose(found.total_order, found.first_order)


def test_the_share_that_is_missed_widens_every_interval() -> None:
    unit = np.random.default_rng(0).random((200, 2))
    found = _indices(unit, unit[:, 0], "xy", Errors(q2=0.93, rmse=0.0))
    for half_width in (found.first_order_interval, found.total_order_interval):
        np.testing.assert_allclose(half_width, 0.07, atol=1e-9)


@pytest.mark.parametrize("copies", [1, 4])
def test_intervals_tell_the_scatter_of_repeated_fits(copies: int) -> None:
    """Of noise that whole blocks share: copies of a run bring no knowledge."""
    random, found = np.random.default_rng(1), []
    errors = Errors(q2=1.0, rmse=0.3)
    for _ in range(60):
        unit = random.random((300, 2))
        noise = 0.3 * random.standard_normal(300)
        values = np.repeat(unit[:, 0] + 0.5 * unit[:, 1] + noise, copies)
        unit, block = np.repeat(unit, copies, axis=0), np.repeat(np.arange(300), copies)
        degrees = np.array([[0, 0], [1, 0], [0, 1]])
        chaos = Chaos(degrees, np.linalg.lstsq(basis(unit, degrees).T, values)[0])
        one = indices(chaos, ["x", "y"], Fitted(unit, values, block), errors, 0.95)
        found.append([one.first_order[0], one.first_order_interval[0] / Z95])
    scatter, stated = np.std([row[0] for row in found]), np.mean([row[1] for row in found])
    assert 0.75 < stated / scatter < 1.33


def test_the_error_on_runs_held_out_is_what_scatters() -> None:
    """Not the residual, which a fit of many terms makes small."""
    unit = np.random.default_rng(0).random((200, 2))
    values = np.abs(unit[:, 0] - 0.3) + unit[:, 1]
    one, other = (_indices(unit, values, "xy", Errors(1.0, rmse)) for rmse in (0.01, 0.03))
    np.testing.assert_allclose(other.first_order_interval, 3 * one.first_order_interval)
    assert (one.first_order_interval > 0).all()


def test_a_constant_has_no_indices() -> None:
    unit = np.random.default_rng(0).random((50, 2))
    chaos = Chaos(np.zeros((1, 2), dtype=int), np.array([3.0]))
    found = indices(chaos, ["x", "y"], Fitted(unit, unit[:, 0], np.arange(50)), EXACT, 0.95)
    assert np.isnan(found.first_order).all()
    assert np.isnan(found.total_order_interval).all()
