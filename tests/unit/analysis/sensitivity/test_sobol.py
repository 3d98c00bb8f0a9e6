"""Analytic indices of Ishigami and Sobol-G, the guards around SALib, and the seed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
import scipy.stats
import xarray as xr
from SALib.analyze import sobol as salib
from SALib.sample import sobol as sampler

from impactlab.analysis import sensitivity
from impactlab.analysis.responses import Sample
from impactlab.analysis.sensitivity import sobol as module
from impactlab.analysis.sensitivity.sobol import Outputs, estimates, points
from impactlab.figures import measures

Build = Callable[..., xr.Dataset]
Z95 = 1.959964


def _sample(dimension: int, base: int, second_order: bool = True) -> Any:
    names = [f"x{i}" for i in range(dimension)]
    problem = {"num_vars": dimension, "names": names, "bounds": [[0, 1]] * dimension}
    return sampler.sample(problem, base, calc_second_order=second_order, seed=7)


def _within_three_standard_errors(found: xr.Dataset, name: str, expected: Any) -> None:
    error = np.abs(found[name].values[0] - expected)
    standard = found[f"{name}_interval"].values[0] / Z95
    off_diagonal = ~np.eye(len(expected), dtype=bool) if error.ndim == 2 else slice(None)
    assert (error <= 3 * standard)[off_diagonal].all()
    # an interval that is wide enough for anything proves nothing
    assert (standard[off_diagonal] < 0.05).all()


@pytest.mark.parametrize("name", ["ishigami", "sobol_g"])
def test_analytic_indices(sample_runs: Build, name: str, request: pytest.FixtureRequest) -> None:
    known: Any = request.getfixturevalue(name)
    x, names = _sample(known.size, 2048), [f"x{i}" for i in range(known.size)]
    found = sensitivity.analysis(sample_runs(names, 2048, peak_force=known.of_unit(x)))
    _within_three_standard_errors(found, "first_order", known.first)
    _within_three_standard_errors(found, "total_order", known.total)
    _within_three_standard_errors(found, "second_order", known.second)
    assert found["second_order"].dims == ("response", "parameter", "other_parameter")
    matrix = found["second_order"].values[0]
    np.testing.assert_array_equal(matrix, matrix.T)
    assert np.isnan(np.diagonal(matrix)).all()


def test_without_second_order(sample_runs: Build, ishigami: Any) -> None:
    outputs = ishigami.of_unit(_sample(3, 1024, second_order=False))
    runs = sample_runs(["x0", "x1", "x2"], 1024, second_order=False, peak_force=outputs)
    found = sensitivity.analysis(runs)
    assert "second_order" not in found
    assert "other_parameter" not in found.coords
    _within_three_standard_errors(found, "total_order", ishigami.total)


def test_scipy_gives_the_same(sample_runs: Build, ishigami: Any) -> None:
    """Scipy centres on the mean of A and B, SALib on that of all runs: exact once put right."""
    outputs = ishigami.of_unit(_sample(3, 256, second_order=False)) + 5.0
    runs = sample_runs(["x0", "x1", "x2"], 256, second_order=False, peak_force=outputs)
    found = sensitivity.analysis(runs).isel(response=0)
    table = outputs.reshape(256, 5).T
    a, ab, b = table[0], table[1:4], table[4]
    theirs = scipy.stats.sobol_indices(
        func={"f_A": a[None], "f_B": b[None], "f_AB": ab[:, None]}, n=256
    )
    shift = outputs.mean() - np.mean([a, b])
    moved = shift * (ab - a).mean(axis=1) / np.var([a, b])
    np.testing.assert_allclose(found["first_order"], theirs.first_order - moved, rtol=0, atol=1e-10)
    np.testing.assert_allclose(found["total_order"], theirs.total_order, rtol=0, atol=1e-10)


def test_intervals_are_those_of_salib(sample_runs: Build, ishigami: Any) -> None:
    """SALib's estimators on the very same resamples."""
    outputs = ishigami.of_unit(_sample(3, 64))
    runs = sample_runs(["x0", "x1", "x2"], 64, attrs={"resamples": 50}, peak_force=outputs)
    found = sensitivity.analysis(runs).isel(response=0)
    standard = (outputs - outputs.mean()) / outputs.std()
    a, b, ab, ba = salib.separate_output_values(standard, 3, 64, True)
    rows = Sample.of(runs).rng("peak_force").integers(64, size=(50, 64)).T

    def half_width(replicates: Any) -> Any:
        return Z95 * replicates.std(ddof=1)

    for i in range(3):
        first = salib.first_order(a[rows], ab[rows, i], b[rows])
        total = salib.total_order(a[rows], ab[rows, i], b[rows])
        np.testing.assert_allclose(found["first_order_interval"][i], half_width(first), rtol=1e-6)
        np.testing.assert_allclose(found["total_order_interval"][i], half_width(total), rtol=1e-6)
        for j in range(i + 1, 3):
            joint = salib.second_order(a[rows], ab[rows, i], ab[rows, j], ba[rows, i], b[rows])
            ours = found["second_order_interval"][i, j]
            np.testing.assert_allclose(ours, half_width(joint), rtol=1e-6)


