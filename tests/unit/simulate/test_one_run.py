"""One run: what comes out, and what is refused."""

import warnings
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab.fem3d.wing import SIZES
from impactlab.model.parameters import PARAMETERS, SECTION, flatten
from impactlab.solver import RULES
from impactlab.variables import (
    COORDINATES,
    FLAGS,
    HISTORIES,
    PROFILES,
    RESPONSES,
    STATUS_FLAGS,
    WARNINGS,
)

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

IMPACT = il.paper_impact(15.0)
GRID = il.Discretisation(nodes=21, points=5)
DURATION = 2e-3
BITS = {name: bit for name, (bit, _) in STATUS_FLAGS.items()}


@pytest.fixture(scope="module")
def run():
    """A run in which the beam yields."""
    return il.simulate(IMPACT, GRID, duration=DURATION, samples=101)


def test_every_variable_is_there_on_its_dimensions(run):
    for name, entry in (RESPONSES | HISTORIES | PROFILES).items():
        assert run[name].dims == entry.dims, name
        assert run[name].dtype == np.float64, name
    assert set(run.data_vars) == {*RESPONSES, *HISTORIES, *PROFILES, *FLAGS}
    assert run.status.dtype == np.int32
    assert run.status.dims == ()
    # every variable has units and a long name
    for name in set(run.variables) - {*FLAGS}:
        assert run[name].attrs["units"], name
        assert run[name].attrs["long_name"], name
    assert run.status.attrs["long_name"]
    assert run.status.attrs["flag_meanings"].split() == list(STATUS_FLAGS)
    assert run.remarks.attrs["flag_meanings"].split() == list(WARNINGS)
    assert run.status.attrs["flag_masks"].tolist() == list(BITS.values())
    # coordinates are those of the discretisation
    assert run.time.values == pytest.approx(np.linspace(0, DURATION, 101), rel=1e-15)
    assert run.x.values == pytest.approx(np.arange(21) * 0.78 / 20, rel=1e-14)
    # Gauss-Lobatto with 5 points: 0, sqrt(3/7), 1
    positions = np.array([-1, -np.sqrt(3 / 7), 0, np.sqrt(3 / 7), 1])
    assert run.z.values == pytest.approx(0.0139 * positions, rel=1e-12, abs=1e-17)
    # every parameter is a coordinate
    expected = flatten(IMPACT, GRID) | {
        "sphere_mass": IMPACT.sphere.total_mass,
        "shear_coefficient": 5 / 6,
        "duration": DURATION,
    }
    names = {*PARAMETERS, "duration"} - {*SIZES}  # of the 3-D model alone
    names -= {*SECTION, "strike_interval", "further_spheres"} - {"beam_shape"}
    assert {name: run[name].item() for name in names} == expected
    assert set(run.coords) == {*names, *COORDINATES} - {"run", "field_time", "strike", "sphere"}


def test_default_discretisation():
    run = il.simulate(il.paper_impact(), duration=1e-5, samples=2)
    assert run.sizes == {"time": 2, "x": 201, "z": 9}
    assert run.courant == il.Discretisation().courant
    assert il.simulate(il.paper_impact(), GRID, duration=1e-5).sizes["time"] == 2001


def test_histories_fit_together(run):
    approach = run.sphere_displacement - run.midspan_deflection
    xr.testing.assert_allclose(run.indentation, approach, rtol=1e-12, atol=1e-18)
    assert run.midspan_deflection[-1] == run.deflection[10]
    assert (run.contact_force >= 0).all()
    assert run.contact_force.max() <= run.peak_force
    first = run.isel(time=1)
    assert first.sphere_displacement.item() == pytest.approx(15.0 * first.time.item(), rel=1e-2)


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("points", [4, 5])
def test_profiles_mirror_about_mid_span_and_strains_about_the_axis(rule, points):
    grid = replace(GRID, rule=rule, points=points)
    run = il.simulate(IMPACT, grid, duration=DURATION, samples=2)
    assert run.peak_plastic_strain > 0
    for name in PROFILES:
        values = run[name].values
        assert np.array_equal(values, values[::-1]), name
    strain, peeq = run.plastic_strain.values, run.equivalent_plastic_strain.values
    assert np.array_equal(strain, -strain[:, ::-1])
    assert np.array_equal(peeq, peeq[:, ::-1])
    assert np.all(peeq >= np.abs(strain))
    assert peeq.max() == run.peak_plastic_strain
    assert run.deflection[0] == run.deflection[-1] == 0


