"""The one door to the kernels: what comes out, what is missing, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab.dataset import (
    COORDINATES,
    FAILURES,
    FLAGS,
    HISTORIES,
    PROFILES,
    REMARKS,
    RESPONSES,
    STATUS_FLAGS,
    remarked,
)
from impactlab.kernels import BEAM_MODELS, RULES, SCHEMES
from impactlab.kernels.contact import LAWS
from impactlab.model.parameters import PARAMETERS, flatten, with_values
from impactlab.simulate import case_table, solve

DOOR = import_module("impactlab.simulate")
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


def test_every_variable_has_units_and_a_long_name(run):
    for name in set(run.variables) - {*FLAGS}:
        assert run[name].attrs["units"], name
        assert run[name].attrs["long_name"], name
    assert run.status.attrs["long_name"]
    assert run.status.attrs["flag_meanings"].split() == list(STATUS_FLAGS)
    assert run.remarks.attrs["flag_meanings"].split() == list(REMARKS)
    assert run.status.attrs["flag_masks"].tolist() == list(BITS.values())


def test_coordinates_are_those_of_the_discretisation(run):
    assert run.time.values == pytest.approx(np.linspace(0, DURATION, 101), rel=1e-15)
    assert run.x.values == pytest.approx(np.arange(21) * 0.78 / 20, rel=1e-14)
    # Gauss-Lobatto with 5 points: 0, sqrt(3/7), 1
    positions = np.array([-1, -np.sqrt(3 / 7), 0, np.sqrt(3 / 7), 1])
    assert run.z.values == pytest.approx(0.0139 * positions, rel=1e-12, abs=1e-17)


def test_every_parameter_is_a_coordinate(run):
    expected = flatten(IMPACT, GRID) | {
        "sphere_mass": IMPACT.sphere.total_mass,
        "duration": DURATION,
    }
    names = {*PARAMETERS, "duration"} - {"element_size"}  # of the 3-D model alone
    assert {name: run[name].item() for name in names} == expected
    assert set(run.coords) == {*names, *COORDINATES} - {"run"}


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


@pytest.mark.parametrize("values", [5.0, np.float64(5), np.array(5.0), "hertz", [[1.0, 2.0]]])
def test_what_varies_is_a_list(values):
    with pytest.raises(ValueError, match=r"^varied: velocity = .*: must be a list"):
        il.simulate_many(IMPACT, GRID, duration=DURATION, varied={"velocity": values})


def test_the_lower_side_is_stretched_at_mid_span():
    """z and the deflection point downwards: tension below the axis."""
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


def test_many_runs_are_single_runs_bit_by_bit():
    varied = {
        "velocity": [0.99, 5.0, 20.0, 10.0],
        "contact": ["stronge", "hertz", "stronge", "hertz"],
        "nodes": [11, 21, 31, 41],
        "points": [2, 3, 4, 5],
        "rule": ["lobatto", "layers", "legendre", "lobatto"],
        "beam_isotropic_hardening_modulus": [0.0, 1e9, 0.0, 2e9],
        "scheme": ["leapfrog", "semi_implicit", "semi_implicit", "leapfrog"],
        "sphere_radius": [0.03, 0.035, 0.02, 0.035],
    }
    many = il.simulate_many(IMPACT, GRID, duration=DURATION, varied=varied)
    assert many.sizes == {"run": 4}
    for number in range(4):
        values = {name: column[number] for name, column in varied.items()}
        impact, grid = with_values(IMPACT, GRID, values)
        one = il.simulate(impact, grid, duration=DURATION)
        for name in (*RESPONSES, "status"):
            got = many[name].isel(run=number).values
            assert got.tobytes() == one[name].values.tobytes(), (number, name)


def test_many_runs_carry_labels_units_and_reasons():
    varied = {"velocity": np.array([1.0, 2.0]), "rule": np.array(["layers", "lobatto"])}
    many = il.simulate_many(IMPACT, GRID, duration=DURATION, varied=varied)
    assert set(many.data_vars) == {*RESPONSES, *FLAGS}
    for name in many.data_vars:
        assert many[name].dims == ("run",)
        assert many[name].attrs["long_name"]
    assert many.velocity.values.tolist() == [1.0, 2.0]
    assert many.velocity.attrs["units"] == "m s-1"
    assert many.rule.values.tolist() == ["layers", "lobatto"]
    assert many.run.values.tolist() == [0, 1]
    assert many.run.attrs["long_name"]
    assert many.duration.item() == DURATION


@pytest.mark.parametrize("varied", [{}, {"velocity": []}], ids=["nothing varied", "no runs"])
def test_one_run_and_none(varied):
    many = il.simulate_many(IMPACT, GRID, duration=DURATION, varied=varied)
    assert many.sizes == {"run": 1 - len(varied)}


def test_a_run_in_which_the_contact_law_creates_energy_says_so():
    """Stronge's law at 20 and at 990 mm/s: within and above 2.673 times the yield indentation."""
    run = il.simulate(il.paper_impact(0.02), GRID, duration=4e-3)
    assert run.remarks.item() & REMARKS["contact_created_energy"][0]
    assert run.contact_dissipation < 0
    assert "creates energy" in run.contact_dissipation.attrs["comment"]
    assert "created energy" in remarked(run.remarks.item())[0]
    assert il.simulate(il.paper_impact(0.99), GRID, duration=4e-3).remarks == 0
    assert remarked(0) == []


