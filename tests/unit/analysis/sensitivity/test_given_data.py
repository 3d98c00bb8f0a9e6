"""Delta, PAWN and regression of a linear Gaussian model, whose answers are known."""

import numpy as np
import pytest
import xarray as xr
from known_indices import INDICES
from SALib.analyze import delta as salib_delta
from SALib.analyze import pawn as salib_pawn
from scipy.integrate import quad
from scipy.stats import ks_2samp, norm, qmc, spearmanr

from impactlab.analysis import sensitivity
from impactlab.methods.delta import deltas, first_orders
from impactlab.methods.pawn import distances, slides

WEIGHTS = np.array([2.0, -1.0, 0.0])
SHARES = WEIGHTS**2 / (WEIGHTS**2).sum()
METHODS = ("delta", "pawn", "regression")


@pytest.fixture(scope="module")
def normal():
    """A Latin hypercube of three standard normal parameters."""
    return norm.ppf(qmc.LatinHypercube(3, rng=np.random.default_rng(2)).random(500))


def exact_delta(share):
    """Return half the mean distance of the densities with and without x, of a Gaussian model.

    Given x = z, the response is N(z sqrt(share), 1 - share) against N(0, 1).
    """
    y, spread = np.linspace(-9, 9, 4001), np.sqrt(1 - share)

    def distance(z):
        apart = abs(norm.pdf(y) - norm.pdf(y, z * np.sqrt(share), spread))
        return float(0.5 * np.trapezoid(apart, y) * norm.pdf(z))

    return float(quad(distance, -6, 6, limit=200, epsabs=1e-4)[0])


def test_delta_of_a_linear_model(drawn, normal):
    found = sensitivity.analysis(drawn("delta", normal, normal @ WEIGHTS)).isel(response=0)
    exact = [exact_delta(0.8), exact_delta(0.2), 0.0]
    assert (abs(found["delta"] - exact) <= found["delta_interval"]).all()
    assert (found["delta_interval"] < 0.15).all()
    assert (abs(found["delta_first_order"] - SHARES) <= found["delta_first_order_interval"]).all()
    assert (found["delta_first_order_interval"] < 0.12).all()
    assert abs(found["dummy_delta"] - found["delta"][2]) < 0.06
    assert abs(found["dummy_delta_first_order"]) < found["dummy_delta_first_order_interval"]


@pytest.mark.parametrize("runs", [200, 1000])
def test_first_orders_of_few_runs_are_not_too_small(runs):
    """Ishigami's function and an inert parameter."""
    known = INDICES["ishigami"]
    exact, held, values = [*known.first_order, 0.0], [], []
    for seed in range(200):
        x = np.random.default_rng(seed).random((runs, 4))
        value, error = first_orders(x, known.of_unit(x))
        values.append(value)
        held.append(np.abs(value - exact) <= 1.96 * error)
    np.testing.assert_allclose(np.mean(values, axis=0), exact, atol=3 / runs + 0.005)
    assert np.mean(held, axis=0).min() >= {200: 0.83, 1000: 0.9}[runs]


def test_delta_of_an_inert_parameter_is_within_its_interval(drawn):
    """It is about 0.06 by noise alone, however many the runs."""
    held = []
    for seed in range(6):
        x = np.random.default_rng(seed).random((500, 3))
        outputs = np.exp(x @ [3.0, 1.5, 0.0])
        found = sensitivity.analysis(drawn("delta", x, outputs, resamples=15)).isel(response=0)
        held.append((found["delta"] <= found["delta_interval"]).values)
    np.testing.assert_array_equal(np.mean(held, axis=0) > 0.8, [False, False, True])


def test_intervals_of_delta_hold_the_exact_ones_of_ishigami(drawn):
    """By quadrature; its densities have sharp modes, which smoothing brings closer together."""
    x = np.random.default_rng(500).random((500, 3))
    outputs = INDICES["ishigami"].of_unit(x)
    found = sensitivity.analysis(drawn("delta", x, outputs, resamples=30)).isel(response=0)
    off = np.abs(found["delta"] - [0.264, 0.425, 0.209])
    assert (off < found["delta_interval"]).all()
    assert (found["delta_interval"] < 0.3).all()
    assert found["delta"].values.argmax() == 1


