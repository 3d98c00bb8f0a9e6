"""Extended FAST against analytic indices, SALib's own numbers, and its floor."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr
from SALib.analyze import fast
from SALib.sample import fast_sampler

from impactlab.analysis import sensitivity

Build = Callable[..., xr.Dataset]
Z95 = 1.959964


def _unit(size: int, points: int = 1025) -> Any:
    names = [f"x{i}" for i in range(size)]
    problem = {"num_vars": size, "names": names, "bounds": [[0, 1]] * size}
    return fast_sampler.sample(problem, points, seed=3)


def _runs(drawn: Build, known: Any, **attrs: Any) -> xr.Dataset:
    """With the dummy's curve last, and the dummy itself left out."""
    unit = _unit(known.size + 1)[:, :-1]
    return drawn("fast", unit, known.of_unit(unit), **({"harmonics": 4} | attrs))


@pytest.mark.parametrize("name", ["ishigami", "sobol_g"])
def test_analytic_indices(drawn: Build, name: str, request: pytest.FixtureRequest) -> None:
    known = request.getfixturevalue(name)
    found = sensitivity.analysis(_runs(drawn, known)).isel(response=0)
    for order, exact in (("first_order", known.first), ("total_order", known.total)):
        standard = found[f"{order}_interval"] / Z95
        assert (abs(found[order] - exact) <= 3 * standard).all()
        assert (abs(found[order] - exact) < 0.03).all()
        assert found[order].attrs["estimator"].startswith("extended FAST")
    assert found["dummy_first_order"] < 1e-3
    assert 0 < found["dummy_total_order"] < 0.1


def test_indices_are_those_of_salib(drawn: Build, ishigami: Any) -> None:
    runs = _runs(drawn, ishigami)
    found = sensitivity.analysis(runs).isel(response=0)
    problem = {"num_vars": 4, "names": list("abcd")}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        theirs = fast.analyze(problem, runs["peak_force"].values, num_resamples=2, seed=1)
    for order, key in (("first_order", "S1"), ("total_order", "ST")):
        np.testing.assert_allclose(found[order], theirs[key][:-1], rtol=1e-12)
        np.testing.assert_allclose(found[f"dummy_{order}"], theirs[key][-1], rtol=1e-12)


def test_half_curves_are_those_of_salib(drawn: Build, ishigami: Any) -> None:
    """The same distribution: both draw the start of a half evenly."""
    runs = _runs(drawn, ishigami, resamples=1500)
    found = sensitivity.analysis(runs).isel(response=0)
    curve = runs["peak_force"].values[:1025]
    np.random.seed(1)  # noqa: NPY002 - SALib draws from the global stream
    first, total = fast.bootstrap(curve, 4, 1500, 0.95)
    expected = np.hypot([first, total], [found["dummy_first_order"], found["dummy_total_order"]])
    ours = [found["first_order_interval"][0], found["total_order_interval"][0]]
    np.testing.assert_allclose(ours, expected, rtol=0.06)


@pytest.mark.parametrize("seed", [0, 1])
def test_seed(drawn: Build, ishigami: Any, seed: int) -> None:
    def interval(seed: int) -> Any:
        found = sensitivity.analysis(_runs(drawn, ishigami, resamples=10, seed=seed))
        return found["first_order_interval"].values.tolist()

    assert interval(seed) == interval(seed) != interval(seed + 1)


def test_a_curve_that_does_not_vary_has_no_indices(
    drawn: Build, ishigami: Any, verdicts_of: Callable[..., Any]
) -> None:
    runs = _runs(drawn, ishigami)
    runs["peak_force"][1025:2050] = 2.0
    found = sensitivity.analysis(runs)
    assert verdicts_of(found["sensitivity_verdict"]) == ["constant"]
    assert np.isnan(found["total_order"]).all()


def test_refuses_what_is_not_its_sample(drawn: Build, ishigami: Any) -> None:
    runs = _runs(drawn, ishigami)
    with pytest.raises(ValueError, match="has 4099 runs, but 4 curves of 1024 points make 4096"):
        sensitivity.analysis(runs.isel(run=slice(None, -1)))
    with pytest.raises(ValueError, match="too few for 16 harmonics: take more than 1024"):
        sensitivity.analysis(runs.isel(run=slice(None, 4096)).assign_attrs(harmonics=16))
    with pytest.raises(ValueError, match="'fast' has no groups"):
        sensitivity.analysis(runs.assign_attrs(groups=["a", "a", "b"]))