WHOLE_RUN = {"diverged", "energy_out_of_balance", "stopped"}
"""The last is of the 3-D model alone."""


def flags(run):
    return {name for name, bit in BITS.items() if run.status.item() & bit}


def test_a_response_is_missing_exactly_where_a_flag_says_so():
    """Over durations from before the first peak to long after the rebound."""
    seen = set()
    for contact in ("hertz", "stronge"):
        for duration in np.geomspace(2e-5, 20e-3, 16):
            run = il.simulate(replace(IMPACT, contact=contact), GRID, duration=float(duration))
            seen |= flags(run) or {"none"}
            for name, entry in RESPONSES.items():
                missing = entry.missing in flags(run)
                assert np.isnan(run[name].item()) == missing, (name, duration)
    assert seen == {*FAILURES, "none"} - WHOLE_RUN


def test_flags_come_off_as_the_run_grows_longer():
    impact, grid = il.paper_impact(0.99), il.Discretisation(nodes=41, points=3)
    whole = il.simulate(impact, grid, duration=10e-3)
    assert flags(whole) == set()
    peak, end = whole.time_of_peak_force.item(), whole.contact_duration.item()
    loading = il.simulate(impact, grid, duration=0.7 * peak)
    assert flags(loading) == set(FAILURES) - WHOLE_RUN
    unloading = il.simulate(impact, grid, duration=0.5 * (peak + end))
    assert flags(loading) - flags(unloading) == {"indentation_still_growing"}
    assert unloading.peak_force.item() == pytest.approx(whole.peak_force.item(), rel=1e-2)
    after = il.simulate(impact, grid, duration=1.02 * end)
    assert not {"first_contact_unfinished", "in_contact_at_end"} & flags(after)
    assert after.contact_duration.item() == pytest.approx(end, rel=1e-2)


def diverged(points):
    """A contact so stiff beside so light a sphere that one step overshoots it."""
    values = {"contact": "hertz", "velocity": 10.0, "sphere_mass": 0.05}
    values |= {"nodes": 5, "points": points, "courant": 1.0}
    impact, grid = with_values(il.paper_impact(), il.Discretisation(), values)
    return il.simulate(impact, grid, duration=1e-3)


@pytest.mark.parametrize("points", [4, 5], ids=["", "a fibre on the axis"])
def test_a_diverged_run_gives_no_number(points):
    run = diverged(points)
    assert flags(run) == {"diverged"}
    for name in set(run.data_vars) - {*FLAGS}:
        assert run[name].isnull().all(), name