def test_delta_is_that_of_salib_at_its_width(normal):
    """On runs drawn more than once, with classes of unequal size."""
    rows = np.random.default_rng(1).integers(500, size=499)
    inputs, outputs = normal[rows], normal[rows] @ WEIGHTS
    edges, places = np.linspace(0, 499, 8), np.linspace(-4, 4, 100)
    words = np.zeros(3, bool)
    ours = deltas(inputs, outputs, 7, places, 1.0, words)
    for column, delta in zip(inputs.T, ours, strict=True):
        theirs = salib_delta.calc_delta(outputs, places, column, edges)
        np.testing.assert_allclose(delta, theirs, rtol=1e-10)


def test_delta_is_not_given_without_density(drawn, normal, verdicts_of):
    """SALib takes a class with one value of the response for one without influence."""
    outputs = np.clip(normal @ [2.0, 0.1, 0.0], 0.0, None)  # zero for half of the first parameter
    found = sensitivity.analysis(drawn("delta", normal, outputs, resamples=10))
    assert np.isnan(found["delta"][0, 0])
    assert np.isfinite(found["delta_first_order"]).all()
    assert verdicts_of(found["sensitivity_verdict"]) == ["no_density"]


def test_pawn_is_that_of_salib(drawn, normal):
    outputs = normal @ WEIGHTS
    found = sensitivity.analysis(drawn("pawn", normal, outputs)).isel(response=0)
    theirs = salib_pawn.analyze({"num_vars": 3, "names": list("abc")}, normal, outputs, S=10)
    np.testing.assert_allclose(found["pawn"], theirs["median"], rtol=1e-12)
    np.testing.assert_allclose(found["pawn_maximum"], theirs["maximum"], rtol=1e-12)
    assert found["pawn"][0] > found["pawn"][1] > 1.5 * found["dummy_pawn"]
    assert abs(found["pawn"][2] - found["dummy_pawn"]) < 0.1


def test_distances_are_those_of_kolmogorov_and_smirnov():
    """With ties, in unequal slides."""
    rng = np.random.default_rng(1)
    outputs, column = np.sort(rng.integers(20, size=207)).astype(float), rng.random(207)
    last = np.flatnonzero(np.diff(outputs, append=np.inf))
    members = slides(column)
    assert members.sum() == 206  # but for the largest value
    ours = distances(members, last)
    for slide, inside in enumerate(members.T):
        theirs = ks_2samp(outputs[inside], outputs, method="asymp").statistic
        np.testing.assert_allclose(ours[slide], theirs, atol=1e-12)


def test_intervals_of_pawn_hold_the_index_of_endless_runs(drawn):
    """The exact index of 3 x1 + x2 follows from the distributions; x3 is inert.

    With x1 in the slide about c, the sum is 3 c, plus a uniform number of the slide's width 0.3,
    plus x2.
    """
    y = np.linspace(0, 4, 4001)

    def trapezium(low, wide, narrow):
        """Return the distribution of low + wide u + narrow v, u and v uniform in (0, 1)."""

        def integral(t):
            return np.clip(t, 0, None) ** 2 / 2

        ends = (0, wide, narrow, wide + narrow)
        parts = (
            sign * integral(y - low - end) for sign, end in zip((1, -1, -1, 1), ends, strict=True)
        )
        return sum(parts) / (wide * narrow)

    whole, starts = trapezium(0, 3, 1), np.arange(10) / 10
    apart = [
        [np.abs(trapezium(3 * start, 0.3, 1) - whole).max() for start in starts],
        [np.abs(trapezium(start, 3, 0.1) - whole).max() for start in starts],
        np.zeros(10),
    ]
    held = []
    for seed in range(12):
        x = np.random.default_rng(seed).random((300, 3))
        found = sensitivity.analysis(drawn("pawn", x, x @ [3.0, 1.0, 0.0])).isel(response=0)
        for name, exact in (("pawn", np.median(apart, axis=1)), ("pawn_maximum", np.max(apart, 1))):
            held.append((np.abs(found[name] - exact) <= found[f"{name}_interval"]).values)
        assert found["sensitivity_verdict"] != 0  # the noise alone moves it by more than 0.1
    assert np.mean(held, axis=0).min() >= 0.8
    assert np.mean(held) > 0.9