def test_an_elastic_beam_has_no_negative_zeros():
    run = il.simulate(il.paper_impact(0.1), GRID, duration=DURATION, samples=2)
    assert not np.signbit(run.plastic_strain.values).any()
    assert (run.plastic_strain == 0).all()
    # z and the deflection point downwards: tension below the axis.
    strain = il.simulate(IMPACT, GRID, duration=DURATION).plastic_strain
    assert strain.isel(x=10, z=-1) > 0
    assert strain.isel(x=10, z=0) < 0


def test_answers_do_not_depend_on_the_samples(run):
    for samples in (2, 21, 2001):
        other = il.simulate(IMPACT, GRID, duration=DURATION, samples=samples)
        for name in (*RESPONSES, *PROFILES, "status"):
            assert other[name].values.tobytes() == run[name].values.tobytes(), name
    coarse = il.simulate(IMPACT, GRID, duration=DURATION, samples=21)
    for name in HISTORIES:
        assert coarse[name].values == pytest.approx(run[name].values[::5], rel=1e-9, abs=1e-15)


def test_a_run_takes_nothing_from_runs_before():
    grid = il.Discretisation(nodes=21)

    def solved(velocity, contact="hertz", span=0.78):
        paper = il.paper_impact(velocity, contact)
        return il.simulate(replace(paper, beam=replace(paper.beam, span=span)), grid, duration=0.01)

    alone = solved(1.0)
    kept = alone.copy(deep=True)
    with pytest.raises(ValueError, match="read-only"):
        alone.time.values[1] = 7.0
    alone.contact_force.values[:] = 0.0
    alone.velocity.attrs["units"] = "furlong"
    alone["x"] = 2.0 * alone.x
    others = solved(2.0), solved(1.0, "stronge"), solved(1.0, span=0.8)
    assert [float(run.velocity) for run in others] == [2.0, 1.0, 1.0]
    assert [float(run.x[-1]) for run in others] == [0.78, 0.78, 0.8]
    assert kept.contact.attrs["source"] != others[1].contact.attrs["source"]
    xr.testing.assert_identical(solved(1.0).drop_attrs(), kept.drop_attrs())
    assert solved(1.0).velocity.attrs == kept.velocity.attrs


@pytest.mark.parametrize("duration", [0.0, -1e-3, np.nan, np.inf, None, "1 m"])
def test_a_wrong_duration_is_refused(duration):
    with pytest.raises(ValueError, match=r"^simulate\.duration = "):
        il.simulate(IMPACT, GRID, duration=duration)
    with pytest.raises(ValueError, match=r"^simulate\.duration = "):
        il.simulate_many(IMPACT, GRID, duration=duration, varied={"velocity": [1.0]})


@pytest.mark.parametrize("samples", [1, 0, -5, 2.5, None, "9"])
def test_a_wrong_number_of_samples_is_refused(samples):
    with pytest.raises(ValueError, match=r"^simulate\.samples = "):
        il.simulate(IMPACT, GRID, duration=DURATION, samples=samples)


@pytest.mark.parametrize("count", ["nodes", "points", "samples"])
def test_whole_floats_count(run, count):
    counts = {"nodes": 21, "points": 5, "samples": 101}
    counts[count] = float(counts[count])
    grid = replace(GRID, nodes=counts["nodes"], points=counts["points"])
    other = il.simulate(IMPACT, grid, duration=DURATION, samples=counts["samples"])
    assert np.array_equal(other.deflection, run.deflection)


SOLID = {
    0.99: ("0.28 ms", 11459.0, 0.21380e-3, 69.70e-6, 40.58e-6, 1.3780),
    5.0: ("0.21 ms", 66034.0, 0.16539e-3, 286.0e-6, 218.0e-6, 5.9998),
    10.0: ("0.19 ms", 135616.0, 0.15179e-3, 533.7e-6, 442.2e-6, 11.241),
}
"""Of 3-D finite elements, means of several meshes (docs/agreement.md), by velocity in m/s: duration
of the run, peak force (N), contact duration (s), largest and permanent indentation (m), impulse."""
COMPARED = (
    *("peak_force", "contact_duration", "maximum_indentation", "permanent_indentation"),
    "impulse",
)