def test_a_wrong_run_is_named_with_its_field():
    def refused(varied, message):
        for door in (case_table, il.simulate_many):
            with pytest.raises(ValueError, match=message):
                door(IMPACT, GRID, duration=DURATION, varied=varied)

    refused({"velocity": [1.0, 2.0, -3.0]}, r"^run 2: Impact\.velocity = -3\.0: must be above zero")
    refused({"nodes": np.array([11, 20])}, r"^run 1: Discretisation\.nodes = 20: must be odd")
    refused({"beam_depth": [0.02, np.nan]}, r"^run 1: Beam\.depth = nan: must be a finite number")
    refused({"contact": ["hertz", "hooke"]}, r"^run 1: Impact\.contact = 'hooke': must be one of")
    refused({"weight": [1.0]}, r"^run 0: unknown parameter 'weight': choose from velocity")
    filtered = {"scheme": ["leapfrog", "semi_implicit", "semi_implicit"], "nodes": [5, 17, 15]}
    refused(filtered, r"^run 2: Discretisation\.nodes = 15: must be at least 17 with the")
    refused({"velocity": [1.0, 2.0], "nodes": [11]}, r"one value a run.*\{1, 2\}")


RUNS = 40
RANDOM = np.random.default_rng(3)
WORDS = {"contact": LAWS, "beam_model": BEAM_MODELS[:2], "rule": RULES, "scheme": SCHEMES}
COUNTS = {"nodes": (17, 19, 1201), "points": (2, 3, 64)}


def any_values(name):
    """Values that every run may have beside any of the others."""
    if name == "shear_coefficient":
        return RANDOM.uniform(0.7, 1.0, RUNS)
    if choices := WORDS.get(name) or COUNTS.get(name):
        return RANDOM.choice(choices, RUNS)
    value = flatten(IMPACT, GRID).get(name) or {"sphere_mass": 1.4}.get(name, 1e9)
    return value * RANDOM.uniform(0.9, 1.1, RUNS)


@pytest.fixture
def one_by_one(monkeypatch):
    """The case table as it is when each run is made and checked alone."""

    def refuse(values):
        raise ValueError("no columns")

    def table(varied):
        with monkeypatch.context() as without:
            without.setattr(DOOR, "column", refuse)
            return case_table(IMPACT, GRID, duration=DURATION, varied=varied)

    return table


@pytest.mark.parametrize("names", [*((name,) for name in PARAMETERS), tuple(PARAMETERS)])
def test_columns_give_the_table_of_single_runs_bit_by_bit(names, one_by_one, monkeypatch):
    varied = {name: any_values(name) for name in names}
    alone = one_by_one(varied)
    monkeypatch.setattr(DOOR, "_one_by_one", None)
    for form in (np.asarray, list, np.ndarray.tolist, lambda values: values.astype(object)):
        given = {name: form(values) for name, values in varied.items()}
        many = case_table(IMPACT, GRID, duration=DURATION, varied=given)
        assert many.tobytes() == alone.tobytes()
        assert many.dtype == alone.dtype


WRONG = {
    "beam_density": [0, -1.0, np.nan, np.inf, "1", None, True],
    "beam_yield_stress": [210e9, np.nan],
    "beam_poissons_ratio": [-0.1, 0.5, np.nan],
    "beam_isotropic_hardening_modulus": [-1e-9, np.inf],
    "sphere_mass": [0, True],
    "beam_depth": [0.78, 1.0],
    "gravity": [-1.0],
    "contact": ["hooke", "", 0, None],
    "beam_model": ["Rigid", "spring-mass", 1],
    "rule": ["Lobatto"],
    "scheme": ["semi-implicit", "Leapfrog", 1, None],
    "nodes": [3, 20, 21.5, np.nan, "21", None, True],
    "points": [1, 2.5],
    "courant": [0, 1.0001],
}


