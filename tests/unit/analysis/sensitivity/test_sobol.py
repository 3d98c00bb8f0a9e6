"""Analytic indices of Ishigami and Sobol-G, intervals and their coverage, and the guards."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from SALib.analyze import sobol as salib

from impactlab.analysis import sensitivity
from impactlab.figures import measures
from impactlab.methods import record
from impactlab.methods import saltelli as numerics
from impactlab.methods import sobol as module
from impactlab.methods.runs import Sample
from impactlab.methods.saltelli import saltelli

Z95 = 1.959964


def _sample(dimension, base, second_order=True):
    return saltelli([f"x{i}" for i in range(dimension)], base, second_order, 7)


def _within_three_standard_errors(found, name, expected):
    error = np.abs(found[name].values[0] - expected)
    standard = found[f"{name}_interval"].values[0] / Z95
    off_diagonal = ~np.eye(len(expected), dtype=bool) if error.ndim == 2 else slice(None)
    assert (error <= 3 * standard)[off_diagonal].all()
    # an interval that is wide enough for anything proves nothing
    assert (standard[off_diagonal] < 0.05).all()


@pytest.mark.parametrize("name", ["ishigami", "sobol_g"])
def test_analytic_indices(sample_runs, name, request):
    known: Any = request.getfixturevalue(name)
    x, names = _sample(known.size, 2048), [f"x{i}" for i in range(known.size)]
    found = sensitivity.analysis(sample_runs(names, 2048, peak_force=known.of_unit(x)))
    _within_three_standard_errors(found, "first_order", known.first_order)
    _within_three_standard_errors(found, "total_order", known.total_order)
    _within_three_standard_errors(found, "second_order", known.second_order)
    assert found["second_order"].dims == ("response", "parameter", "other_parameter")
    matrix = found["second_order"].values[0]
    np.testing.assert_array_equal(matrix, matrix.T)
    assert np.isnan(np.diagonal(matrix)).all()


def test_without_second_order(sample_runs, ishigami):
    outputs = ishigami.of_unit(_sample(3, 1024, second_order=False))
    runs = sample_runs(["x0", "x1", "x2"], 1024, second_order=False, peak_force=outputs)
    found = sensitivity.analysis(runs)
    assert "second_order" not in found
    assert "other_parameter" not in found.coords
    _within_three_standard_errors(found, "total_order", ishigami.total_order)


def test_indices_and_intervals_are_those_of_covariances(sample_runs, ishigami):
    """The formulas pair by pair, on all base samples and without each of the eight replicates."""
    outputs = ishigami.of_unit(_sample(3, 64))
    found = sensitivity.analysis(sample_runs(["x0", "x1", "x2"], 64, peak_force=outputs))
    a, b, ab, ba = salib.separate_output_values(outputs, 3, 64, True)
    without = [np.arange(64) % 8 != replicate for replicate in range(8)]

    def covariance(*columns):
        return float(np.mean(np.prod([column - column.mean() for column in columns], axis=0)))

    def total(r, i):
        y, z = ab[r, i], ba[r, i]
        above = np.mean((a[r] - y) ** 2 + (b[r] - z) ** 2)
        return float(above / sum(covariance(x, x) for x in (a[r], y, b[r], z)))

    def first(r, i):
        y, z, control = ab[r, i], ba[r, i], covariance(a[r], b[r]) * (1 - total(r, i))
        same = covariance(b[r], y) + covariance(a[r], z) - 2 * control
        return 2 * same / sum(covariance(x, x) for x in (a[r], y, b[r], z))

    def second(r, i, j):
        runs = ab[r, i], ba[r, i], ab[r, j], ba[r, j]
        control = covariance(a[r], b[r]) * max(1 - total(r, i) - total(r, j), 0)
        both = covariance(runs[0], runs[3]) + covariance(runs[2], runs[1]) - 2 * control
        return 2 * both / sum(covariance(x, x) for x in runs) - first(r, i) - first(r, j)

    pairs = [("first_order", first, (i,)) for i in range(3)]
    pairs += [("total_order", total, (i,)) for i in range(3)]
    pairs += [("second_order", second, (i, j)) for i in range(3) for j in range(i + 1, 3)]
    for name, formula, where in pairs:
        np.testing.assert_allclose(found[name][0][where], formula(slice(None), *where), atol=1e-12)
        error = np.sqrt(7 * np.var([formula(rows, *where) for rows in without]))
        half_width = found[f"{name}_interval"][0][where]
        np.testing.assert_allclose(half_width, 2.364624 * error, rtol=1e-6)  # Student's t of 7


def test_errors_are_smaller_than_those_of_salib(sample_runs, ishigami):
    """The estimators of SALib, of the same runs, over 40 samples."""
    names = ["x0", "x1", "x2"]
    problem = {"num_vars": 3, "names": names, "bounds": [[0.0, 1.0]] * 3}
    exact = {"S1": ishigami.first_order, "ST": ishigami.total_order, "S2": ishigami.second_order}
    errors: dict[str, list[Any]] = {key: [] for key in exact}
    for seed in range(40):
        outputs = ishigami.of_unit(saltelli(names, 256, True, seed))
        runs = sample_runs(names, 256, peak_force=outputs)
        found = module.INDICES.estimate(outputs, Sample.of(runs), "y")
        theirs = salib.analyze(problem, outputs, num_resamples=2, seed=1)
        orders = ("first_order", "total_order", "second_order")
        for key, order in zip(exact, orders, strict=True):
            both = np.array([found[order], theirs[key]]) - exact[key]
            errors[key].append(both[:, *np.triu_indices(3, 1)] if key == "S2" else both)
    ratios = {
        key: np.divide(*np.sqrt(np.mean(np.square(values), axis=(0, 2))))
        for key, values in errors.items()
    }
    assert ratios["S1"] < 0.7
    assert ratios["ST"] < 0.85
    assert ratios["S2"] < 0.5


def test_blocks_change_nothing(sample_runs, ishigami, monkeypatch):
    outputs, names = ishigami.of_unit(_sample(3, 64)), ["x0", "x1", "x2"]
    runs = sample_runs(names, 64, peak_force=outputs)
    whole = sensitivity.analysis(runs)
    monkeypatch.setattr(numerics, "_ROWS", 24)
    xr.testing.assert_allclose(sensitivity.analysis(runs), whole, rtol=1e-12)


def _product(i, j, slope):
    return lambda x: slope * (x[:, i] + x[:, j]) + 3 * (x[:, i] - 0.5) * (x[:, j] - 0.5)


@pytest.mark.parametrize(
    ("dimension", "pair", "base", "slope"),
    [(6, (0, 3), 512, 1.0), (6, (0, 3), 128, 0.0), (5, (0, 1), 64, 0.0), (10, (1, 7), 128, 0.0)],
)
def test_intervals_cover_where_dimensions_of_a_and_b_depend_on_each_other(
    dimension, pair, base, slope
):
    """The parity of bits of four dimensions of one sequence, two of them of B, is constant."""
    names, function = [f"x{i}" for i in range(dimension)], _product(*pair, slope)
    share = 1 / 12 / (2 / 12 + 9 / 144) if slope else 0.0
    exact = np.where(np.isin(range(dimension), pair), share, 0.0)
    covered, alarms = [], 0
    for seed in range(40):
        outputs = function(saltelli(names, base, False, seed))
        attrs = {"varied": names, "base_samples": base, "second_order": 0, "replicates": 8}
        runs = xr.Dataset(coords={"run": np.arange(len(outputs))}, attrs=attrs)
        found = module.INDICES.estimate(outputs, Sample.of(runs), "y")
        covered.append(abs(found["first_order"] - exact) <= found["first_order_interval"])
        alarms += record.SensitivityVerdict.DEPENDENT_BASES in module.INDICES.judge(found)
    assert np.mean(covered, axis=0).min() >= 0.85  # 0.95 but for 3 standard deviations
    assert alarms <= 1


def test_dependent_base_samples_are_marked(sample_runs):
    """The product of all four signs is positive: a pure interaction has a first order above 0."""
    a, _, _, b = np.moveaxis(saltelli(["x0", "x1"], 128, False, 7).reshape(128, 4, 2) - 0.5, 1, 0)
    b[:, 0] *= np.sign(np.prod(a * b, axis=1))
    x = np.where(np.array([[0, 0], [1, 0], [0, 1], [1, 1]], bool), b[:, None], a[:, None])
    outputs = x.prod(axis=2).ravel()
    runs = sample_runs(["x0", "x1"], 128, second_order=False, peak_force=outputs)
    found = sensitivity.analysis(runs).isel(response=0)
    assert found["base_correlation"] == pytest.approx(9 / 16, abs=0.05)
    assert found["base_correlation"] > found["base_correlation_noise"] > 0
    remarks = found["sensitivity_remarks"]
    masks = dict(
        zip(remarks.attrs["flag_meanings"].split(), remarks.attrs["flag_masks"], strict=True)
    )
    assert int(remarks) & masks["dependent_bases"]


def test_a_small_share_is_real_and_an_unseen_parameter_is_not(sample_runs):
    """A share of 0.024 is far below the index that mean products give a dummy, yet well known."""
    unit = _sample(4, 1024, second_order=False)
    outputs = unit[:, :3] @ np.sqrt([0.85, 0.126, 0.024])
    outputs *= 1 + 1e-13 * np.sin(1e6 * unit[:, 3])  # the last changes the last digits alone
    names = ["velocity", "beam_width", "beam_depth", "unseen"]
    runs = sample_runs(names, 1024, second_order=False, peak_force=outputs)
    found = sensitivity.analysis(runs)
    total = measures.index(found, "total_order", "peak_force")
    assert total.values[2] == pytest.approx(0.024, abs=0.0001)
    assert 0.00001 < total.margins[2] < 0.0003
    assert 0 < total.values[3] < 1e-20
    assert total.significant.tolist() == [True, True, True, False]
    found["total_order_numerical"] = 0 * found["total_order"] + 0.03  # larger than the share
    total = measures.index(found, "total_order", "peak_force")
    assert total.numerically_lost.tolist() == [False, False, True, False]


def test_by_samples_are_the_indices_of_smaller_studies(sample_runs, ishigami):
    outputs, names = ishigami.of_unit(_sample(3, 512)), ["x0", "x1", "x2"]
    found = sensitivity.analysis(sample_runs(names, 512, peak_force=outputs))
    assert found["base_samples"].values.tolist() == [16, 32, 64, 128, 256, 512]
    part = sensitivity.analysis(sample_runs(names, 128, peak_force=outputs[: 128 * 8]))
    for name in ("first_order", "total_order"):
        series = found[f"{name}_by_samples"].isel(response=0)
        assert series.dims == ("base_samples", "parameter")
        np.testing.assert_array_equal(series.sel(base_samples=512), found[name][0])
        np.testing.assert_array_equal(series.sel(base_samples=128), part[name][0])
        widths = found[f"{name}_by_samples_interval"].sel(base_samples=128)
        np.testing.assert_allclose(widths, part[f"{name}_interval"], rtol=1e-12)
    widths = found["first_order_by_samples_interval"][0].mean("parameter").values
    np.testing.assert_array_equal(found["first_order_interval"][0].mean(), widths[-1])
    assert (widths[1:] < widths[:-1]).all()  # narrower with every doubling


def test_a_start_that_does_not_vary_has_no_indices_yet(sample_runs, ishigami):
    outputs = ishigami.of_unit(_sample(3, 256))
    outputs[: 16 * 8] = 1.0
    found = sensitivity.analysis(sample_runs(["x0", "x1", "x2"], 256, peak_force=outputs))
    series = found["first_order_by_samples"][0]
    assert np.isnan(series.sel(base_samples=[8, 16])).all()
    assert np.isfinite(series.sel(base_samples=[32, 256])).all()


def test_groups_have_the_closed_indices(sample_runs, ishigami):
    """x0 and x2 as one: their closed index is S0 + S2 + S02, and no interaction is left."""
    names, groups = ["x0", "x1", "x2"], ["one", "other", "one"]
    outputs = ishigami.of_unit(saltelli(groups, 1024, True, 7))
    attrs = {"groups": groups}
    found = sensitivity.analysis(sample_runs(names, 1024, attrs=attrs, peak_force=outputs))
    assert found["parameter"].values.tolist() == ["one", "other"]
    share = ishigami.first_order[0] + ishigami.second_order[0, 2]
    for name in ("first_order", "total_order"):
        _within_three_standard_errors(found, name, np.array([share, 1 - share]))
    assert abs(found["second_order"][0, 0, 1]) < found["second_order_interval"][0, 0, 1]


NAMES = ["velocity", "beam_depth", "beam_width"]


@pytest.fixture
def good(ishigami):
    return ishigami.of_unit(_sample(3, 64))


def _assert_no_indices(found, response):
    for name in ("first_order", "total_order", "second_order"):
        for key in (name, f"{name}_interval"):
            assert np.isnan(found[key].sel(response=response)).all()


def test_a_single_gap_leaves_no_index(sample_runs, verdicts_of, good):
    gap, infinite = good.copy(), good.copy()
    gap[13], infinite[200] = np.nan, np.inf
    runs = sample_runs(NAMES, 64, peak_force=gap, impulse=good, restitution=infinite)
    found = sensitivity.analysis(runs)
    verdicts = ["failed_runs", "wide_intervals", "failed_runs"]
    assert verdicts_of(found["sensitivity_verdict"]) == verdicts
    _assert_no_indices(found, "peak_force")
    _assert_no_indices(found, "restitution")
    assert np.isfinite(found["first_order"].sel(response="impulse")).all()


@pytest.mark.parametrize("level", [0.0, 345e6, 1e-12])
def test_a_constant_response_has_undefined_indices(sample_runs, verdicts_of, good, level):
    jitter = level * (1 + 1e-12 * np.sign(good))
    runs = sample_runs(NAMES, 64, remote_plastic_strain=jitter)
    found = sensitivity.analysis(runs)
    assert verdicts_of(found["sensitivity_verdict"]) == ["constant"]
    _assert_no_indices(found, "remote_plastic_strain")


def test_a_response_constant_over_the_base_samples_is_constant(sample_runs, verdicts_of):
    outputs = np.zeros(64 * 8)
    outputs[3::8] = 1.0
    found = sensitivity.analysis(sample_runs(NAMES, 64, peak_plastic_strain=outputs))
    assert verdicts_of(found["sensitivity_verdict"]) == ["constant"]
    _assert_no_indices(found, "peak_plastic_strain")


def test_a_mostly_constant_response_carries_a_warning(sample_runs, verdicts_of, good):
    rare = np.where(good > np.quantile(good, 0.92), good, 0.0)
    found = sensitivity.analysis(sample_runs(NAMES, 64, remote_plastic_strain=rare))
    assert verdicts_of(found["sensitivity_verdict"]) == ["mostly_constant"]
    assert np.isfinite(found["first_order"]).all()
    assert "mostly_constant" not in found["sensitivity_verdict"].attrs["sound_flags"].split()


def _intervals(runs, response="peak_force"):
    return sensitivity.analysis(runs)["first_order_interval"].sel(response=response).values.tolist()


def test_confidence_comes_from_the_study(sample_runs, good):
    def found(**attrs):
        runs = sample_runs(NAMES, 64, attrs=attrs, peak_force=good)
        return sensitivity.analysis(runs)["first_order_interval"]

    wide, narrow = found(confidence=0.95), found(confidence=0.5)
    np.testing.assert_allclose(wide / narrow, 2.364624 / 0.711142, rtol=1e-5)  # t of 7
    assert wide.attrs["confidence"] == 0.95
    assert "resamples" not in wide.attrs
    # order of runs is that of the run coordinate
    runs = sample_runs(NAMES, 64, peak_force=good)
    assert _intervals(runs.isel(run=slice(None, None, -1))) == _intervals(runs)


def test_refuses_a_part_of_a_sample(sample_runs, good):
    runs = sample_runs(NAMES, 64, peak_force=good).isel(run=slice(0, 504))
    with pytest.raises(ValueError, match=r"'synthetic' has 504 runs, but .* make 512"):
        sensitivity.analysis(runs)
    # a sample without replicates is refused
    runs = sample_runs(NAMES, 64, peak_force=good)
    del runs.attrs["replicates"]
    with pytest.raises(ValueError, match=r"'synthetic' has a sample of an earlier version"):
        sensitivity.analysis(runs)
