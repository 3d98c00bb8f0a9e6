"""surrogate.nc: what comes back is what was fitted, and refuses what it does not know."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from impactlab.analysis.surrogate import analysis, load_surrogate, packed
from impactlab.analysis.surrogate.stored import Surrogate
from impactlab.files import write_netcdf
from impactlab.report.console import print_predictions

from .conftest import ishigami

Build = Callable[..., xr.Dataset]


def force(unit: Any) -> Any:
    return 1e4 * np.exp(unit[:, 0]) * (1 + unit[:, 1]) + 10 * unit[:, 2]


@pytest.fixture(scope="module")
def runs(drawn_runs: Build) -> xr.Dataset:
    return drawn_runs(peak_force=force, impulse=ishigami, restitution=lambda u: 0 * u[:, 0])


@pytest.fixture(scope="module")
def found(runs: xr.Dataset) -> xr.Dataset:
    return analysis(runs)


@pytest.fixture
def loaded(
    runs: xr.Dataset, found: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Surrogate:
    """Read where scikit-learn is not installed."""
    dataset = packed(runs, found)
    assert dataset is not None
    write_netcdf(dataset, tmp_path / "surrogate.nc", "surrogate")
    monkeypatch.setitem(sys.modules, "sklearn", None)
    return load_surrogate(tmp_path / "surrogate.nc")


POINT = {"velocity": 9.0, "beam_depth": 0.0271, "beam_yield_stress": 350e6}


def test_predictions_of_the_file_are_those_of_the_fit(
    runs: xr.Dataset, found: xr.Dataset, loaded: Surrogate
) -> None:
    tested = runs.sel(run=found["held_out"].values)
    predicted = loaded.predict(**{name: tested[name].values for name in POINT})
    for name in ("peak_force", "impulse"):
        expected = found["surrogate_held_out"].sel(response=name).values
        np.testing.assert_allclose(predicted[name], expected, rtol=1e-10)
    error = np.abs(predicted["peak_force"].values / tested["peak_force"].values - 1)
    assert error.max() < 1e-4


def test_a_prediction_carries_unit_and_error(loaded: Surrogate) -> None:
    found = loaded.predict(**POINT)
    attrs = found["peak_force"].attrs
    assert found["peak_force"].dims == ()
    assert (attrs["units"], attrs["long_name"]) == ("N", "largest contact force")
    assert attrs["verdict"] == "usable"
    assert 0.999 < attrs["q2"] <= 1
    assert found["velocity"].item() == 9.0


def test_a_prediction_smaller_than_its_error_is_not_usable(
    loaded: Surrogate, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Though the surrogate itself, over its whole range, is."""
    monkeypatch.setenv("COLUMNS", "140")
    at = int(np.flatnonzero(loaded.dataset["response"] == "peak_force")[0])
    whole = loaded.predict(**POINT)["peak_force"].item()
    loaded.dataset["rmse"][at] = 1.4 * whole
    found = loaded.predict(**POINT)
    assert found["peak_force"].attrs["verdict"] == "imprecise"
    print_predictions(found)
    assert "imprecise: the error is 140 % of the prediction" in capsys.readouterr().out
    loaded.dataset["rmse"][at] = 0.09 * whole
    assert loaded.predict(**POINT)["peak_force"].attrs["verdict"] == "usable"