def test_points_and_their_bootstrap_agree(sample_runs: Build, ishigami: Any) -> None:
    """The indices by SALib are those whose spread is told."""
    values = ishigami.of_unit(_sample(3, 64))
    sample = Sample.of(sample_runs(["x0", "x1", "x2"], 64, peak_force=values))
    outputs = Outputs.of(values, sample)
    ours, theirs = estimates(outputs.statistics().mean(axis=0), 3), points(outputs)
    for name in ("first_order", "total_order"):
        np.testing.assert_allclose(ours[name], theirs[name], atol=1e-12)
    upper = theirs["second_order"][np.triu_indices(3, 1)]
    np.testing.assert_allclose(ours["second_order"], upper, atol=1e-12)


@pytest.mark.parametrize("most", [512, 300])
def test_groups_of_many_base_samples_have_the_same_intervals(
    sample_runs: Build, ishigami: Any, monkeypatch: pytest.MonkeyPatch, most: int
) -> None:
    outputs, names = ishigami.of_unit(_sample(3, 4096)), ["x0", "x1", "x2"]
    runs = sample_runs(names, 4096, attrs={"resamples": 1000}, peak_force=outputs)
    whole = sensitivity.analysis(runs)
    monkeypatch.setattr(module, "MOST_ROWS", most)
    found = sensitivity.analysis(runs)
    for name in ("first_order", "total_order", "second_order"):
        np.testing.assert_array_equal(found[name], whole[name])
        widths = found[f"{name}_interval"], whole[f"{name}_interval"]
        np.testing.assert_allclose(*widths, rtol=0.15)  # 1000 resamples, some 300 groups
        assert not np.array_equal(*widths)


def test_a_small_share_is_real_and_an_unseen_parameter_is_not(sample_runs: Build) -> None:
    """A share of 0.024 is far below the index that mean products give a dummy, yet well known."""
    unit = _sample(4, 1024, second_order=False)
    outputs = unit[:, :3] @ np.sqrt([0.85, 0.126, 0.024])
    outputs *= 1 + 1e-13 * np.sin(1e6 * unit[:, 3])  # the last changes the last digits alone
    names = ["velocity", "beam_width", "beam_depth", "unseen"]
    runs = sample_runs(names, 1024, second_order=False, peak_force=outputs)
    found = sensitivity.analysis(runs)
    total = measures.index(found, "total_order", "peak_force")
    assert total.values[2] == pytest.approx(0.024, abs=0.003)
    assert 0.001 < total.margins[2] < 0.003
    assert 0 < total.values[3] < 1e-20
    assert total.significant.tolist() == [True, True, True, False]
    found["total_order_numerical"] = 0 * found["total_order"] + 0.03  # larger than the share
    total = measures.index(found, "total_order", "peak_force")
    assert total.numerically_lost.tolist() == [False, False, True, False]


def test_by_samples_are_the_indices_of_smaller_studies(sample_runs: Build, ishigami: Any) -> None:
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


def test_a_start_that_does_not_vary_has_no_indices_yet(sample_runs: Build, ishigami: Any) -> None:
    outputs = ishigami.of_unit(_sample(3, 256))
    outputs[: 16 * 8] = 1.0
    found = sensitivity.analysis(sample_runs(["x0", "x1", "x2"], 256, peak_force=outputs))
    series = found["first_order_by_samples"][0]
    assert np.isnan(series.sel(base_samples=[8, 16])).all()
    assert np.isfinite(series.sel(base_samples=[32, 256])).all()


def test_groups_have_the_closed_indices(sample_runs: Build, ishigami: Any) -> None:
    """x0 and x2 as one: their closed index is S0 + S2 + S02, and no interaction is left."""
    names, groups = ["x0", "x1", "x2"], ["one", "other", "one"]
    problem = {"num_vars": 3, "names": names, "bounds": [[0, 1]] * 3, "groups": groups}
    outputs = ishigami.of_unit(sampler.sample(problem, 1024, seed=7))
    attrs = {"groups": groups}
    found = sensitivity.analysis(sample_runs(names, 1024, attrs=attrs, peak_force=outputs))
    assert found["parameter"].values.tolist() == ["one", "other"]
    share = ishigami.first[0] + ishigami.second[0, 2]
    for name in ("first_order", "total_order"):
        _within_three_standard_errors(found, name, np.array([share, 1 - share]))
    assert abs(found["second_order"][0, 0, 1]) < found["second_order_interval"][0, 0, 1]


NAMES = ["velocity", "beam_depth", "beam_width"]


@pytest.fixture
def good(ishigami: Any) -> Any:
    return ishigami.of_unit(_sample(3, 64))


def _assert_no_indices(found: xr.Dataset, response: str) -> None:
    for name in ("first_order", "total_order", "second_order"):
        for key in (name, f"{name}_interval"):
            assert np.isnan(found[key].sel(response=response)).all()


