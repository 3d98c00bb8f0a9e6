"""surrogate.nc: what comes back is what was fitted, and refuses what it does not know."""

import sys

import numpy as np
import pytest
import xarray as xr
from known_indices import INDICES

from impactlab.analysis.surrogate import analysis, load_surrogate, packed
from impactlab.analysis.surrogate.chaos import Chaos, orthonormal
from impactlab.files import write_netcdf
from impactlab.methods.distributions import distribution_of
from impactlab.report.console import print_predictions

from .conftest import RANGES

ishigami = INDICES["ishigami"].of_unit


def force(unit):
    return 1e4 * np.exp(unit[:, 0]) * (1 + unit[:, 1]) + 10 * unit[:, 2]


@pytest.fixture(scope="module")
def runs(drawn_runs):
    return drawn_runs(peak_force=force, impulse=ishigami, restitution=lambda u: 0 * u[:, 0])


@pytest.fixture(scope="module")
def found(runs):
    return analysis(runs)


@pytest.fixture
def loaded(runs, found, tmp_path, monkeypatch):
    """Read where scikit-learn is not installed."""
    dataset = packed(runs, found)
    assert dataset is not None
    write_netcdf(dataset, tmp_path / "surrogate.nc", "surrogate")
    monkeypatch.setitem(sys.modules, "sklearn", None)
    return load_surrogate(tmp_path / "surrogate.nc")


POINT = {"velocity": 9.0, "beam_depth": 0.0271, "beam_yield_stress": 350e6}


def test_predictions_of_the_file_are_those_of_the_fit(runs, found, loaded):
    rows = slice(0, 50)
    predicted = loaded.predict(**{name: runs[name].values[rows] for name in POINT})
    inputs = np.column_stack([runs[name].values[rows] for name in POINT])
    kinds = tuple(orthonormal(distribution_of(runs[name].attrs)) for name in POINT)
    for name in ("peak_force", "impulse"):
        coefficients = found["surrogate_coefficient"].sel(response=name).values
        chaos = Chaos(found["surrogate_degree"].values, coefficients, kinds)
        np.testing.assert_allclose(predicted[name], chaos(inputs), rtol=1e-10)
    error = np.abs(predicted["peak_force"].values / runs["peak_force"].values[rows] - 1)
    assert error.max() < 1e-4


def test_a_prediction_carries_unit_and_error(loaded):
    found = loaded.predict(**POINT)
    attrs = found["peak_force"].attrs
    assert found["peak_force"].dims == ()
    assert (attrs["units"], attrs["long_name"]) == ("N", "largest contact force")
    assert attrs["verdict"] == "usable"
    assert 0.999 < attrs["q2"] <= 1
    assert found["velocity"].item() == 9.0
    # no surrogate no number
    found = loaded.predict(**POINT)["restitution"]
    assert np.isnan(found)
    assert found.attrs["verdict"] == "constant"
    # units of parameters
    assert loaded.units("beam_yield_stress") == "Pa"
    with pytest.raises(ValueError, match="gravity: was not varied"):
        loaded.units("gravity")
    # a missing parameter is named
    with pytest.raises(ValueError, match=r"^beam_depth, beam_yield_stress: no value is given"):
        loaded.predict(velocity=9.0)


def test_a_prediction_smaller_than_its_error_is_not_usable(loaded, capsys, monkeypatch):
    """Though the surrogate itself, over its whole range, is."""
    monkeypatch.setenv("COLUMNS", "140")
    at = int(np.flatnonzero(loaded.dataset["response"] == "peak_force")[0])
    whole = loaded.predict(**POINT)["peak_force"].item()
    loaded.dataset["error"][at] *= 1.4 * whole / loaded.predict(**POINT)["peak_force"].error
    found = loaded.predict(**POINT)
    assert found["peak_force"].attrs["verdict"] == "imprecise"
    print_predictions(found)
    assert "imprecise: zero lies within the error" in capsys.readouterr().out
    loaded.dataset["error"][at] *= 0.4 / 1.4
    print_predictions(loaded.predict(**POINT))
    assert "imprecise: the error is 40 % of the prediction" in capsys.readouterr().out
    loaded.dataset["error"][at] *= 0.09 / 0.4
    assert loaded.predict(**POINT)["peak_force"].attrs["verdict"] == "usable"


