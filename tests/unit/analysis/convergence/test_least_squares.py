"""The fit over four or more grids: exact data, numpy's own fits, and data with a known scatter."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.optimize import curve_fit

from impactlab.analysis.convergence.extrapolation import Expansion, fit, uncertainty

H = 2.0 ** np.arange(5)


@pytest.mark.parametrize("order", [0.6, 1.0, 1.5, 1.9])
def test_exact_data_give_their_order_and_limit(order):
    values = 3.0 - 0.1 * H**order
    found = fit(values, 1e-3 * H)
    assert found.expansion is Expansion.FREE
    assert found.order == found.free_order == pytest.approx(order, rel=1e-5)
    assert found.extrapolated == pytest.approx(3.0, abs=1e-5)
    # the grid convergence index of a credible order
    np.testing.assert_allclose(uncertainty(found, values), 1.25 * 0.1 * H**order, rtol=1e-3)


def test_too_high_an_order_is_replaced_by_the_second():
    values = 1.0 + 1e-3 * H**3
    found = fit(values, H)
    assert (found.expansion, found.order) == (Expansion.SECOND, 2.0)
    assert found.free_order == pytest.approx(3.0, rel=1e-4)
    assert found.deviation > 0
    assert uncertainty(found, values)[0] > 3 * found.errors[0]
    # First and second order that nearly cancel: the minimum is at h = 3.
    values = 1.0 - 6e-3 * H + 1e-3 * H**2
    found = fit(values, H)
    assert found.expansion in (Expansion.BOTH, Expansion.SECOND)
    slow = fit(1.0 + np.log(H) + 0.01 * H, H)
    assert slow.free_order < 0.5
    assert (slow.expansion, slow.order) == (Expansion.BOTH, 1.0)
    # the order of the grids does not matter
    values = 1.0 + 1e-3 * H**1.5 + 1e-4 * np.array([1, -2, 1, 3, -1])
    one, other = fit(values, H), fit(values[::-1], H[::-1])
    assert other.extrapolated == pytest.approx(one.extrapolated, rel=1e-7)
    # refuses fewer than four grids
    with pytest.raises(ValueError, match="four grids, not 3"):
        fit([1.0, 2.0, 3.0], [1.0, 2.0, 4.0])


def test_the_expansion_of_both_is_a_weighted_parabola():
    values = 1.0 + np.log(H)
    found = fit(values, H)
    weights = {name: w / w.sum() for name, w in (("even", np.ones(5)), ("fine", 1 / H))}
    residuals = {}
    for name, weight in weights.items():
        parabola = Polynomial.fit(H, values, 2, w=np.sqrt(weight)).convert()
        residuals[name] = (5 * np.sum(weight * (values - parabola(H)) ** 2) / (5 - 3)) ** 0.5
    assert found.deviation == pytest.approx(min(residuals.values()), rel=1e-9)


def test_a_fitted_order_costs_a_degree_of_freedom():
    """Against scipy's Levenberg-Marquardt on the same curve, with and without weights 1/h."""
    values = 3.0 - 0.1 * H**1.5 + 1e-2 * np.array([1, -2, 1, 2, -1])
    found = fit(values, H)
    assert found.expansion is Expansion.FREE
    deviations = []
    for weight in (np.ones(5), 1 / H):
        (f0, a, p), _ = curve_fit(
            lambda h, f0, a, p: f0 + a * h**p,
            H,
            values,
            (3.0, -0.1, 1.5),
            sigma=weight**-0.5,
            xtol=1e-12,
        )
        misfit = np.sum(weight / weight.sum() * (values - f0 - a * H**p) ** 2)
        deviations.append(((5 * misfit / (5 - 3)) ** 0.5, f0, p))
    assert (found.deviation, found.extrapolated, found.order) == pytest.approx(
        min(deviations), rel=1e-5
    )


def test_a_good_fit_of_an_assumed_order_has_the_factor_3():
    values = 1.0 + 1e-3 * H**2.4
    found = fit(values, H)
    assert found.expansion is Expansion.SECOND
    assert found.deviation < np.ptp(values) / 4
    expected = 3 * found.errors + found.deviation + abs(found.residuals)
    np.testing.assert_allclose(uncertainty(found, values), expected)
    # a poor fit is widened by its deviation
    values = np.array([1.0, 1.2, 0.9, 1.1, 1.0])
    found = fit(values, H)
    data_range = 0.3 / 4
    assert found.deviation > data_range
    widened = 3 * found.deviation / data_range
    expected = widened * (found.errors + found.deviation + abs(found.residuals))
    np.testing.assert_allclose(uncertainty(found, values), expected)


@pytest.mark.parametrize("scatter", [0.1, 0.3, 1.0])
@pytest.mark.parametrize("grids", [5, 7])
def test_the_interval_holds_the_limit_in_19_of_20_draws(scatter, grids):
    """Second order, as the solver's, under noise of up to the finest grid's error."""
    random, h = np.random.default_rng(11), 2.0 ** np.arange(grids)
    held, wide = 0, []
    for _ in range(200):
        values = 1.0 + 1e-3 * (h**2 + scatter * random.normal(size=grids))
        amount = uncertainty(fit(values, h), values)
        held += abs(values[0] - 1.0) <= amount[0]
        wide.append(amount[0] / 1e-3)
    assert held >= 0.93 * 200
    assert np.median(wide) < 4.0  # and is no empty promise
