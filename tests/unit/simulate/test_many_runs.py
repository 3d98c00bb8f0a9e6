"""Many runs are many single ones; what is kept of them, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.parameters import with_values
from impactlab.solve import solve
from impactlab.variables import FLAGS, HISTORIES, PROFILES, RESPONSES

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

IMPACT = il.paper_impact(15.0)
GRID = il.Discretisation(nodes=21, points=5)
DURATION = 2e-3


@pytest.mark.parametrize("values", [5.0, np.float64(5), np.array(5.0), "hertz", [[1.0, 2.0]]])
def test_what_varies_is_a_list(values):
    with pytest.raises(ValueError, match=r"^varied: velocity = .*: must be a list"):
        il.simulate_many(IMPACT, GRID, duration=DURATION, varied={"velocity": values})


def test_many_runs_are_single_runs_bit_by_bit():
    varied = {
        "velocity": [0.99, 5.0, 20.0, 10.0],
        "contact": ["stronge", "hertz", "stronge", "hertz"],
        "nodes": [11, 21, 31, 41],
        "points": [2, 3, 4, 5],
        "rule": ["lobatto", "layers", "legendre", "lobatto"],
        "beam_isotropic_hardening_modulus": [0.0, 1e9, 0.0, 2e9],
        "scheme": ["leapfrog", "modal", "modal", "leapfrog"],
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
    # solve keeps only what was asked for
    cases = case_table(IMPACT, GRID, duration=DURATION, varied={"velocity": [1.0, 2.0, 3.0]})
    bare = solve(cases)
    assert bare.keys() == {*RESPONSES, "status", "remarks"}
    full = solve(cases, samples=7, profiles=True)
    assert [full[name].tobytes() for name in bare] == [column.tobytes() for column in bare.values()]
    assert {full[name].shape for name in HISTORIES} == {(3, 7)}
    assert {name: full[name].shape for name in PROFILES} == {
        "equivalent_plastic_strain": (3, 21, 5),
        "plastic_strain": (3, 21, 5),
        "deflection": (3, 21),
    }


@pytest.mark.parametrize("varied", [{}, {"velocity": []}], ids=["nothing varied", "no runs"])
def test_one_run_and_none(varied):
    many = il.simulate_many(IMPACT, GRID, duration=DURATION, varied=varied)
    assert many.sizes == {"run": 1 - len(varied)}


@pytest.mark.parametrize("name", ["nodes", "points", "rule"])
def test_profiles_need_one_grid(name):
    varied = {"nodes": [11, 21], "points": [3, 5], "rule": ["layers", "lobatto"]}
    cases = case_table(IMPACT, GRID, duration=DURATION, varied={name: varied[name]})
    with pytest.raises(ValueError, match="same nodes, points and rule"):
        solve(cases, profiles=True)
    assert np.isfinite(solve(cases)["peak_force"]).all()


def test_the_solid_model_is_solved_elsewhere():
    """An unknown word must not become the first number of its list."""
    impact = replace(IMPACT, beam_model="solid")
    with pytest.raises(ValueError, match=r"'solid': .*`impactlab witness`"):
        il.simulate(impact, GRID, duration=1e-4)
    varied = {"beam_model": ["elastic", "solid"]}
    with pytest.raises(ValueError, match=r"'solid': .*`impactlab witness`"):
        il.simulate_many(IMPACT, GRID, duration=1e-4, varied=varied)


def test_a_product_is_the_pairs_of_every_combination():
    speeds, laws = ["1 m/s", 2.0], ["hertz", "stronge", "mjg"]
    grid = il.simulate_many(
        IMPACT,
        GRID,
        duration="2 ms",
        varied={"velocity": speeds, "contact": laws},
        combine="product",
    )
    assert dict(grid.sizes) == {"velocity": 2, "contact": 3}
    assert grid.velocity.values.tolist() == [1.0, 2.0]
    pairs = {"velocity": [1.0, 1.0, 1.0, 2.0, 2.0, 2.0], "contact": [*laws, *laws]}
    many = il.simulate_many(IMPACT, GRID, duration=DURATION, varied=pairs)
    for name in grid.data_vars:
        assert grid[name].values.tobytes() == many[name].values.tobytes()


@pytest.mark.parametrize("combine", ["paired", "product"])
def test_the_fixed_parameters_stand_beside_the_varied(combine):
    varied = {"velocity": [1.0, 2.0]}
    many = il.simulate_many(IMPACT, GRID, duration=DURATION, varied=varied, combine=combine)
    one = il.simulate(IMPACT, GRID, duration=DURATION)
    fixed = {name for name, each in one.coords.items() if not each.dims} - {"velocity"}
    assert {name for name, each in many.coords.items() if not each.dims} == fixed
    assert all(many[name].item() == one[name].item() for name in fixed)


def test_lists_of_unequal_length_are_refused_with_the_way_out():
    varied = {"velocity": [1.0, 2.0], "nodes": [21]}
    with pytest.raises(
        ValueError, match=r"lengths 2 of velocity, 1 of nodes: .* combine='product'"
    ):
        il.simulate_many(IMPACT, GRID, duration=DURATION, varied=varied)
    with pytest.raises(ValueError, match=r"^combine = 'zip': must be"):
        il.simulate_many(IMPACT, GRID, duration=DURATION, varied=varied, combine="zip")
