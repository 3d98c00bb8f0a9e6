"""Values and probabilities against closed forms from the standard library."""

import math
from statistics import NormalDist

import numpy as np
import pytest

from impactlab.methods.distributions import distribution_of

GAUSS = NormalDist(345e6, 25e6)
CASES = {
    "uniform": ({"low": 2.0, "high": 5.0}, 2.6, 0.2),
    "log_uniform": ({"low": 2.0, "high": 32.0}, 8.0, 0.5),
    "normal": ({"mean": 345e6, "standard_deviation": 25e6}, 380e6, GAUSS.cdf(380e6)),
    "truncated_normal": (
        {"mean": 345e6, "standard_deviation": 25e6, "low": 320e6, "high": 420e6},
        345e6,
        (GAUSS.cdf(345e6) - GAUSS.cdf(320e6)) / (GAUSS.cdf(420e6) - GAUSS.cdf(320e6)),
    ),
    "lognormal": (
        {"median": 10.0, "geometric_standard_deviation": 1.3},
        14.0,
        NormalDist().cdf(math.log(1.4) / math.log(1.3)),
    ),
    "triangular": ({"low": 2.0, "mode": 3.0, "high": 8.0}, 3.0, 1 / 6),
}


@pytest.mark.parametrize("name", CASES)
def test_value_and_probability_are_those_of_the_closed_form(name):
    given, value, probability = CASES[name]
    attributes = {"units": "m", "distribution": name} | given
    assert distribution_of(attributes).cumulative(value) == pytest.approx(probability, rel=1e-12)
    assert distribution_of(attributes).quantile(probability) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize("name", CASES)
def test_one_undoes_the_other_and_draws_keep_to_the_bounds(name):
    given = {"distribution": name} | CASES[name][0]
    probability = np.array([[2.0**-31, 0.2, 0.5], [0.9, 0.999, 1 - 2.0**-31]])
    values = distribution_of(given).quantile(probability)
    assert values.shape == probability.shape
    np.testing.assert_allclose(
        distribution_of(given).cumulative(values), probability, rtol=1e-6, atol=1e-13
    )
    assert values.min() >= given.get("low", -np.inf)
    assert values.max() <= given.get("high", np.inf)


def test_bounds_are_kept_to_the_last_digit():
    given = {"distribution": "uniform", "low": 0.3, "high": 0.9}
    assert 0.3 + (0.9 - 0.3) != 0.9  # what the linear formula makes of it
    assert distribution_of(given).quantile([0.0, 1.0]).tolist() == [0.3, 0.9]
    # arguments leave other attributes out
    given = {"distribution": "uniform", "low": np.float64(1.0), "high": 2, "units": "m"}
    assert distribution_of(given).arguments() == {
        "distribution": "uniform",
        "low": 1.0,
        "high": 2.0,
    }


def test_what_is_no_distribution_is_named():
    with pytest.raises(ValueError, match="unknown distribution 'cauchy': choose from uniform"):
        distribution_of({"distribution": "cauchy"})
    with pytest.raises(ValueError, match="'triangular' needs mode, high"):
        distribution_of({"distribution": "triangular", "low": 0.0})
