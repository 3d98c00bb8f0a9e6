"""The time loop: its steps, its samples, and runs that fail."""

import numba
import numpy as np
import pytest

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.solve import fibre_section, solve
from impactlab.solver import outputs
from impactlab.solver.contact.history import make_pair
from impactlab.solver.kernels import WORST_ENERGY_ERROR
from impactlab.solver.stability import discretise, largest_time_step
from impactlab.variables import HISTORIES, PROFILES, RESPONSES

GRID = il.Discretisation(nodes=21, points=5)


def table(duration=1e-3, grid=GRID, **varied):
    return case_table(il.paper_impact(10.0), grid, duration=duration, varied=varied)


def steps_of(case):
    pair, section = make_pair(case), fibre_section(case)
    grid, steps = discretise(case, pair, section)
    critical = largest_time_step(case, pair, section.stiffness, grid.dx)
    return grid, steps, critical


@pytest.mark.parametrize("courant", [0.05, 0.5, 1.0])
def test_time_steps_fill_the_duration_and_obey_the_courant_number(make_case, courant):
    grid, steps, critical = steps_of(make_case(duration=3e-4, courant=courant))
    assert steps * grid.dt == pytest.approx(3e-4, rel=1e-12)
    assert grid.dt <= courant * critical < grid.dt * (steps + 1) / (steps - 1)


def test_samples_are_interpolated_between_the_steps():
    cases = table(duration=2e-4)
    _, steps, _ = steps_of(cases[0])
    every = solve(cases, samples=steps + 1)
    times = np.linspace(0, 2e-4, steps + 1)
    for samples in (2, 7, steps, 2 * steps + 1, 10 * steps):
        some = solve(cases, samples=samples)
        for name in HISTORIES:
            expected = np.interp(np.linspace(0, 2e-4, samples), times, every[name][0])
            assert some[name][0] == pytest.approx(expected, rel=1e-9, abs=1e-15), (name, samples)


def test_a_run_of_one_step_is_free_flight():
    cases = table(duration=1e-12)
    assert steps_of(cases[0])[1] == 1
    answers = solve(cases, samples=2)
    assert answers["sphere_displacement"][0, 1] == pytest.approx(10.0 * 1e-12, rel=1e-9)
    assert answers["status"][0] & outputs.INDENTATION_STILL_GROWING


@pytest.mark.parametrize("courant", [1.1, 1.5, 5.0])
def test_a_run_that_diverges_gives_no_number_anywhere(courant):
    cases = table(grid=il.Discretisation(nodes=101, points=4), contact=["hertz"])
    cases["courant"], cases["beam_yield_stress"] = courant, 200e9  # stays elastic
    answers = solve(cases, samples=50, profiles=True)
    assert answers["status"] == outputs.DIVERGED
    for name in RESPONSES | HISTORIES | PROFILES:
        assert np.isnan(answers[name]).all(), name


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="plain Python warns of overflow")
def test_a_run_that_overflows_between_two_audits_has_diverged():
    """Then the energy error is not a number, and below no limit."""
    cases = table(duration=1e25, contact=["hertz"])
    cases["courant"] = 1e28
    assert 8 < steps_of(cases[0])[1] < 64
    response = solve(cases)
    assert response["status"] == outputs.DIVERGED
    assert np.isnan([response[name] for name in RESPONSES]).all()


def test_a_run_out_of_balance_gives_its_energy_error_and_no_other_answer():
    """A contact that lasts a few steps: stable, but not accurate."""
    cases = table(contact=["hertz"], nodes=[5], courant=[0.9], sphere_mass=[0.05])
    response = solve(cases)
    assert response["status"] == outputs.ENERGY_OUT_OF_BALANCE
    assert WORST_ENERGY_ERROR < response["energy_error"] < 1
    assert [name for name in RESPONSES if not np.isnan(response[name])] == ["energy_error"]


def test_a_failed_run_leaves_the_next_one_alone():
    good, bad = table(), table()
    bad["courant"] = 50.0
    answers, alone = solve(np.concatenate([good, bad, good])), solve(good)
    assert answers["status"][1] == outputs.DIVERGED
    for name, (first, _, last) in answers.items():
        assert first.tobytes() == last.tobytes() == alone[name].tobytes(), name
    assert np.isfinite(answers["peak_force"][0])