@pytest.mark.long  # a kernel of its own is compiled
@pytest.mark.parametrize(("velocity", "solid"), SOLID.items())
def test_the_corrected_impact_is_within_2_percent_of_3d(velocity, solid):
    duration, *expected = solid
    corrected, plain = (
        il.simulate(make(velocity), il.Discretisation(nodes=201), duration=duration)
        for make in (il.corrected_impact, il.paper_impact)
    )
    apart = [corrected[name].item() / at - 1.0 for name, at in zip(COMPARED, expected, strict=True)]
    assert np.abs(apart).max() < 0.02
    papers = [plain[name].item() / at - 1.0 for name, at in zip(COMPARED, expected, strict=True)]
    assert np.abs(papers).max() > 0.07


@pytest.mark.parametrize(
    ("velocity", "model", "duration", "missing"),
    [
        (0.99, "euler_bernoulli", "50 us", "peak_force, time_of_peak_force, contact_duration"),
        (0.99, "timoshenko", "1 ms", "rebound_velocity, restitution"),
        (15.0, "euler_bernoulli", "1 ms", "maximum_deflection"),
        (15.0, "rigid", "0.1 ms", "contact_duration"),
        (60.0, "euler_bernoulli", "3 ms", "maximum_deflection"),
    ],
)
def test_a_short_duration_names_what_is_missing_and_lasts_as_it_says(
    velocity, model, duration, missing
):
    impact = replace(il.paper_impact(velocity), beam_model=model)
    grid = il.Discretisation(nodes=31)
    with pytest.warns(il.TooShortWarning, match=f"too short for .*{missing}") as caught:
        il.simulate(impact, grid, duration=duration, samples=2)
    lasting = str(caught[0].message).partition("take about ")[2]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert il.simulate(impact, grid, duration=lasting, samples=2).status == 0


def test_no_duration_is_promised_where_a_long_one_gave_no_rebound():
    with pytest.warns(il.TooShortWarning, match=r"restitution: try a longer one;"):
        il.simulate(il.paper_impact(0.3), il.Discretisation(nodes=41), duration="60 ms", samples=2)
    # many short runs give one warning
    impact = replace(il.paper_impact(), beam_model="rigid")
    words = r"too short for contact_duration.* in 1 of 2 runs: take about 1\.8 ms"
    with pytest.warns(il.TooShortWarning, match=words) as caught:
        il.simulate_many(impact, duration="0.4 ms", varied={"velocity": [0.01, 5.0]})
    assert len(caught) == 1


@pytest.mark.parametrize("duration", [2, 0.5, "2", "2."])
def test_seconds_without_a_unit_are_refused_as_in_studies(duration):
    sampling = il.Grid(parameters={"velocity": [1, 2]})
    reason = "is in seconds without a unit, and impacts last milliseconds"
    with pytest.raises(ValueError, match=reason):
        il.simulate(il.paper_impact(), duration=duration)
    with pytest.raises(ValueError, match=reason):
        il.simulate_many(il.paper_impact(), duration=duration, varied={"velocity": [1.0]})
    with pytest.raises(ValueError, match=reason):
        il.Study(title="Seconds", duration=duration, sampling=sampling)


def test_an_impossible_value_is_refused_as_in_studies():
    with pytest.raises(ValueError, match="velocity: "):
        il.simulate(il.paper_impact(1e-10), il.Discretisation(nodes=11), duration="1 ms")


def test_swapped_arguments_are_named():
    impact, grid = il.paper_impact(), il.Discretisation(nodes=11)
    for solve in (il.simulate, partial(il.simulate_many, varied={})):
        with pytest.raises(ValueError, match="impact and discretisation are swapped"):
            solve(grid, impact, duration="1 ms")
        with pytest.raises(ValueError, match="give the impact first"):
            solve(grid, duration="1 ms")
        with pytest.raises(ValueError, match=r"simulate\.impact = '5 m/s': must be an Impact"):
            solve("5 m/s", duration="1 ms")
