"""Samples as points of the unit cube, and fits: exact for polynomials, sparse, repeatable."""

import numpy as np
import pytest
import xarray as xr
from SALib.sample import fast_sampler
from sklearn.linear_model import lars_path_gram
from threadpoolctl import threadpool_limits

from impactlab.analysis.surrogate import analysis
from impactlab.analysis.surrogate.chaos import MOST_RUNS, drawn, fit
from impactlab.analysis.surrogate.from_runs import Divided
from impactlab.analysis.surrogate.least_angle import terms_in_order

from .conftest import UNIT


def first(unit):
    return unit[:, 0]


def test_whole_blocks_of_saltelli_are_held_out(drawn_runs):
    sample = Divided.of(drawn_runs(base_samples=64, peak_force=first))
    blocks = sample.part.reshape(64, 8)
    assert (blocks == blocks[:, :1]).all()
    assert sorted(np.bincount(blocks[:, 0])) == [12, 13, 13, 13, 13]
    assert np.array_equal(sample.tests, np.arange(512)), "a small sample is tested as a whole"
    # of many held out runs some are tested
    sample = Divided.of(drawn_runs(base_samples=4096, peak_force=first))
    assert sample.tests.size == 4000 == np.unique(sample.tests).size
    assert (sample.part[sample.tests] == 0).all()
    # groups stand for their parameters
    runs = drawn_runs(peak_force=first)
    assert Divided.of(runs).sample.factors == ("velocity", "beam_depth", "beam_yield_stress")
    grouped = Divided.of(runs.assign_attrs(groups=["impact", "beam", "beam"]))
    assert grouped.sample.factors == ("impact", "beam")


@pytest.mark.parametrize(
    ("attrs", "length"),
    [
        ({"method": "morris", "trajectories": 32}, 16),
        ({"method": "fast", "curves": 4, "harmonics": 4}, 128),
        ({"method": "delta", "samples": 512}, 1),
        ({"method": "pawn", "samples": 512}, 1),
    ],
)
def test_blocks_of_other_methods(drawn_runs, attrs, length):
    sample = Divided.of(drawn_runs(base_samples=64, attrs=attrs, peak_force=first))
    parts = sample.part.reshape(-1, length)
    assert (parts == parts[:, :1]).all()
    assert np.ptp(np.bincount(parts[:, 0], minlength=5)) <= 1


def test_runs_that_are_no_whole_sample_are_refused(drawn_runs):
    runs = drawn_runs(peak_force=first).isel(run=slice(0, 500))
    with pytest.raises(ValueError, match=r"'synthetic' has 500 runs, .* method sobol: solve"):
        Divided.of(runs)
    # what counts as a sample
    runs = drawn_runs(peak_force=first)
    assert analysis(runs)
    grid = xr.Dataset(coords={"velocity": [1.0, 2.0]}, attrs={"varied": ["velocity"]})
    assert not analysis(grid)
    runs["velocity"].attrs.pop("distribution")
    assert not analysis(runs)


@pytest.fixture
def random():
    return np.random.default_rng(3)


def fitted(unit, values, seed):
    return fit(unit, values, seed, [UNIT] * unit.shape[1])


def bent(unit):
    return np.exp(unit[:, 0]) * np.maximum(unit[:, 1], 0.4) + 0.3 * unit[:, 2]


def test_polynomials_are_met_exactly(random):
    def polynomial(x):
        return 2e5 * (x[:, 0] + x[:, 1] + x[:, 0] * x[:, 1] - 4 * x[:, 2] ** 3 + 7)

    unit, other = random.random((200, 3)), random.random((100, 3))
    np.testing.assert_allclose(
        fitted(unit, polynomial(unit), 0)(other), polynomial(other), rtol=1e-10
    )


def test_terms_that_do_not_help_are_left_out(random):
    unit = random.random((400, 3))
    noisy = unit[:, 0] + 0.05 * random.standard_normal(400)
    chaos = fitted(unit, noisy, 0)
    assert len(chaos.degrees) < 12
    assert [1, 0, 0] in chaos.degrees.tolist()


def test_levels_bound_the_degree(random):
    # Four levels, as of Morris: a fourth degree would be one of the lower ones again.
    unit = random.integers(0, 4, (300, 2)) / 3
    chaos = fitted(unit, np.sin(5 * unit[:, 0]) + unit[:, 1], 0)
    assert chaos.degrees.max() <= 3
    np.testing.assert_allclose(chaos(unit), np.sin(5 * unit[:, 0]) + unit[:, 1], atol=1e-9)


