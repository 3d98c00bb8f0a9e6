"""Calibration: posterior, evidence and refusals against closed forms, and coverage."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
import scipy.stats
import xarray as xr

from impactlab.analysis.importance import posterior
from impactlab.analysis.likelihood import Likelihood
from impactlab.analysis.measurements import Measurement
from impactlab.analysis.posterior import FEWEST, calibrated
from impactlab.analysis.surrogate.stored import Surrogate

RANGE = {"a": (0.0, 2.0), "b": (10.0, 30.0), "velocity": (1.0, 5.0)}


def linear(responses, rmse=0.0, **held):
    """A surrogate of linear responses in a, b and velocity: constant, then a slope of each."""
    # Legendre polynomials of mean 0 and variance 1 over the range: sqrt(3) (2 u - 1)
    middle, half = (
        {name: f(*ends) for name, ends in RANGE.items()}
        for f in (lambda low, high: (low + high) / 2, lambda low, high: (high - low) / 2)
    )
    rows = []
    for constant, *slopes in responses.values():
        pairs = list(zip(slopes, RANGE, strict=True))
        mean = constant + sum(slope * middle[name] for slope, name in pairs)
        rows.append([mean, *(slope * half[name] / np.sqrt(3) for slope, name in pairs)])
    size = len(responses)
    given = [{"distribution": "uniform", "low": low, "high": high} for low, high in RANGE.values()]
    dataset = xr.Dataset(
        {
            "coefficient": (("response", "term"), np.array(rows)),
            "degree": (("term", "parameter"), np.vstack([np.zeros(3, int), np.eye(3, dtype=int)])),
            "verdict": ("response", np.zeros(size, np.int8)),
            "rmse": ("response", np.full(size, rmse)),
            "error": ("response", np.full(size, 2 * rmse)),
            "error_growth": ("response", np.zeros(size)),
            "reach": ("response", np.full(size, np.inf)),
            "distribution": ("parameter", [json.dumps(each) for each in given]),
            "parameter_units": ("parameter", ["1"] * 3),
            "lowest": ("parameter", [low for low, _ in RANGE.values()]),
            "highest": ("parameter", [high for _, high in RANGE.values()]),
        },
        {"response": list(responses), "parameter": list(RANGE), **held},
        {"study": "made"},
    )
    return Surrogate(dataset)


BOTH = {"force": (1.0, 3.0, 0.2, 2.0), "time": (0.0, 4.0, -0.1, 1.0)}
A = np.array([[3.0, 0.2], [4.0, -0.1]])


def measured(quantity, value, uncertainty, velocity=2.0, **conditions):
    return Measurement(quantity, value, uncertainty, "1", {"velocity": velocity} | conditions, "x")


def pair(theta, uncertainty=(0.05, 0.04), velocity=2.0):
    truth = np.array([1.0, 0.0]) + A @ theta + np.array([2.0, 1.0]) * velocity
    return [
        measured(name, value, u, velocity)
        for name, value, u in zip(BOTH, truth, uncertainty, strict=True)
    ]


def test_of_a_linear_model_it_is_the_normal_posterior_and_evidence():
    theta, uncertainty = np.array([0.9, 21.0]), np.array([0.05, 0.04])
    other = {"force": (1.0, 6.0, 0.2, 2.0), "time": (0.0, 4.0, -0.1, 1.0)}
    data = pair(theta)
    found = calibrated({"first": linear(BOTH), "second": linear(other)}, data)
    first = calibrated({"": linear(BOTH)}, data)
    covariance = np.linalg.inv(A.T @ np.diag(uncertainty**-2) @ A)
    deviation = np.sqrt(np.diag(covariance))
    off = (first["posterior_mean"].values - theta) / deviation
    assert off == pytest.approx([0.0, 0.0], abs=0.03)
    assert first["posterior_deviation"].values == pytest.approx(deviation, rel=0.03)
    assert first["prior_deviation"].values == pytest.approx([2 / 12**0.5, 20 / 12**0.5], rel=1e-3)
    ends = first["posterior_high"] - first["posterior_low"]
    assert ends.values == pytest.approx(2 * 1.96 * deviation, rel=0.04)
    # with as many measurements as parameters the evidence is 1 / (range of the prior |det A|)
    determinants = np.abs([np.linalg.det(A), np.linalg.det([[6.0, 0.2], [4.0, -0.1]])])
    evidence = -np.log(40.0 * determinants)
    assert found["log_evidence"].values == pytest.approx(evidence, abs=0.03)
    weights = (1 / determinants) / (1 / determinants).sum()
    assert found["model_weight"].values == pytest.approx(weights, abs=0.01)
    before = {"first": 0.1, "second": 0.9}
    again = calibrated({"first": linear(BOTH), "second": linear(other)}, data, before=before)
    weights = np.array([0.1, 0.9]) / determinants
    assert again["model_weight"].values == pytest.approx(weights / weights.sum(), abs=0.01)
    share = (found["draw_model"] == "first").mean().item()
    assert share == pytest.approx(found["model_weight"][0].item(), abs=0.005), (
        "draws are of the models by weight"
    )


@pytest.mark.long
def test_intervals_cover_parameters_drawn_from_the_prior():
    surrogate, rng = linear(BOTH, rmse=0.1), np.random.default_rng(3)
    ranks = []
    for _ in range(80):
        theta = np.array([rng.uniform(*RANGE[name]) for name in "ab"])
        noise = rng.normal(0, [np.hypot(0.2, 0.1), np.hypot(0.15, 0.1)])
        data = [
            measured(one.quantity, one.value + each, u)
            for one, each, u in zip(pair(theta), noise, (0.2, 0.15), strict=True)
        ]
        model = Likelihood(surrogate, data, {}, 0.0)
        found = posterior(model.log, 2, 1, last=2000)
        ranks.append((model.values(found.points) < theta).T @ found.weights)
    inside = (np.abs(np.array(ranks) - 0.5) < 0.4).mean(axis=0)
    spread = np.sqrt(0.8 * 0.2 / 80)
    assert inside == pytest.approx([0.8, 0.8], abs=3 * spread)
    for column in np.array(ranks).T:  # and the ranks are uniform
        assert scipy.stats.kstest(column, "uniform").pvalue > 0.01


def test_repeated_measurements_do_not_average_the_surrogate_out():
    data = pair([1.0, 20.0], (0.2, 0.2)) * 50
    found = calibrated({"": linear(BOTH, rmse=0.15)}, data)
    each = np.sqrt(0.2**2 / 50 + 0.15**2)
    covariance = np.linalg.inv(A.T @ A) * each**2
    wanted = np.sqrt(np.diag(covariance))
    assert found["posterior_deviation"].values == pytest.approx(wanted, rel=0.04)
    # neighbouring conditions do not average the surrogate out
    velocities = np.linspace(2.0, 2.1, 10)
    data = [one for v in velocities for one in pair([1.0, 20.0], (0.2, 0.2), velocity=v)]
    found = calibrated({"": linear(BOTH, rmse=0.15)}, data)
    each = np.sqrt(0.2**2 / 10 + 0.15**2)
    wanted = np.sqrt(np.diag(np.linalg.inv(A.T @ A))) * each
    assert found["posterior_deviation"].values == pytest.approx(wanted, rel=0.05)
    # what the data cannot tell keeps the spread of the prior
    blind = {"force": (1.0, 3.0, 0.0, 2.0)}
    found = calibrated({"": linear(blind)}, [measured("force", 7.0, 0.1)])
    assert found["spread_ratio"].sel(parameter="b").item() == pytest.approx(1.0, abs=0.02)
    assert found["spread_ratio"].sel(parameter="a").item() < 0.1


def test_a_systematic_uncertainty_stays_however_many_measurements_share_it():
    def shared(one, source):
        return replace(one, systematic_uncertainty=0.15, source=source)

    repeated = [one for _ in range(50) for one in pair([1.0, 20.0], (0.25, 0.25))]
    inverse = np.sqrt(np.diag(np.linalg.inv(A.T @ A)))
    for sources in (1, 2):
        data = [shared(one, f"rig {at % 4 // 2 % sources}") for at, one in enumerate(repeated)]
        found = calibrated({"": linear(BOTH)}, data)
        # of 0.25, 0.2 is random and 0.15 common to a source
        wanted = inverse * np.sqrt(0.2**2 / 50 + 0.15**2 / sources)
        assert found["posterior_deviation"].values == pytest.approx(wanted, rel=0.04)


@pytest.mark.parametrize(
    ("surrogate", "data", "words"),
    [
        (linear(BOTH), pair([1.999, 20.0]), "leans on the upper end of the range (2 1)"),
        (linear(BOTH), pair([1.0, 45.0]), "b: "),
        (linear(BOTH, rmse=0.06), pair([1.0, 20.0]), "surrogate's error (0.06 1) exceeds"),
        (linear(BOTH), pair([1.0, 20.0], velocity=7.0), "7 is outside 1 to 5"),
        (linear(BOTH), [measured("dent", 1.0, 0.1)], "is no response of the study"),
        (
            linear(BOTH, beam_depth=0.02),
            [measured("force", 7.0, 0.1, beam_depth=0.03)],
            "was measured at beam_depth = 0.03, but it is 0.02",
        ),
        (
            linear(BOTH),
            [measured("force", 7.0, 0.1), Measurement("time", 2.0, 0.1, "1", {}, "x")],
            "velocity: is stated for force but not for all",
        ),
        (linear(BOTH), [measured("force", 7.0, 0.1, a=1.0, b=12.0)], "0 parameters are left"),
    ],
    ids=lambda each: each if isinstance(each, str) else None,
)
def test_what_gives_no_posterior_is_refused_with_the_reason(surrogate, data, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        calibrated({"": surrogate}, data)


def test_a_posterior_that_the_sample_misses_is_refused():
    with pytest.raises(ValueError, match=f"less than {FEWEST:g}"):
        calibrated({"": linear(BOTH)}, pair([1.0, 20.0], (1e-9, 1e-9)))


@pytest.mark.parametrize(("apart", "contradict"), [(2.0, True), (0.1, False)])
def test_contradicting_data_are_told(apart, contradict):
    force, time = pair([1.0, 20.0], (0.1, 0.1))
    again = measured("force", force.value + apart, 0.1)
    p_value = calibrated({"": linear(BOTH)}, [force, time, again])["predictive_p"]
    assert p_value < 1e-6 if contradict else p_value > 0.1