def test_regression_of_a_linear_model(drawn, normal, verdicts_of):
    """Standardised coefficients, to the departure of the sample from unit variance."""
    outputs = normal @ WEIGHTS + 0.01 * np.random.default_rng(1).normal(size=500)
    found = sensitivity.analysis(drawn("regression", normal, outputs)).isel(response=0)
    exact = WEIGHTS * normal.std(axis=0) / outputs.std()
    np.testing.assert_allclose(found["regression"], exact, atol=1e-3)
    np.testing.assert_allclose(found["regression_r_squared"], 1, atol=1e-3)
    assert abs(found["dummy_regression"]) < 1e-3
    assert (found["regression_interval"] < 0.1).all()
    # R^2 and the error of a coefficient, sqrt((1 - R^2)/n), by the textbook.
    outputs = normal @ WEIGHTS + np.sqrt(5) * np.random.default_rng(1).normal(size=500)
    found = sensitivity.analysis(drawn("regression", normal, outputs, resamples=1000))
    design = np.column_stack([np.ones(500), normal])
    coefficients, residual = np.linalg.lstsq(design, outputs)[:2]
    share = 1 - residual[0] / ((outputs - outputs.mean()) ** 2).sum()
    standard = coefficients[1:] * normal.std(axis=0) / outputs.std()
    np.testing.assert_allclose(found["regression"][0], standard, rtol=1e-10)
    np.testing.assert_allclose(found["regression_r_squared"][0], share, rtol=1e-10)
    error = 1.96 * np.sqrt((1 - share) / 500)
    np.testing.assert_allclose(found["regression_interval"][0, 2], error, rtol=0.15)
    # ranks see through a monotone function
    found = sensitivity.analysis(drawn("regression", normal[:, :1], np.exp(3 * normal[:, 0])))
    np.testing.assert_allclose(found["rank_regression"], 1.0, atol=1e-12)
    np.testing.assert_allclose(found["rank_regression_r_squared"], 1.0, atol=1e-12)
    assert found["regression_r_squared"] < 0.5
    outputs = normal @ WEIGHTS
    alone = sensitivity.analysis(drawn("regression", normal[:, :1], outputs))["rank_regression"]
    rank = spearmanr(normal[:, 0], outputs).statistic
    np.testing.assert_allclose(alone[0, 0], rank, atol=1e-12)  # of a single one they are the same
    # regression that describes nothing says so
    found = sensitivity.analysis(drawn("regression", normal, normal[:, 0] ** 2))
    assert verdicts_of(found["sensitivity_verdict"]) == ["not_linear"]


@pytest.mark.parametrize("method", METHODS)
def test_seed_and_order(drawn, normal, method):
    def found(seed):
        outputs = normal[:200] @ WEIGHTS
        return drawn(method, normal[:200], outputs, seed=seed, resamples=5)

    none, one = sensitivity.analysis(found(0)), sensitivity.analysis(found(1))
    xr.testing.assert_identical(none, sensitivity.analysis(found(0)))
    assert not none[f"dummy_{method}"].equals(one[f"dummy_{method}"])
    backwards = found(0).isel(run=slice(None, None, -1))
    xr.testing.assert_identical(none, sensitivity.analysis(backwards))


@pytest.mark.parametrize("method", METHODS)
def test_groups_and_too_few_runs_are_refused(drawn, normal, method):
    runs = drawn(method, normal, normal @ WEIGHTS, groups=["a", "a", "b"])
    with pytest.raises(ValueError, match=f"'{method}' has no groups"):
        sensitivity.analysis(runs)
    if method != "delta":
        with pytest.raises(ValueError, match="9 runs are too few"):
            sensitivity.analysis(drawn(method, normal[:9], normal[:9] @ WEIGHTS))
