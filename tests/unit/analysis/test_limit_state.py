"""Probabilities from runs that a Gaussian process places, against exact ones."""

import numpy as np
import pytest
from scipy.stats import chi2, norm
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF

from impactlab.analysis import limit_state
from impactlab.analysis.limit_state import Process, _batch, learned_estimate
from impactlab.analysis.rare_event import RareEventVerdict

SETTINGS = {"most": 2000, "target": 0.1, "confidence": 0.95}
CASES = {
    "plane": (lambda u: u.sum(axis=1) / 2, 4, norm.isf(1e-3), 1e-3),
    "likely plane": (lambda u: u.sum(axis=1) / np.sqrt(2), 2, norm.isf(0.3), 0.3),
    "ring": (lambda u: (u**2).sum(axis=1), 2, chi2.isf(1e-2, 2), 1e-2),
    "two regions": (
        lambda u: np.maximum(u[:, 0] / 3.2, -u[:, 0] / 3.4),
        4,
        1.0,
        norm.sf(3.2) + norm.sf(3.4),
    ),
}


@pytest.mark.long
@pytest.mark.parametrize("case", CASES)
def test_a_smooth_response_takes_a_tenth_of_the_runs(case):
    response, parameters, limit, exact = CASES[case]
    results = [learned_estimate(response, parameters, limit, seed=n, **SETTINGS) for n in range(3)]
    assert all(result.verdict is RareEventVerdict.USABLE for result in results)
    assert all(result.low < exact < result.high for result in results)
    assert max(result.coefficient_of_variation for result in results) <= 0.125
    assert max(result.runs for result in results) < 400


@pytest.mark.long
def test_a_process_that_is_wrong_costs_runs_but_adds_no_bias(monkeypatch):
    """Many small waves look like noise to the process, and move the limit."""
    monkeypatch.setattr(limit_state, "_LEARNING", 80)  # more take seconds, and teach nothing
    waves = lambda u: 0.5 * np.sign(np.sin(40 * u[:, 1]))  # noqa: E731
    exact = 0.5 * norm.sf(2.0) + 0.5 * norm.sf(3.0)
    results = [
        learned_estimate(lambda u: u[:, 0] + waves(u), 2, 2.5, seed=n, **SETTINGS) for n in range(2)
    ]
    errors = [(result.probability - exact) / exact for result in results]
    stated = np.array([result.coefficient_of_variation for result in results])
    assert min(result.runs for result in results) > 600, "the process is right, after all"
    assert max(np.abs(errors / stated)) < 3
    assert abs(np.mean(errors)) < 3 * 0.1 / np.sqrt(len(results))
    monkeypatch.undo()  # half of the runs that are allowed are placed, at most
    options = SETTINGS | {"most": 160}
    few = learned_estimate(lambda u: u[:, 0] + waves(u), 2, 2.5, seed=1, **options)
    assert few.placed <= 80
    assert few.runs <= 160


def test_missing_runs_widen_the_interval_on_both_sides():
    def response(scores):
        return np.where(scores[:, 1] > 1, np.nan, scores[:, 0])

    result = learned_estimate(response, 2, norm.isf(1e-3), seed=1, **SETTINGS)
    assert result.verdict is RareEventVerdict.MISSING
    assert result.low < result.if_none < 1e-3 < result.if_all < result.high
    assert result.if_none == pytest.approx(1e-3 * norm.cdf(1), rel=0.2)


def test_no_more_runs_are_placed_where_runs_have_failed():
    """Two places are equally doubtful before any run; at one of them a run fails."""
    fit = Process(GaussianProcessRegressor(RBF(0.3)), 0.0)
    around = np.array([2.0, 2.0]) + 0.02 * np.random.default_rng(1).standard_normal((30, 2))
    candidates = np.concatenate([around, around * [1, -1]])
    both = _batch(fit, candidates, np.ones(60), np.empty((0, 2)))
    assert (both[0, 1] > 0) != (both[1, 1] > 0)
    left = _batch(fit, candidates, np.ones(60), np.array([[2.0, 2.0]]))
    assert (left[:2, 1] < 0).all()


@pytest.mark.long
@pytest.mark.parametrize(
    "response",
    [
        lambda u: np.minimum(u[:, 0], 2.0),
        lambda u: np.full(len(u), np.nan),
        lambda u: np.zeros(len(u)),
    ],
)
def test_a_limit_out_of_reach_has_no_probability(response, monkeypatch):
    monkeypatch.setattr(limit_state, "_LEVELS", 8)  # none of them reaches it
    result = learned_estimate(response, 2, 5.0, seed=1, **SETTINGS | {"most": 160})
    assert result.verdict is RareEventVerdict.NOT_REACHED
    assert np.isnan(result.probability)
    assert result.runs <= 160