def test_a_single_gap_leaves_no_index(
    sample_runs: Build, verdicts_of: Callable[..., Any], good: Any
) -> None:
    gap, infinite = good.copy(), good.copy()
    gap[13], infinite[200] = np.nan, np.inf
    runs = sample_runs(NAMES, 64, peak_force=gap, impulse=good, restitution=infinite)
    found = sensitivity.analysis(runs)
    verdicts = ["failed_runs", "wide_intervals", "failed_runs"]
    assert verdicts_of(found["sensitivity_verdict"]) == verdicts
    _assert_no_indices(found, "peak_force")
    _assert_no_indices(found, "restitution")
    assert np.isfinite(found["first_order"].sel(response="impulse")).all()


def test_a_failed_run_leaves_no_index_whatever_its_number(
    sample_runs: Build, verdicts_of: Callable[..., Any], good: Any
) -> None:
    runs = sample_runs(NAMES, 64, contact_duration=good, number_of_contacts=good)
    runs["status"][5] = 2  # first contact unfinished: matters to the contact duration alone
    found = sensitivity.analysis(runs)
    assert verdicts_of(found["sensitivity_verdict"]) == ["failed_runs", "wide_intervals"]
    _assert_no_indices(found, "contact_duration")


@pytest.mark.parametrize("level", [0.0, 345e6, 1e-12])
def test_a_constant_response_has_undefined_indices(
    sample_runs: Build, verdicts_of: Callable[..., Any], good: Any, level: float
) -> None:
    jitter = level * (1 + 1e-12 * np.sign(good))
    runs = sample_runs(NAMES, 64, remote_plastic_strain=jitter)
    found = sensitivity.analysis(runs)
    assert verdicts_of(found["sensitivity_verdict"]) == ["constant"]
    _assert_no_indices(found, "remote_plastic_strain")


def test_a_response_constant_over_the_base_samples_is_constant(
    sample_runs: Build, verdicts_of: Callable[..., Any]
) -> None:
    outputs = np.zeros(64 * 8)
    outputs[3::8] = 1.0
    found = sensitivity.analysis(sample_runs(NAMES, 64, peak_plastic_strain=outputs))
    assert verdicts_of(found["sensitivity_verdict"]) == ["constant"]
    _assert_no_indices(found, "peak_plastic_strain")


def test_a_mostly_constant_response_carries_a_warning(
    sample_runs: Build, verdicts_of: Callable[..., Any], good: Any
) -> None:
    rare = np.where(good > np.quantile(good, 0.92), good, 0.0)
    found = sensitivity.analysis(sample_runs(NAMES, 64, remote_plastic_strain=rare))
    assert verdicts_of(found["sensitivity_verdict"]) == ["mostly_constant"]
    assert np.isfinite(found["first_order"]).all()
    assert "mostly_constant" not in found["sensitivity_verdict"].attrs["sound_flags"].split()


def _intervals(runs: xr.Dataset, response: str = "peak_force") -> Sequence[float]:
    return sensitivity.analysis(runs)["first_order_interval"].sel(response=response).values.tolist()


@pytest.mark.parametrize("seed", [0, 1])
def test_intervals_are_reproducible(sample_runs: Build, good: Any, seed: int) -> None:
    first = _intervals(sample_runs(NAMES, 64, seed=seed, peak_force=good))
    again = _intervals(sample_runs(NAMES, 64, seed=seed, peak_force=good))
    other = _intervals(sample_runs(NAMES, 64, seed=seed + 1, peak_force=good))
    assert first == again
    assert first != other


def test_intervals_do_not_depend_on_the_other_responses(sample_runs: Build, good: Any) -> None:
    alone = _intervals(sample_runs(NAMES, 64, peak_force=good))
    behind = sample_runs(NAMES, 64, impulse=good, peak_force=good)
    assert _intervals(behind) == alone
    assert _intervals(behind, "impulse") != alone


def test_confidence_and_resamples_come_from_the_study(sample_runs: Build, good: Any) -> None:
    def found(**attrs: Any) -> xr.DataArray:
        runs = sample_runs(NAMES, 64, attrs=attrs, peak_force=good)
        return sensitivity.analysis(runs)["first_order_interval"]

    wide, narrow = found(confidence=0.95, resamples=50), found(confidence=0.5, resamples=50)
    np.testing.assert_allclose(wide / narrow, Z95 / 0.67449, rtol=1e-5)
    assert not np.allclose(wide, found(confidence=0.95, resamples=60))
    assert (wide.attrs["confidence"], wide.attrs["resamples"]) == (0.95, 50)


def test_order_of_runs_is_that_of_the_run_coordinate(sample_runs: Build, good: Any) -> None:
    runs = sample_runs(NAMES, 64, peak_force=good)
    assert _intervals(runs.isel(run=slice(None, None, -1))) == _intervals(runs)


def test_refuses_a_part_of_a_sample(sample_runs: Build, good: Any) -> None:
    runs = sample_runs(NAMES, 64, peak_force=good).isel(run=slice(0, 504))
    with pytest.raises(ValueError, match=r"'synthetic' has 504 runs, but .* make 512"):
        sensitivity.analysis(runs)
