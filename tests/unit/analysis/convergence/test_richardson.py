"""Published tables, manufactured sequences of each class, and exact recovery."""

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from impactlab.analysis.convergence.extrapolation import (
    SAFETY_CREDIBLE,
    SAFETY_DOUBTFUL,
    Behaviour,
    estimate,
    grid_convergence_index,
    observed_order,
    safety,
)

CELIK = [18000, 8000, 4500]
CELIK_COARSER = [18000, 4500, 980]


def _spacings(cells):
    """Return the spacings from numbers of cells in 2-D."""
    return [count**-0.5 for count in cells]


def test_celik_table():
    found = estimate([6.063, 5.972, 5.863], _spacings(CELIK))
    assert found.behaviour is Behaviour.MONOTONE
    assert found.order == pytest.approx(1.534, abs=5e-4)
    assert found.extrapolated == pytest.approx(6.1685, abs=5e-5)
    assert found.gci(SAFETY_CREDIBLE) == pytest.approx(0.02175, abs=5e-6)
    # celik table of low order
    found = estimate([10.7880, 10.7250, 10.6050], _spacings(CELIK_COARSER))
    assert found.order == pytest.approx(0.75, abs=5e-3)
    assert found.extrapolated == pytest.approx(10.8801, abs=5e-4)
    assert found.gci(SAFETY_CREDIBLE) == pytest.approx(0.011, abs=5e-4)
    # celik table with oscillation
    found = estimate([6.0042, 5.9624, 6.0909], _spacings(CELIK_COARSER))
    assert found.behaviour is Behaviour.OSCILLATORY
    assert found.order == pytest.approx(1.51, abs=5e-3)
    assert found.gci(SAFETY_CREDIBLE) == pytest.approx(0.005, abs=5e-4)
    assert math.isnan(found.extrapolated)
    # nasa table
    found = estimate([0.97050, 0.96854, 0.96178], [1.0, 2.0, 4.0])
    assert found.order == pytest.approx(1.78618, abs=2e-5)
    assert found.extrapolated == pytest.approx(0.97130, abs=5e-6)
    assert found.gci(SAFETY_CREDIBLE) == pytest.approx(0.001031, abs=5e-7)
    medium = grid_convergence_index(0.96854, 0.96178, 2.0, found.order)
    assert medium == pytest.approx(0.003562, abs=5e-7)


@pytest.mark.parametrize(
    ("values", "spacings"),
    [([6.063, 5.972, 5.863], _spacings(CELIK)), ([0.97050, 0.96854, 0.96178], [1.0, 2.0, 4.0])],
)
def test_asymptotic_ratio_of_the_tables(values, spacings):
    """Celik's equation for p makes it f1/f2 on any ratios."""
    found = estimate(values, spacings)
    assert found.asymptotic_ratio == pytest.approx(values[0] / values[1], rel=1e-9)


@pytest.mark.parametrize(
    ("values", "behaviour", "order"),
    [
        ([1.01, 1.04, 1.16], Behaviour.MONOTONE, 2.0),
        ([0.99, 0.96, 0.84], Behaviour.MONOTONE, 2.0),
        ([1.00, 1.02, 0.94], Behaviour.OSCILLATORY, 2.0),
        ([4.0, 2.0, 1.0], Behaviour.MONOTONE_DIVERGENT, -1.0),
        ([3.0, 2.0, 1.0], Behaviour.MONOTONE_DIVERGENT, 0.0),
        ([5.0, 1.0, 2.0], Behaviour.OSCILLATORY_DIVERGENT, -2.0),
        ([2.0, 1.0, 2.0], Behaviour.OSCILLATORY_DIVERGENT, 0.0),
        ([2.0, 1.0, 1.0], Behaviour.MONOTONE_DIVERGENT, math.nan),
        ([2.0, 2.0, 2.0], Behaviour.AT_ROUND_OFF, math.nan),
        ([0.0, 0.0, 0.0], Behaviour.AT_ROUND_OFF, math.nan),
        ([2.0, 2.0 + 1e-9, 2.0 + 5e-10], Behaviour.AT_ROUND_OFF, math.nan),
        ([2.0, 2.0, 2.1], Behaviour.STALLED, math.nan),
        ([1.0, math.nan, 1.2], Behaviour.UNDETERMINED, math.nan),
        ([1.0, 1.1, math.inf], Behaviour.UNDETERMINED, math.nan),
    ],
)
def test_every_class(values, behaviour, order):
    found = estimate(values, [1.0, 2.0, 4.0])
    assert found.behaviour is behaviour
    assert found.order == pytest.approx(order, abs=1e-9, nan_ok=True)
    monotone = behaviour is Behaviour.MONOTONE
    converging = monotone or behaviour is Behaviour.OSCILLATORY
    assert math.isfinite(found.extrapolated) == monotone
    assert math.isfinite(found.gci(SAFETY_DOUBTFUL)) == converging


