"""Analytic indices of Ishigami and Sobol-G, the guards around SALib, and the seed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
import xarray as xr
from SALib.sample import sobol as sampler

from impactlab.analysis import sensitivity

Build = Callable[..., xr.Dataset]
Z95 = 1.959964


def _sample(dimension: int, base: int, low: float, high: float, second_order: bool = True) -> Any:
    names = [f"x{i}" for i in range(dimension)]
    problem = {"num_vars": dimension, "names": names, "bounds": [[low, high]] * dimension}
    return sampler.sample(problem, base, calc_second_order=second_order, seed=7)


def ishigami(x: Any) -> Any:
    return np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def ishigami_indices() -> tuple[Any, Any, Any]:
    """First, total and second order, for a = 7, b = 0.1 (Ishigami and Homma 1990)."""
    v1 = 0.5 * (1 + 0.1 * np.pi**4 / 5) ** 2
    v2, v13 = 49 / 8, 0.01 * np.pi**8 * (1 / 18 - 1 / 50)
    second = np.zeros((3, 3))
    second[0, 2] = second[2, 0] = v13
    whole = v1 + v2 + v13
    return np.array([v1, v2, 0]) / whole, np.array([v1 + v13, v2, v13]) / whole, second / whole


A = np.array([0.0, 0.5, 3.0, 9.0, 99.0])


def sobol_g(x: Any) -> Any:
    return np.prod((np.abs(4 * x - 2) + A) / (1 + A), axis=1)


def sobol_g_indices() -> tuple[Any, Any, Any]:
    """First, total and second order (Saltelli and Sobol' 1995)."""
    parts = 1 / (3 * (1 + A) ** 2)
    whole = np.prod(1 + parts) - 1
    total = parts * np.prod(1 + parts) / (1 + parts)
    return parts / whole, total / whole, np.outer(parts, parts) / whole


def _within_three_standard_errors(found: xr.Dataset, name: str, expected: Any) -> None:
    error = np.abs(found[name].values[0] - expected)
    standard = found[f"{name}_interval"].values[0] / Z95
    off_diagonal = ~np.eye(len(expected), dtype=bool) if error.ndim == 2 else slice(None)
    assert (error <= 3 * standard)[off_diagonal].all()
    # an interval that is wide enough for anything proves nothing
    assert (standard[off_diagonal] < 0.05).all()


@pytest.mark.parametrize(
    ("function", "exact", "bounds", "dimension"),
    [(ishigami, ishigami_indices, (-np.pi, np.pi), 3), (sobol_g, sobol_g_indices, (0, 1), 5)],
)
def test_analytic_indices(
    sample_runs: Build, function: Any, exact: Any, bounds: Any, dimension: int
) -> None:
    x = _sample(dimension, 2048, *bounds)
    runs = sample_runs([f"x{i}" for i in range(dimension)], 2048, peak_force=function(x))
    found = sensitivity.analysis(runs)
    for name, expected in zip(("first_order", "total_order", "second_order"), exact(), strict=True):
        _within_three_standard_errors(found, name, expected)
    assert found["second_order"].dims == ("response", "parameter", "other_parameter")
    matrix = found["second_order"].values[0]
    np.testing.assert_array_equal(matrix, matrix.T)
    assert np.isnan(np.diagonal(matrix)).all()


def test_without_second_order(sample_runs: Build) -> None:
    x = _sample(3, 1024, -np.pi, np.pi, second_order=False)
    runs = sample_runs(["x0", "x1", "x2"], 1024, second_order=False, peak_force=ishigami(x))
    found = sensitivity.analysis(runs)
    assert "second_order" not in found
    assert "other_parameter" not in found.coords
    _within_three_standard_errors(found, "total_order", ishigami_indices()[1])


NAMES = ["velocity", "beam_depth", "beam_width"]


@pytest.fixture
def good() -> Any:
    return ishigami(_sample(3, 64, -np.pi, np.pi))


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
    verdicts = ["failed_runs", "usable", "failed_runs"]
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
    assert verdicts_of(found["sensitivity_verdict"]) == ["failed_runs", "usable"]
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
    with pytest.raises(ValueError, match=r"'synthetic' number 504, but .* make 512"):
        sensitivity.analysis(runs)
