"""Shapley effects of functions for which they are known, with correlations and with words."""

from itertools import combinations
from math import comb

import numpy as np
import pytest
import xarray as xr
from known_indices import INDICES

import impactlab as il
from impactlab.methods import shapley
from impactlab.methods.distributions import CHOICE
from impactlab.methods.runs import Sample


def effects_of(explained, size):
    """Return Shapley effects from the share that each subset explains, by definition."""
    effects = np.zeros(size)
    for p in range(size):
        others = [other for other in range(size) if other != p]
        for count in range(size):
            for subset in combinations(others, count):
                gain = explained({*subset, p}) - explained({*subset})
                effects[p] += gain / (size * comb(size - 1, count))
    return effects


def _linear(slopes, correlation):
    """A sum of normal parameters, the last two correlated: Owen and Prieur (2017), theorem 2."""
    matrix = np.eye(3)
    matrix[1, 2] = matrix[2, 1] = correlation
    whole = slopes @ matrix @ slopes

    def explained(members):
        u = sorted(members)
        inverse = np.linalg.pinv(matrix[np.ix_(u, u)]) if u else np.zeros((0, 0))
        return slopes @ matrix[:, u] @ inverse @ matrix[u] @ slopes / whole

    def draw(rng, runs):
        inputs = rng.multivariate_normal(np.zeros(3), matrix, runs)
        return inputs, inputs @ slopes

    return draw, effects_of(explained, 3)


def _ishigami():
    """Pairs are the highest interactions, and each is divided between its two parameters."""
    known = INDICES["ishigami"]

    def draw(rng, runs):
        unit = rng.random((runs, 3))
        return unit, known.of_unit(unit)

    return draw, (known.first_order + known.total_order) / 2


def _with_word():
    """A word of three that shifts the sum: variances 2/3 and 1, the third parameter inert."""

    def draw(rng, runs):
        word, x = rng.integers(3, size=runs), rng.normal(size=(runs, 2))
        return np.column_stack([word, x]), np.array([1.0, 0.0, -1.0])[word] + x[:, 0]

    return draw, np.array([0.4, 0.6, 0.0])


CASES = {
    "correlated": _linear(np.array([1.0, 1.0, 0.5]), 0.8),
    "inert but correlated": _linear(np.array([1.0, 1.0, 0.0]), 0.9),
    "ishigami": _ishigami(),
    "word": _with_word(),
}


def sample_of(inputs, seed, words=()):
    columns = {f"x{i}": ("run", column) for i, column in enumerate(inputs.T)}
    attrs = {"varied": list(columns), "seed": seed, "method": "shapley"}
    runs = xr.Dataset(coords={"run": np.arange(len(inputs)), **columns}, attrs=attrs)
    for name in words:
        values = np.array(["a", "b", "c"])[inputs[:, 0].astype(int)]
        runs[name] = ("run", values, {"distribution": CHOICE, "values": ["a", "b", "c"]})
    return Sample.of(runs)


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "runs"),
    [("correlated", 128), ("inert but correlated", 512), ("ishigami", 512), ("word", 128)],
)
def test_intervals_cover_the_known_effects(name, runs):
    draw, exact = CASES[name]
    covered, sums = [], []
    for seed in range(200):
        inputs, outputs = draw(np.random.default_rng(seed), runs)
        sample = sample_of(inputs, seed, ["x0"] if name == "word" else [])
        indices = shapley.INDICES.estimate(outputs, sample, "y")
        covered.append(np.abs(indices["shapley"] - exact) <= indices["shapley_interval"])
        sums.append(indices["shapley"].sum())
    assert np.mean(covered, axis=0).min() >= 0.93
    np.testing.assert_allclose(sums, 1.0)


def test_a_study_of_correlated_parameters_divides_the_variance(tmp_path):
    """A sum of normal parameters is solved, analysed and answered; too many are refused."""
    normal = il.Normal(mean=0.0, standard_deviation=1.0)

    def study(names, **sampling):
        parameters = dict.fromkeys(names, normal)
        return il.Study(
            title="Sum",
            function=lambda a, b, c: a + b + 0.5 * c,
            sampling=il.Shapley(samples=512, parameters=parameters, **sampling),
            results=tmp_path,
        )

    rank = 6 / np.pi * np.arcsin(0.8 / 2)  # Spearman's, of a normal copula
    divided = study("abc", correlations=[("b", "c", rank)])
    runs = divided.run(workers=1)
    indices = il.analyse(runs)
    error = np.abs(indices.shapley.squeeze() - CASES["correlated"][1])
    assert (error <= indices.shapley_interval.squeeze()).all()
    (answer,) = il.answers(runs, indices)
    assert "b and c): what correlated parameters explain together is divided between them" in answer
    with pytest.raises(il.StudyError, match=r"too many for shapley: vary at most 10"):
        study([f"x{i}" for i in range(11)])
