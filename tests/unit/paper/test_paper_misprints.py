"""Tests of misprints: the printed forms fail, the right ones pass."""

import pytest

from impactlab.paper.statements import misprints
from impactlab.paper.statements.statement import Ruling

HOLDS, _, FAILS, _ = Ruling


@pytest.mark.parametrize(
    ("statement", "expected"),
    [
        (misprints.time_step, [FAILS, HOLDS]),
        (misprints.moment_sign, [FAILS, HOLDS]),
        (misprints.acceleration_time, [FAILS, FAILS, HOLDS]),
        (misprints.unloading_radius, [FAILS, FAILS, HOLDS]),
        (misprints.elastic_phase, [FAILS, HOLDS]),
        (misprints.fully_plastic, [FAILS, HOLDS]),
        (misprints.beam_mass, [FAILS]),
        (misprints.few_points, [FAILS] * 4),
        (misprints.restitution, [FAILS]),
        (misprints.hertz_indentation, [FAILS] * 2),
        (misprints.sphere_yields, [FAILS]),
    ],
)
def test_verdicts(statement, expected):
    assert [entry.verdict for entry in statement.judge({})] == expected


def test_numbers():
    numbers = {
        (statement.name, n.name): n.value
        for statement in (misprints.few_points, misprints.beam_mass, misprints.time_step)
        for n in next(iter(statement.judge({}))).numbers
    }
    assert numbers["few_points", "stiffness over the exact one"] == pytest.approx(3.0)
    assert numbers["beam_mass", "ρ B H L"] == pytest.approx(10.148, abs=1e-3)
    assert numbers["time_step", "ω dt"] > 20.0


def test_forces_of_the_printed_radii():
    """Unloading over loading force at 65 µm, of Eq. 17, Table 1 and the derived form."""
    found = [entry.numbers[0].value for entry in misprints.unloading_radius.judge({})]
    assert found == pytest.approx([0.064, 0.00069, 1.0], rel=0.01)


def test_a_right_mass_would_pass():
    assert misprints.beam_mass.judge_case({}, 10.15).verdict == HOLDS
    assert misprints.beam_mass.judge_case({}, 10.40).verdict == FAILS


def test_one_contact_would_pass(grid_runs):
    for count, verdict in ((1.0, HOLDS), (2.0, FAILS)):
        runs = grid_runs({"velocity": [0.99]}, number_of_contacts=lambda velocity, n=count: n)
        (found,) = misprints.sub_impacts.judge({"fig05": runs.assign_coords(duration=5e-3)})
        assert found.verdict == verdict
