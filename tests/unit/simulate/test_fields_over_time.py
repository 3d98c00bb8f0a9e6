"""Deflection and plastic strain along the beam while a run lasts."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.variables import FIELDS, PROFILES
from impactlab.verification.cases import discretised

pytestmark = pytest.mark.slow  # kernels for most beam models
GRID = il.Discretisation(nodes=41, points=7)
DURATION = 0.8e-3
PAPER = il.paper_impact(12.0)
IMPACTS = {
    "leapfrog": (PAPER, GRID),
    "modal": (PAPER, replace(GRID, scheme="modal")),
    "corrected": (il.corrected_impact(12.0), GRID),
    "spring_mass": (replace(PAPER, beam_model="spring_mass"), GRID),
}


def simulated(name, **options):
    impact, grid = IMPACTS[name]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", il.TooShortWarning)
        return il.simulate(impact, grid, duration=DURATION, **options)


@pytest.fixture(scope="module", params=IMPACTS)
def case(request):
    """A run with a sample per step, and fields at every few steps."""
    steps = discretised(*IMPACTS[request.param], DURATION)[1]
    return request.param, simulated(request.param, samples=steps + 1, frames=33)


def test_a_run_is_the_same_with_and_without_fields(case):
    name, run = case
    plain = simulated(name, samples=run.sizes["time"])
    assert plain.drop_attrs().identical(run.drop_vars([*FIELDS, "field_time"]).drop_attrs())
    for name, entry in FIELDS.items():
        assert run[name].dims == entry.dims
        assert run[name].attrs["units"] == entry.units


def test_fields_end_with_those_of_the_end_to_the_bit(case):
    _, run = case
    assert run["field_time"].values[[0, -1]].tolist() == [0.0, DURATION]
    for name in PROFILES:
        fields = run[f"{name}_over_time"]
        np.testing.assert_array_equal(fields[-1], run[name])
        assert not fields[0].any()


def test_mid_span_follows_its_history(case):
    name, run = case
    # The profiles of the modal scheme lack the modes that follow the force quasi-statically.
    tolerance = 2e-4 if name == "modal" else 1e-8
    places = np.searchsorted(run["time"], run["field_time"] * (1 - 1e-9))
    np.testing.assert_allclose(run["time"][places], run["field_time"], rtol=1e-9)
    history = run["midspan_deflection"].values[places]
    middle = run["deflection_over_time"].isel(x=run.sizes["x"] // 2)
    largest = np.abs(run["midspan_deflection"]).max().item()
    np.testing.assert_allclose(middle, history, rtol=0.0, atol=tolerance * largest)


def test_equivalent_plastic_strain_never_shrinks(case):
    name, run = case
    strain = run["equivalent_plastic_strain_over_time"]
    growth, largest = strain.diff("field_time"), strain.max().item()
    assert (largest > 1e-4) is (name != "spring_mass")
    assert growth.min().item() >= -1e-8 * largest
    # It grows by as much as the plastic strain of the fibre changes, or by more.
    change = np.abs(run["plastic_strain_over_time"].diff("field_time"))
    assert (growth - change).min().item() >= -1e-8 * largest


def test_nothing_moves_ahead_of_the_wave():
    run = simulated("leapfrog", frames=81)
    early = run["deflection_over_time"].sel(field_time=2e-5, method="nearest")
    middle = run.sizes["x"] // 2
    assert early[middle] > 1e-6
    assert not early[: middle // 2].any()


@pytest.mark.parametrize("frames", [1, -3, 2.5])
def test_a_wrong_number_of_frames_is_refused(frames):
    with pytest.raises(ValueError, match="frames"):
        il.simulate(PAPER, GRID, duration="6 ms", frames=frames)


def test_no_more_frames_than_steps():
    steps = discretised(PAPER, GRID, DURATION)[1]
    assert simulated("leapfrog", frames=10 * steps).sizes["field_time"] == steps + 1
