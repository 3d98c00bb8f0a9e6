"""Statistics of a slow model by runs of a fast one, on a pair with known answers."""

from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from known_indices import INDICES

import impactlab as il
from impactlab.analysis.multifidelity_indices import first_order, slow_index, total_order
from impactlab.model.case_table import case_table
from impactlab.solve import solve

ROOT = Path(__file__).parents[3]
KNOWN = INDICES["ishigami"]
VARIANCE = KNOWN.variance
RUNS, LOW_RUNS, REPETITIONS = 40, 400, 150


def ishigami_pair(seed, correlation, runs=RUNS, low_runs=LOW_RUNS):
    """Ishigami's function, and a copy with a bias, a scale and an independent error."""
    unit = np.random.default_rng([7, seed]).random((3, low_runs)).T
    high = KNOWN.of_unit(unit)
    error = -np.sqrt(2 * VARIANCE * (correlation**-2 - 1)) * np.cos(2 * np.pi * unit[:, 2])
    return {"low": 2 + 1.5 * (high + error), "high": high[:runs]}


@pytest.mark.parametrize("correlation", [0.5, 0.9, 0.99])
def test_the_mean_is_unbiased_covered_and_as_accurate_as_theory_says(correlation):
    pairs = [ishigami_pair(seed, correlation) for seed in range(REPETITIONS)]
    means = [il.Multifidelity(**pair).mean() for pair in pairs]
    values = np.array([mean.value for mean in means])
    assert abs(values.mean() - 3.5) < 3 * values.std() / np.sqrt(REPETITIONS)
    covered = np.mean([mean.interval[0] < 3.5 < mean.interval[1] for mean in means])
    assert 0.90 < covered < 0.99  # 95 % give or take 2.6 standard deviations of 150 repetitions
    ratio = values.var() / (VARIANCE / RUNS)
    assert ratio == pytest.approx(1 - correlation**2 * (1 - RUNS / LOW_RUNS), rel=0.3)


@pytest.mark.slow
def test_the_variance_is_unbiased_covered_and_as_accurate_as_it_says():
    pairs = [ishigami_pair(seed, 0.97) for seed in range(REPETITIONS)]
    variances = [il.Multifidelity(**pair).variance() for pair in pairs]
    values = np.array([variance.value for variance in variances])
    assert abs(values.mean() - VARIANCE) < 3 * values.std() / np.sqrt(REPETITIONS)
    covered = np.mean([one.interval[0] < VARIANCE < one.interval[1] for one in variances])
    assert 0.90 < covered < 0.995
    plain = np.var([pair["high"].var(ddof=1) for pair in pairs])
    saving = np.median([variance.saving for variance in variances])
    assert plain / values.var() == pytest.approx(saving, rel=0.4)
    useless = il.Multifidelity(**ishigami_pair(1, 0.5))
    with pytest.raises(ValueError, match=r"below 0\.85 in size the runs of high alone do as well"):
        useless.variance()


def test_the_probability_comes_from_the_pairs_where_the_fast_model_is_useless():
    rng = np.random.default_rng(3)
    high = rng.normal(size=400)
    models = il.Multifidelity(low=rng.normal(size=4000), high=high)
    assert models.exceedance(0.5).value == pytest.approx(np.mean(high > 0.5), abs=0.01)
    assert models.exceedance(0.5).saving == pytest.approx(1.0, abs=0.05)


@cache
def known_quantiles(*probabilities):
    outputs = KNOWN.of_unit(np.random.default_rng(0).random((1_000_000, 3)))
    return np.quantile(outputs, probabilities)


def test_quantiles_are_covered_and_as_accurate_as_they_say():
    probability = 0.25
    (exact,) = known_quantiles(probability)
    pairs = [ishigami_pair(seed, 0.97) for seed in range(60)]
    quantiles = [il.Multifidelity(**pair).quantile(probability) for pair in pairs]
    values = np.array([quantile.value for quantile in quantiles])
    assert abs(values.mean() - exact) < 0.4 * values.std()
    covered = np.mean([q.interval[0] < exact < q.interval[1] for q in quantiles])
    assert covered > 0.86  # 95 % less 3 standard deviations of 60 repetitions
    plain = np.var([np.quantile(pair["high"], probability) for pair in pairs])
    saving = np.median([quantile.saving for quantile in quantiles])
    assert plain / values.var() == pytest.approx(saving, rel=0.5)


