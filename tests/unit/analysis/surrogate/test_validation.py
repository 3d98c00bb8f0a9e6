"""Errors that grow outwards, and the interval of Q²: measured on functions that are known."""

import numpy as np
import pytest
import scipy.stats

from impactlab.analysis.surrogate.chaos import fit, orthonormal
from impactlab.analysis.surrogate.from_runs import error_model, half_width, leverage, predictivity
from impactlab.methods.distributions import distribution_of

NORMAL = {
    "distribution": "truncated_normal",
    "mean": 0.0,
    "standard_deviation": 1 / 3,
    "low": -1.0,
    "high": 1.0,
}
KINDS = [NORMAL, NORMAL, {"distribution": "uniform", "low": -1.0, "high": 1.0}]


def response(x):
    return np.exp(x[:, 0]) * (1 + 0.3 * x[:, 1]) + np.arctan(2 * x[:, 2])


def test_stated_errors_hold_at_one_bound_and_in_corners():
    rng, inside = np.random.default_rng(0), {"bound": [], "corner": []}
    polynomials = tuple(orthonormal(distribution_of(kind)) for kind in KINDS)
    for _ in range(6):
        unit = scipy.stats.qmc.LatinHypercube(3, rng=rng).random(80)
        inputs = np.column_stack(
            [distribution_of(k).quantile(u) for k, u in zip(KINDS, unit.T, strict=True)]
        )
        values, part, errors = response(inputs), rng.permutation(80) % 5, np.empty(80)
        for k in range(5):
            left = part == k
            errors[left] = fit(inputs[~left], values[~left], 0, polynomials)(inputs[left])
        errors -= values
        chaos = fit(inputs, values, 0, polynomials)
        model = error_model(leverage(chaos, inputs), errors)
        bounds = inputs[:30].copy()
        bounds[np.arange(30), np.arange(30) % 3] = rng.choice([-1.0, 1.0], 30)
        corners = rng.choice([-1.0, 1.0], (8, 3))
        for name, points in (("bound", bounds), ("corner", corners)):
            outward = leverage(chaos, points)
            stated = half_width(outward, model["error"], model["error_growth"])
            inside[name] += (np.abs(chaos(points) - response(points)) <= stated).tolist()
        assert (leverage(chaos, corners) > model["reach"]).all(), "a corner is not extrapolated"
    assert {name: np.mean(hits) > 0.9 for name, hits in inside.items()} == dict.fromkeys(
        inside, True
    )


def test_stated_errors_hold_in_the_middle():
    """The error of the response is the same wherever the terms of the chaos are small."""
    rng, inside = np.random.default_rng(0), []
    for _ in range(200):
        leverages = np.exp(rng.normal(-0.5, 1.0, 400))
        model = error_model(leverages, rng.normal(size=400) * np.maximum(leverages, 1.0))
        inside.append(
            np.abs(rng.normal()) <= half_width(0.1, model["error"], model["error_growth"])
        )
    assert np.mean(inside) > 0.9
    # few blocks that show no error prove little
    values = np.random.default_rng(0).normal(size=20)
    assert predictivity(np.zeros(20), values, np.arange(20), 20) == (1.0, 0.95)
    assert predictivity(np.zeros(20), np.ones(20), np.arange(20), 20) == (-np.inf, -np.inf)


@pytest.mark.parametrize("blocks", [20, 100])
def test_the_lower_end_of_the_predictivity_covers(blocks):
    """Blocks of four near-copies whose errors take a share of 0.1 of the variance."""
    rng, below = np.random.default_rng(blocks), []
    block = np.repeat(np.arange(blocks), 4)
    for _ in range(300):
        values, errors = rng.normal(size=(2, blocks)).repeat(4, axis=1)
        q2, low = predictivity(errors * np.sqrt(0.1), values, block, len(np.unique(block)))
        assert low < q2
        below.append(low <= 0.9)
    assert np.mean(below) > 0.95
