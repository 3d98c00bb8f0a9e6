"""The checks of misprints show what is wrong, and pass what is right."""

from __future__ import annotations

import pytest

from impactlab.paper.statements import (
    beam_mass,
    elastic_phase,
    few_points,
    fully_plastic,
    restitution,
    sub_impacts,
    time_step,
    unloading_radius,
)
from impactlab.paper.statements.claim import ClaimFile, Verdict
from impactlab.verification.solutions import explicit_beam

HOLDS, READING, FAILS, UNKNOWN = Verdict


@pytest.mark.parametrize(
    ("file", "expected"),
    [
        (time_step, [FAILS, HOLDS]),
        (unloading_radius, [UNKNOWN, HOLDS, FAILS]),
        (elastic_phase, [FAILS, HOLDS]),
        (fully_plastic, [FAILS, HOLDS]),
        (beam_mass, [FAILS]),
        (few_points, [FAILS] * 4),
        (restitution, [FAILS]),
    ],
)
def test_verdicts(file: ClaimFile, expected: list[Verdict]) -> None:
    assert [entry.verdict for entry in file.judge({})] == expected


def test_the_numbers_of_physics() -> None:
    numbers = {
        (file.SAYS, n.name): n.value
        for file in (few_points, beam_mass, time_step)
        for n in next(iter(file.judge({}))).numbers
    }
    assert numbers[few_points.SAYS, "stiffness over the exact one"] == pytest.approx(3.0)
    assert numbers[beam_mass.SAYS, "ρ B H L"] == pytest.approx(10.148, abs=1e-3)
    assert numbers[time_step.SAYS, "ω dt"] > 20.0


def test_a_right_mass_would_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beam_mass, "PRINTED", 10.15)
    assert [entry.verdict for entry in beam_mass.judge({})] == [HOLDS]


def test_a_stable_rule_would_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(explicit_beam, "bar_wave_step", explicit_beam.bending_step)
    assert [entry.verdict for entry in time_step.judge({})] == [HOLDS, HOLDS]


def test_one_contact_would_pass(grid_runs) -> None:  # type: ignore[no-untyped-def]
    for count, verdict in ((1.0, HOLDS), (2.0, FAILS)):
        runs = grid_runs({"velocity": [0.99]}, number_of_contacts=lambda velocity, n=count: n)
        (found,) = sub_impacts.judge({"fig05": runs.assign_coords(duration=5e-3)})
        assert found.verdict == verdict