@pytest.mark.long
def test_outer_quantiles_are_covered_and_save_runs_where_the_models_agree():
    ends = (0.05, 0.95)
    pairs = [ishigami_pair(seed, 0.97, runs=100, low_runs=800) for seed in range(60)]
    for probability, exact, ratio in zip(ends, known_quantiles(*ends), (0.8, 1.05), strict=True):
        quantiles = [il.Multifidelity(**pair).quantile(probability) for pair in pairs]
        covered = np.mean([q.interval[0] < exact < q.interval[1] for q in quantiles])
        assert covered > 0.86  # 95 % less 3 standard deviations of 60 repetitions
        plain = np.std([np.quantile(pair["high"], probability) for pair in pairs])
        assert np.std([quantile.value for quantile in quantiles]) < ratio * plain


def indices_of_pairs(seed, correlation, pairs=40, base_samples=1000):
    """Return indices of Ishigami's function by a copy whose error is an interaction.

    In the order x1, x2, x3 of first order, then of total order.
    """
    rng = np.random.default_rng([8, seed])
    scale = np.sqrt(4 * VARIANCE * (correlation**-2 - 1))

    def fast(unit):
        waves = np.cos(2 * np.pi * unit[..., 1]) * np.sin(4 * np.pi * unit[..., 2])
        return 2 + 1.5 * (KNOWN.of_unit(unit) - scale * waves)

    first, others = rng.random((2, base_samples, 3))
    points, *drawn = rng.random((9, pairs, 3))
    drawn = np.array(drawn)
    outputs, low, high = [fast(first), fast(others)], fast(points), KNOWN.of_unit(points)
    variance = np.var(outputs, ddof=1)
    indices = [[], []]
    for column in range(3):
        mixed, alone, without = first.copy(), drawn.copy(), np.tile(points, (8, 1, 1))
        mixed[:, column], alone[..., column] = others[:, column], points[:, column]
        without[..., column] = drawn[..., column]
        parts = first_order(*outputs, fast(mixed), fast(alone))
        indices[0].append(slow_index(low, high, variance, parts, 0.95))
        parts = total_order(*outputs, fast(mixed), fast(without), low)
        indices[1].append(slow_index(low, high, variance, parts, 0.95))
    return np.array(indices).reshape(6, 3)


@pytest.mark.parametrize(("correlation", "width"), [(0.9, 0.6), (0.9999, 0.21)])
def test_indices_of_the_slow_model_are_covered(correlation, width):
    exact = np.concatenate([KNOWN.first_order, KNOWN.total_order])
    indices = np.array([indices_of_pairs(seed, correlation) for seed in range(60)])
    covered = (indices[..., 1] <= exact) & (exact <= indices[..., 2])
    assert covered.mean(axis=0).min() > 0.86
    assert ((indices[..., 1] <= indices[..., 0]) & (indices[..., 0] <= indices[..., 2])).all()
    assert np.median(indices[..., 2] - indices[..., 1], axis=0).max() < width


@pytest.mark.parametrize(
    ("probability", "message"),
    [
        (0.96, r"must be from 0\.05 to 0\.95"),
        (0.25, "7.5 of 30 runs of high are expected"),
        (0.9, "3 of 30 runs of high are expected on one side, 5 are needed"),
    ],
)
def test_a_quantile_whose_interval_is_not_sound_is_refused(probability, message):
    pair = ishigami_pair(1, 0.9, runs=30)
    with pytest.raises(ValueError, match=message):
        il.Multifidelity(**pair).quantile(probability)


def test_the_best_number_of_fast_runs_minimises_the_variance_for_a_budget():
    pair = ishigami_pair(1, 0.9)
    models, cost = il.Multifidelity(**pair), 1000.0
    ratios = np.geomspace(1, 1000, 3001)
    variances = (1 - models.correlation**2 * (1 - 1 / ratios)) * (cost + ratios)
    best = ratios[variances.argmin()]
    assert models.low_runs_per_high_run(cost_ratio=cost) == pytest.approx(best, rel=0.01)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"high": np.arange(5.0)}, "high: has 5 runs: at least 20"),
        ({"high": np.full(40, np.nan)}, "40 of 40 runs have no answer"),
        ({"low": np.arange(50.0)}, "low: has 50 runs: at least twice the 40"),
        ({"low": np.ones(400)}, "do not vary"),
        ({"confidence": 95}, "confidence = 95"),
    ],
)
def test_what_gives_no_statistics_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        il.Multifidelity(**ishigami_pair(1, 0.9) | changes)


def test_a_limit_that_hardly_a_run_exceeds_is_refused():
    with pytest.raises(ValueError, match="0 of 40 runs of high exceed it"):
        il.Multifidelity(**ishigami_pair(1, 0.9)).exceedance(100.0)