@pytest.mark.parametrize(
    ("name", "wrong"), [(name, value) for name, values in WRONG.items() for value in values]
)
def test_a_refused_run_is_told_in_the_words_of_the_model(name, wrong):
    right = any_values(name).tolist()[0]
    with pytest.raises(ValueError, match=name.split("_")[-1]) as alone:
        with_values(IMPACT, GRID, {name: wrong})
    with pytest.raises(ValueError, match=r"^run 2: ") as among:
        case_table(IMPACT, GRID, duration=DURATION, varied={name: [right, right, wrong, right]})
    assert str(among.value) == f"run 2: {alone.value}"


@pytest.mark.parametrize(
    ("grid", "varied"),
    [
        ({"scheme": "semi_implicit"}, {"nodes": [17, 1201, 15]}),
        ({"nodes": 15}, {"scheme": ["leapfrog", "leapfrog", "semi_implicit"]}),
    ],
    ids=["nodes", "scheme"],
)
def test_the_run_is_named_that_has_too_few_nodes_for_its_scheme(grid, varied):
    with pytest.raises(
        ValueError, match=r"^run 2: Discretisation\.nodes = 15: must be at least 17 with"
    ):
        case_table(IMPACT, il.Discretisation(**grid), duration=DURATION, varied=varied)


@pytest.mark.parametrize("model", ["timoshenko", "spring_mass", "rigid"])
def test_the_run_is_named_whose_beam_has_no_such_scheme(model):
    varied = {"beam_model": ["elastic", model], "scheme": ["semi_implicit", "semi_implicit"]}
    words = rf"^run 1: Discretisation\.scheme = 'semi_implicit': Impact\.beam_model = '{model}'"
    with pytest.raises(ValueError, match=words):
        case_table(IMPACT, GRID, duration=DURATION, varied=varied)


def test_what_is_no_column_may_still_be_right(one_by_one):
    """A mass that follows from the density in some runs."""
    varied = {"sphere_mass": [None, 2.0], "velocity": [1, 2.0]}
    cases = case_table(IMPACT, GRID, duration=DURATION, varied=varied)
    assert cases["sphere_mass"].tolist() == [IMPACT.sphere.total_mass, 2.0]
    assert cases.tobytes() == one_by_one(varied).tobytes()


@pytest.mark.parametrize("duration", [0.0, -1e-3, np.nan, np.inf, None, "1 ms"])
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


@pytest.mark.parametrize("name", ["nodes", "points", "rule"])
def test_profiles_need_one_grid(name):
    varied = {"nodes": [11, 21], "points": [3, 5], "rule": ["layers", "lobatto"]}
    cases = case_table(IMPACT, GRID, duration=DURATION, varied={name: varied[name]})
    with pytest.raises(ValueError, match="same nodes, points and rule"):
        solve(cases, profiles=True)
    assert np.isfinite(solve(cases).responses["peak_force"]).all()


def test_solve_keeps_only_what_was_asked_for():
    cases = case_table(IMPACT, GRID, duration=DURATION, varied={"velocity": [1.0, 2.0, 3.0]})
    bare = solve(cases)
    assert bare.histories == {}
    assert bare.profiles == {}
    full = solve(cases, samples=7, profiles=True)
    assert full.responses.tobytes() == bare.responses.tobytes()
    assert {values.shape for values in full.histories.values()} == {(3, 7)}
    shapes = {name: values.shape for name, values in full.profiles.items()}
    assert shapes == {
        "equivalent_plastic_strain": (3, 21, 5),
        "plastic_strain": (3, 21, 5),
        "deflection": (3, 21),
    }


def test_the_solid_model_is_solved_elsewhere():
    """Where words become numbers, an unknown one would be the first of them."""
    impact = replace(IMPACT, beam_model="solid")
    with pytest.raises(ValueError, match=r"'solid': .*`impactlab witness`"):
        il.simulate(impact, GRID, duration=1e-4)
    varied = {"beam_model": ["elastic", "solid"]}
    with pytest.raises(ValueError, match=r"'solid': .*`impactlab witness`"):
        il.simulate_many(IMPACT, GRID, duration=1e-4, varied=varied)