@pytest.mark.parametrize("kind", ["independent", "levels", "copies", "powers"])
@pytest.mark.filterwarnings("ignore:Regressors in active set degenerate")
def test_terms_enter_in_the_order_of_scikit_learn(random, kind):
    """To the last one, also where a term depends on others and round-off decides."""
    for runs, terms in ((40, 12), (200, 90), (400, 60)):
        columns = random.standard_normal((terms, runs))
        if kind == "levels":
            columns = random.integers(0, 3, columns.shape) * 1.0
        elif kind == "copies":
            columns[terms // 2 :] = columns[: terms - terms // 2]
        elif kind == "powers":
            columns = np.linspace(-1, 1, runs) ** np.arange(1, terms + 1)[:, None]
        columns -= columns.mean(axis=1, keepdims=True)
        columns /= np.linalg.norm(columns, axis=1, keepdims=True)
        values = columns[:3].sum(axis=0) + 0.01 * random.standard_normal(runs)
        with threadpool_limits(limits=1):
            products, correlations = columns @ columns.T, columns @ (values - values.mean())
            expected = lars_path_gram(correlations, products, n_samples=1, max_iter=50)[1]
            assert terms_in_order(correlations, products, 50) == [int(term) for term in expected]


def test_terms_that_the_runs_cannot_tell_apart_do_no_harm(random):
    """On the short curves of extended FAST many polynomials are each other's aliases."""
    problem = {"num_vars": 3, "names": list("xyz"), "bounds": [[0, 1]] * 3}
    unit, other = fast_sampler.sample(problem, 65, seed=2)[:130], random.random((200, 3))
    chaos = fitted(unit, np.exp(unit[:, 0]) * (1 + unit[:, 1]), 0)
    exact = np.exp(other[:, 0]) * (1 + other[:, 1])
    assert np.abs(chaos(other) - exact).max() < 0.05


def test_a_small_change_of_a_large_value_is_seen(random):
    unit, other = random.random((200, 2)), random.random((50, 2))
    found = fitted(unit, 1e6 + bent(np.c_[unit, unit[:, :1]]), 0)(other) - 1e6
    assert np.abs(found - bent(np.c_[other, other[:, :1]])).max() < 0.1
    # the same runs give the same bits
    unit = random.random((300, 3))
    one, other = fitted(unit, bent(unit), 1), fitted(unit, bent(unit), 1)
    assert one.coefficients.tobytes() == other.coefficients.tobytes()
    assert one.degrees.tobytes() == other.degrees.tobytes()
    # too few runs are refused
    unit = random.random((15, 3))
    with pytest.raises(ValueError, match=r"15 runs are too few .* 3 parameters: solve 16 or more"):
        fitted(unit, unit[:, 0], 0)


@pytest.mark.parametrize("seed", [0, 5])
def test_of_many_runs_the_seed_chooses(seed):
    rows = drawn(3 * MOST_RUNS, seed)
    assert rows.size == MOST_RUNS == np.unique(rows).size
    assert np.array_equal(rows, drawn(3 * MOST_RUNS, seed))
    assert not np.array_equal(rows, drawn(3 * MOST_RUNS, seed + 1))
    assert np.array_equal(drawn(10, seed), np.arange(10))


@pytest.mark.parametrize("unit_of_response", [1e-9, 1e9])
def test_the_unit_of_the_response_does_not_matter(random, unit_of_response):
    unit = random.random((300, 3))
    one, other = fitted(unit, bent(unit), 1), fitted(unit, unit_of_response * bent(unit), 1)
    assert np.array_equal(one.degrees, other.degrees)
    np.testing.assert_allclose(other.coefficients, unit_of_response * one.coefficients, rtol=1e-9)


@pytest.mark.parametrize("threads", [2, 4])
def test_processors_do_not_matter(random, threads):
    unit = random.random((3000, 3))
    with threadpool_limits(limits=threads):
        found = fitted(unit, bent(unit), 1).coefficients
    with threadpool_limits(limits=1):
        assert fitted(unit, bent(unit), 1).coefficients.tobytes() == found.tobytes()