@pytest.mark.parametrize(
    ("order", "credible", "asymptotic"),
    [
        (0.4, False, False),
        (0.6, True, False),
        (1.6, True, True),
        (2.4, True, True),
        (3.1, False, False),
    ],
)
def test_credible_and_asymptotic_orders(order, credible, asymptotic):
    spacings = [1.0, 2.0, 4.0]
    found = estimate([100.0 + h**order for h in spacings], spacings)
    assert (found.credible, found.asymptotic) == (credible, asymptotic)


def test_an_order_above_the_formal_one_does_not_narrow_the_gci():
    found = estimate([1 + h**3 for h in (0.1, 0.2, 0.4)], [0.1, 0.2, 0.4])
    assert found.order == pytest.approx(3.0)
    assert found.gci(1.25) == pytest.approx(1.25 * 0.007 / 1.001 / 3.0)
    assert safety([found]) == 3.0
    assert safety([estimate([1 + h**2 for h in (0.1, 0.2, 0.4)], [0.1, 0.2, 0.4])]) == 1.25
    # gci relative to zero is infinite
    assert grid_convergence_index(0.0, 1.0, 2.0, 2.0) == math.inf
    # too high an order shows in the asymptotic ratio
    found = estimate([1 + 1e-6 * h**2.9 for h in (1.0, 2.0, 4.0)], [1.0, 2.0, 4.0])
    assert found.asymptotic_ratio == pytest.approx(2**0.9, rel=1e-4)
    assert math.isnan(estimate([1.0, 1.2, 0.9], [1.0, 2.0, 4.0]).asymptotic_ratio)
    # logarithmic growth on unequal ratios is of order zero
    spacings = [1.0, 1.5, 6.0]
    found = estimate([-math.log(h) for h in spacings], spacings)
    assert found.order == pytest.approx(0.0, abs=1e-9)
    # refuses other than three grids
    with pytest.raises(ValueError, match="three grids, not 4"):
        estimate([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, 4.0])


ratios = st.floats(1.1, 5.0)
sizes = st.one_of(st.floats(0.1, 10.0), st.floats(-10.0, -0.1))


@given(st.floats(-10, 10), sizes, st.floats(0.3, 4.0), ratios, ratios)
@example(1.0, 1.0, 3.0, 1.1, 5.0)  # where Celik's iteration runs away
def test_recovers_order_and_limit(limit, size, order, r21, r32):
    spacings = [0.1, 0.1 * r21, 0.1 * r21 * r32]
    found = estimate([limit + size * h**order for h in spacings], spacings)
    smallest = abs(size) * 0.1**order * (r21**order - 1)
    noise = 1e-14 * (abs(limit) + abs(size) * spacings[2] ** order) / smallest
    assert found.order == pytest.approx(order, rel=1e-9 + 100 * noise)
    error = abs(size) * 0.1**order
    assert found.extrapolated == pytest.approx(limit, abs=error * (1e-8 + 1000 * noise))


@given(
    st.floats(1e-8, 1e8), st.sampled_from([1.0, -1.0]), st.floats(1.01, 100), st.floats(1.01, 100)
)
def test_order_solves_celiks_equation(size, sign, r21, r32):
    order = observed_order(sign * size, r21, r32)
    if abs(order) > 1e-6 and abs(order) * math.log(max(r21, r32)) < 500:
        q = math.log((r21**order - sign) / (r32**order - sign))
        assert order * math.log(r21) == pytest.approx(math.log(size) + q, abs=1e-6)


@pytest.mark.parametrize("spacings", [[1.0, 1.0, 2.0], [4.0, 2.0, 1.0], [0.0, 1.0, 2.0]])
def test_refuses_spacings_that_do_not_rise(spacings):
    with pytest.raises(ValueError, match="must rise"):
        estimate([1.0, 2.0, 3.0], spacings)
