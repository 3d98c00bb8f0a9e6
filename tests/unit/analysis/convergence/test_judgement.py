"""The uncertainty of each grid holds the limit, and is infinite where nothing can be said."""

import numpy as np
import pytest

from impactlab.analysis.convergence.judgement import AxisVerdict, How, judge, numerical_uncertainty

H = 2.0 ** np.arange(5)


@pytest.mark.parametrize("order", [0.6, 1.0, 1.5, 2.0, 2.8])
@pytest.mark.parametrize("grids", [2, 3, 4, 5])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_every_grid_of_a_converging_sequence_holds_the_limit(order, grids, sign):
    h = H[:grids]
    values = 5.0 + sign * 1e-3 * h**order
    amounts, _ = numerical_uncertainty(values, h)
    errors = abs(values - 5.0)
    if grids > 2 or order >= 1:  # of two grids the first order is assumed, with a factor of 3
        assert (amounts >= errors).all()
    if order <= 2 and grids > 2:
        # an order of 1.5 may be that of orders 1 and 2 together; three grids confirm order 2 alone
        most = 1.7 if order == 1.5 else 1.5
        if grids == 3 and order < 2:
            most = 3.0 * (4.0**order - 1.0) / 3.0 + 1e-9 if order >= 1 else 1.6
        assert (amounts <= most * errors).all()


@pytest.mark.parametrize(
    ("values", "how"),
    [
        ([2.0, 2.0, 2.0 + 1e-10], How.ROUND_OFF),
        ([0.0, 0.0, 0.0, 0.0], How.ROUND_OFF),
        ([1.01, 1.04, 1.16], How.GCI),
        ([1.01, 1.04, 1.16, 1.64], How.GCI_AND_FIT),
        ([1.00, 1.02, 0.94, 1.01], How.FIT),
        ([1.00, 1.02, 0.94], How.RANGE),
        ([1.00, 1.02], How.TWO_GRIDS),
        ([1.0, 2.0**0.3, 4.0**0.3], How.SLOW_DRIFT),
        ([4.0, 2.0, 1.0], How.NOTHING),  # a strain that doubles
        ([5.0, 4.0, 3.0, 2.0, 1.0], How.NOTHING),
        ([1.0], How.NOTHING),
        ([1.0, np.nan, np.nan], How.NOTHING),
    ],
)
def test_what_it_rests_on(values, how):
    amounts, found = numerical_uncertainty(values, H[: len(values)])
    assert found is how
    assert np.isinf(amounts).all() == (how is How.NOTHING)


def test_two_and_three_grids_by_hand():
    np.testing.assert_allclose(numerical_uncertainty([1.0, 1.1], [1.0, 3.0])[0], [0.15, 0.25])
    three, _ = numerical_uncertainty([1.00, 1.02, 0.94], [1.0, 2.0, 4.0])
    np.testing.assert_allclose(three, [0.24, 0.26, 0.30])
    # GCI of the finest 0.1031 %; order 1.79 on three grids, which may be that of noise.
    values = [0.97050, 0.96854, 0.96178]
    found = judge(np.array(values), H[:3])
    assert found.gci == pytest.approx(0.001031, rel=1e-3)
    amounts, _ = numerical_uncertainty(values, H[:3])
    assert amounts[0] == pytest.approx(3 * (0.97050 - 0.96178) / 3)
    assert amounts[1] == pytest.approx(amounts[0] + 0.00196)
    # A count that differs on the coarsest grid alone: its verdict is sound, so is its number.
    found = judge(np.array([4.0, 4.0, 4.0, 3.0, 3.0]), H)
    assert found.verdict is AxisVerdict.AT_ROUND_OFF
    assert found.uncertainty <= 1e-9
    # a slow drift is bounded by its own order
    values = 1.0 - 0.1 * H**0.3
    amounts, how = numerical_uncertainty(values, H)
    assert amounts[0] == pytest.approx(3 * 0.1)
    assert not how.sound


def test_a_missing_grid_is_left_out():
    values = 5.0 + 1e-3 * H**2
    values[2] = np.nan
    amounts, _ = numerical_uncertainty(values, H)
    assert np.isinf(amounts).tolist() == [False, False, True, False, False]
    assert amounts[0] >= 1e-3


def test_scatter_that_passes_for_an_order_is_covered():
    """Noise of a fifth of the finest error: the index alone holds 4 limits of 5."""
    random, held = np.random.default_rng(5), 0
    for _ in range(200):
        values = 1.0 + 1e-3 * (H**2 + 0.2 * random.normal(size=5))
        amounts, _ = numerical_uncertainty(values, H)
        held += bool((abs(values - 1.0) <= amounts).all())
    assert held >= 0.95 * 200


FAMILIES = {
    "orders 1 and 2 of one sign": lambda h, u, noise: u * h + (1 - u) * h**2,
    "turning": lambda h, u, noise: h - h**2 / (2 * h[-1] ** u),
    "order 1": lambda h, u, noise: h,
    "order 3": lambda h, u, noise: h**3,
    "order 2 under noise": lambda h, u, noise: h**2 + u * noise,
    "order 1 under noise": lambda h, u, noise: h + u * noise,
    "noise": lambda h, u, noise: noise,
}


@pytest.mark.long
@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize(
    ("ratio", "grids"), [(1.1, 4), (1.2, 3), (1.2, 6), (2**0.5, 3), (2**0.5, 5), (2.0, 3), (2.0, 4)]
)
def test_what_is_sound_holds_the_limit(family, ratio, grids):
    """The errors are 0.01 to 3 %; under noise 92 % or more hold, less two standard errors."""
    random, h, held = np.random.default_rng(3), ratio ** np.arange(grids), []
    for _ in range(200 if "noise" in family else 40):
        errors = FAMILIES[family](h, random.uniform(), random.normal(size=grids))
        errors = errors * 10 ** random.uniform(-4, -1.5) / abs(errors[:2]).mean()
        found = judge(1 + errors, h)
        if found.verdict.sound:
            held.append(found.uncertainty * (1 + 1e-9) >= abs(errors[0] / (1 + errors[0])))
    assert sum(held) >= (0.88 if "noise" in family else 1.0) * len(held)
    if ratio == 2 and family == "order 2 under noise":
        assert len(held) > 100


@pytest.mark.parametrize(
    ("ratio", "grids", "verdict"),
    [
        (1.2, 3, AxisVerdict.TOO_NARROW),
        (1.1, 6, AxisVerdict.TOO_NARROW),
        (1.2, 5, AxisVerdict.NOT_YET_CONVERGED),
        (2.0, 3, AxisVerdict.CONVERGED_SECOND_ORDER),
    ],
)
def test_grids_close_to_each_other_show_no_order(ratio, grids, verdict):
    """A second order of 0.7 % at the finest; and an error that turns on the same grids."""
    h = ratio ** np.arange(grids)
    size = 0.02 if verdict is AxisVerdict.NOT_YET_CONVERGED else 0.007
    assert judge(1 + size * h**2, h).verdict is verdict
    turning = judge(1 + 0.045 * (h - h**2 / (1 + h[-1])), h)
    assert not turning.verdict.sound
    assert turning.uncertainty >= 0.045 * h[-1] / (1 + h[-1])


@pytest.mark.parametrize("spacings", [[2.0, 1.0, 4.0], [0.0, 1.0, 2.0], [1.0, 1.0, 2.0]])
def test_refuses_spacings_that_do_not_rise(spacings):
    with pytest.raises(ValueError, match="must rise"):
        numerical_uncertainty([1.0, 2.0, 3.0], spacings)