def test_the_error_grows_outwards_and_beyond_the_runs_it_is_extrapolated(
    loaded, capsys, monkeypatch
):
    monkeypatch.setenv("COLUMNS", "200")
    low, high = (loaded.dataset[name].to_series() for name in ("lowest", "highest"))
    places = [POINT, POINT | {"velocity": 15.0}, dict(high)]
    middle, end, corner = (loaded.predict(**place)["impulse"].attrs for place in places)
    assert middle["error"] < end["error"] < corner["error"]
    assert end["verdict"] != "extrapolated" == corner["verdict"]
    many = loaded.predict(**POINT | {"velocity": [9.0, 15.0]})["impulse"]
    assert many.attrs["error"] == pytest.approx(end["error"], rel=1e-12)
    print_predictions(loaded.predict(**dict(low)))
    assert "extrapolated: farther out than any run tested on" in capsys.readouterr().out


def test_a_file_with_the_polynomials_of_an_earlier_version_is_refused(
    runs, found, loaded, tmp_path
):
    old = loaded.dataset.drop_attrs(deep=False).assign_attrs(study="synthetic")
    write_netcdf(old, tmp_path / "old.nc", "surrogate")
    with pytest.raises(ValueError, match=r"old.nc: its surrogates .* earlier version.*analyse"):
        load_surrogate(tmp_path / "old.nc")
    with pytest.raises(ValueError, match=r"the analysis: its surrogates .* earlier version"):
        packed(runs, found.drop_vars("surrogate_error"))


def test_values_are_broadcast(loaded):
    speeds = xr.DataArray([6.0, 9.0, 12.0], dims="velocity")
    depths = xr.DataArray([0.0265, 0.0271], dims="depth")
    found = loaded.predict(velocity=speeds, beam_depth=depths, beam_yield_stress=350e6)
    assert found["peak_force"].sizes == {"velocity": 3, "depth": 2}
    one = loaded.predict(**POINT)["peak_force"]
    assert found["peak_force"][1, 1].item() == pytest.approx(one.item(), rel=1e-12)
    listed = loaded.predict(**POINT | {"velocity": [6.0, 9.0]})["peak_force"]
    assert listed.dims == ("point",)
    assert listed[1].item() == pytest.approx(one.item(), rel=1e-12)
    # many points are those one by one
    speeds = np.linspace(5.0, 15.0, 10_000)
    found = loaded.predict(**POINT | {"velocity": speeds})["peak_force"].values
    for at in (0, 4095, 4096, 9999):
        alone = loaded.predict(**POINT | {"velocity": speeds[at]})["peak_force"].item()
        assert found[at] == pytest.approx(alone, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"velocity": 15.1}, "velocity: 15.1 m/s is outside 5 m/s to 15 m/s, where"),
        ({"velocity": [9.0, 4.9, 3.0]}, "velocity: 4.9 m/s is outside"),
        ({"beam_depth": np.nan}, "beam_depth: nan m is outside 26 mm to 29 mm"),
        ({"beam_yield_stress": 600e6}, "beam_yield_stress: 600 MPa is outside"),
        ({"gravity": 9.81}, "gravity: was not varied in study 'synthetic' .it is 9.81 in all"),
        ({"speed": 1.0}, "speed: was not varied in study 'synthetic'; the surrogate takes vel"),
        ({"velocity": "fast"}, "velocity = 'fast': expected numbers in SI"),
        ({"velocity": [[9.0]]}, "velocity: has 2 dimensions"),
    ],
)
def test_what_it_does_not_know_is_refused(loaded, change, words):
    with pytest.raises(ValueError, match=words):
        loaded.predict(**POINT | change)


def test_ranges_are_bounds_or_extreme_draws(drawn_runs):
    """A normal has no bounds: beyond its draws nothing is known."""
    normal = {"distribution": "normal", "mean": 345e6, "standard_deviation": 25e6}
    runs = drawn_runs(ranges=RANGES | {"beam_yield_stress": normal}, peak_force=force)
    dataset = packed(runs, analysis(runs))
    assert dataset is not None
    ends = dataset[["lowest", "highest"]].sel(parameter="beam_yield_stress")
    drawn = runs["beam_yield_stress"]
    assert ends["lowest"].item() == drawn.min().item()
    assert ends["highest"].item() == drawn.max().item()
    assert dataset["lowest"].sel(parameter="velocity").item() == 5.0


def test_files_that_are_none(tmp_path):
    xr.Dataset({"degree": 1.0}).to_netcdf(tmp_path / "other.nc")
    with pytest.raises(ValueError, match=r"other.nc: has no checksums.*impactlab analyse"):
        load_surrogate(tmp_path / "other.nc")
    (tmp_path / "text.nc").write_text("no netCDF")
    with pytest.raises(OSError, match=r"text.nc: cannot be read as netCDF"):
        load_surrogate(tmp_path / "text.nc")


def test_an_analysis_without_surrogates_keeps_none(runs):
    assert packed(runs, xr.Dataset()) is None
