"""Many runs are many single ones; what is kept of them, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.model.parameters import with_values
from impactlab.simulate import case_table, solve
from impactlab.variables import FLAGS, HISTORIES, PROFILES, RESPONSES

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


def test_solve_keeps_only_what_was_asked_for():
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


def test_the_solid_model_is_solved_elsewhere():
    """An unknown word must not become the first number of its list."""
    impact = replace(IMPACT, beam_model="solid")
    with pytest.raises(ValueError, match=r"'solid': .*`impactlab witness`"):
        il.simulate(impact, GRID, duration=1e-4)
    varied = {"beam_model": ["elastic", "solid"]}
    with pytest.raises(ValueError, match=r"'solid': .*`impactlab witness`"):
        il.simulate_many(IMPACT, GRID, duration=1e-4, varied=varied)