def predicted_pair(seed, rest, pairs=20, points=20):
    """Return models of three inputs, points among the pairs, and what the fast and slow tell."""
    rng = np.random.default_rng([9, seed])
    inputs = rng.normal(size=(pairs, 3))
    weights = [1.0, 0.6, 0.3]
    columns, places = (
        np.column_stack([x, x @ weights]) for x in (inputs, rng.normal(size=(200, 3)))
    )
    within = (places > columns.min(axis=0)) & (places < columns.max(axis=0))
    places = places[within.all(axis=1), :3][:points]
    every = np.concatenate([inputs, places])
    low = every @ weights
    high = 2 * low + rest(every, rng)
    low_runs = np.append(low[:pairs], rng.normal(size=pairs))
    models = il.Multifidelity(low=low_runs, high=high[:pairs], inputs=inputs)
    return models.prediction(places, low[pairs:]), high[pairs:]


@pytest.mark.long
@pytest.mark.parametrize(
    ("rest", "width"),
    [
        (lambda x, _: 0.3 * x[:, 0] ** 2 + 0.2 * x[:, 1] * x[:, 2], 1.2),
        (lambda _, rng: 0.3 * rng.normal(size=len(_)), 2.5),
    ],
)
def test_predictions_are_covered_and_narrower_than_a_constant_correction(rest, width):
    """The rest is smooth, or noise, which no process predicts: intervals must not shrink."""
    answers = [predicted_pair(seed, rest) for seed in range(16)]
    covered = [(a.low <= exact) & (exact <= a.high) for a, exact in answers]
    assert np.concatenate(covered).mean() > 0.93
    assert np.median(np.concatenate([a.high - a.low for a, _ in answers])) < width


def test_a_line_in_the_fast_model_is_predicted_exactly():
    answer, exact = predicted_pair(1, lambda x, _: np.full(len(x), -3.0))
    np.testing.assert_allclose(answer.value, exact, rtol=1e-12, atol=1e-12)
    assert (answer.low <= exact + 1e-12).all()
    assert (exact - 1e-12 <= answer.high).all()
    assert (answer.high - answer.low).max() < 1e-12


def test_what_cannot_be_predicted_is_refused():
    rng = np.random.default_rng(4)
    inputs, low = rng.uniform(size=(40, 2)), rng.normal(size=100)
    pair = {"low": low, "high": low[:40] + inputs[:, 0]}
    models = il.Multifidelity(**pair, inputs=inputs)
    points = [[0.5, 1.2], [0.5, 0.5], [-0.1, 0.5], [0.5, 0.5]]
    answer = models.prediction(points, low=[0.0, 0.1, 0.0, 9.0])
    missing = [True, False, True, True]
    assert np.isnan([answer.value, answer.low, answer.high]).tolist() == [missing] * 3
    assert answer.refusal == [
        "parameter 2 is beyond those of the pairs",
        "",
        "parameter 1 is beyond those of the pairs",
        "the fast output is beyond those of the pairs",
    ]
    for changes, points, message in (
        ({"inputs": inputs, "confidence": 0.98}, [[0.5, 0.5]], "98 % interval needs 49 pairs"),
        ({}, [[0.5, 0.5]], "state the `inputs` of the pairs"),
        ({"inputs": inputs}, [[0.5]], r"points: has the shape \(1, 1\): must be \(1, 2\)"),
        ({"inputs": inputs[1:]}, [[0.5, 0.5]], r"inputs: has the shape \(39, 2\)"),
    ):
        with pytest.raises(ValueError, match=message):
            il.Multifidelity(**pair, **changes).prediction(points, low=[0.0])


def test_solid_impacts_left_out_of_the_pairs_are_predicted():
    """The corrected beam and stored 3-D runs, whose indentations scatter by 3 %."""
    runs = pd.read_csv(ROOT / "docs" / "multifidelity_runs.csv")
    inputs, high = runs.iloc[:, :-2], runs["maximum_indentation"].to_numpy()
    cases = case_table(
        il.corrected_impact("5 m/s"),
        il.Discretisation(nodes=65),
        duration=0.2e-3,
        varied={name: column.to_numpy() for name, column in inputs.items()},
    )
    low = solve(cases)["maximum_indentation"]
    pairs = il.Multifidelity(low=low, high=high[:40], inputs=inputs[:40])
    answers = pairs.prediction(inputs[40:], low[40:])
    rows = np.isfinite(answers.value)
    assert rows.mean() > 0.5
    value, bottom, top, exact = (
        values[rows] for values in (answers.value, answers.low, answers.high, high[40:])
    )
    assert ((bottom <= exact) & (exact <= top)).mean() > 0.9
    assert np.sqrt(np.mean((value / exact - 1) ** 2)) < 0.004
    assert np.median((top - bottom) / exact) < 0.025