def test_the_error_at_the_ends_of_a_range_is_that_of_the_runs_there(
    runs: xr.Dataset,
    found: xr.Dataset,
    loaded: Surrogate,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It counts from twice the usual one on; the ends of a uniform velocity are counted by hand."""
    tested = runs.sel(run=found["held_out"].values)
    speed, place = tested["velocity"].values, POINT | {"velocity": 14.99}
    missed = found["surrogate_held_out"].sel(response="impulse").values - tested["impulse"].values
    ends = (speed < 5.1) | (speed > 14.9)  # a hundredth of 5 to 15 m/s at either end
    expected = np.sqrt(np.mean(missed[ends] ** 2) / np.mean(missed**2))
    at = dict(response="impulse", parameter="velocity")
    assert loaded.dataset["outer"].sel(at).item() == (
        round(expected, 1) if expected >= 2 else pytest.approx(1.0)
    )
    loaded.dataset["outer"].loc[at] = 4.0
    inside, outer = (loaded.predict(**each)["impulse"].attrs for each in (POINT, place))
    assert (inside["error"], inside["outer"]) == (inside["rmse"], "")
    assert (outer["error"], outer["outer"]) == (4 * outer["rmse"], "velocity")
    monkeypatch.setenv("COLUMNS", "200")
    many = loaded.predict(**POINT | {"velocity": [9.0, 14.99]})["impulse"]
    assert many.attrs["error"] == outer["error"]
    print_predictions(loaded.predict(**place))
    assert "4 times the usual error" in capsys.readouterr().out


def test_no_surrogate_no_number(loaded: Surrogate) -> None:
    found = loaded.predict(**POINT)["restitution"]
    assert np.isnan(found)
    assert found.attrs["verdict"] == "constant"


def test_values_are_broadcast(loaded: Surrogate) -> None:
    speeds = xr.DataArray([6.0, 9.0, 12.0], dims="velocity")
    depths = xr.DataArray([0.0265, 0.0271], dims="depth")
    found = loaded.predict(velocity=speeds, beam_depth=depths, beam_yield_stress=350e6)
    assert found["peak_force"].sizes == {"velocity": 3, "depth": 2}
    one = loaded.predict(**POINT)["peak_force"]
    assert found["peak_force"][1, 1].item() == pytest.approx(one.item(), rel=1e-12)
    listed = loaded.predict(**POINT | {"velocity": [6.0, 9.0]})["peak_force"]
    assert listed.dims == ("point",)
    assert listed[1].item() == pytest.approx(one.item(), rel=1e-12)


def test_many_points_are_those_one_by_one(loaded: Surrogate) -> None:
    speeds = np.linspace(5.0, 15.0, 10_000)
    found = loaded.predict(**POINT | {"velocity": speeds})["peak_force"].values
    for at in (0, 4095, 4096, 9999):
        alone = loaded.predict(**POINT | {"velocity": speeds[at]})["peak_force"].item()
        assert found[at] == pytest.approx(alone, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"velocity": 15.1}, "velocity = 15.1: outside 5.0 to 15.0 .m s-1., where"),
        ({"velocity": [9.0, 4.9, 3.0]}, "velocity = 4.9: outside"),
        ({"beam_depth": np.nan}, "beam_depth = nan: outside 0.026 to 0.029 .m."),
        ({"beam_yield_stress": 600e6}, "beam_yield_stress = 600000000.0: outside"),
        ({"gravity": 9.81}, "gravity: was not varied in study 'synthetic' .it is 9.81 in all"),
        ({"speed": 1.0}, "speed: was not varied in study 'synthetic'; the surrogate takes vel"),
        ({"velocity": "fast"}, "velocity = 'fast': expected numbers in SI"),
        ({"velocity": [[9.0]]}, "velocity: has 2 dimensions"),
    ],
)
def test_what_it_does_not_know_is_refused(loaded: Surrogate, change: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        loaded.predict(**POINT | change)


def test_a_missing_parameter_is_named(loaded: Surrogate) -> None:
    with pytest.raises(ValueError, match=r"^beam_depth, beam_yield_stress: no value is given"):
        loaded.predict(velocity=9.0)


def test_ranges_are_bounds_or_extreme_draws(runs: xr.Dataset, loaded: Surrogate) -> None:
    """A normal has no bounds: beyond its draws nothing is known."""
    ends = loaded.dataset[["lowest", "highest"]].sel(parameter="beam_yield_stress")
    drawn = runs["beam_yield_stress"]
    assert ends["lowest"].item() == drawn.min().item()
    assert ends["highest"].item() == drawn.max().item()
    assert loaded.dataset["lowest"].sel(parameter="velocity").item() == 5.0


def test_units_of_parameters(loaded: Surrogate) -> None:
    assert loaded.units("beam_yield_stress") == "Pa"
    with pytest.raises(ValueError, match="gravity: was not varied"):
        loaded.units("gravity")


def test_files_that_are_none(tmp_path: Path) -> None:
    xr.Dataset({"degree": 1.0}).to_netcdf(tmp_path / "other.nc")
    with pytest.raises(ValueError, match=r"other.nc: has no checksums.*impactlab analyse"):
        load_surrogate(tmp_path / "other.nc")
    (tmp_path / "text.nc").write_text("no netCDF")
    with pytest.raises(OSError, match=r"text.nc: cannot be read as netCDF"):
        load_surrogate(tmp_path / "text.nc")


def test_an_analysis_without_surrogates_keeps_none(runs: xr.Dataset) -> None:
    assert packed(runs, xr.Dataset()) is None
