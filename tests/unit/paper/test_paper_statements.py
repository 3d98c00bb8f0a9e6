"""Statements, judged on synthetic runs that confirm or refute them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
import xarray as xr

from impactlab.paper.statements import STATEMENTS, beam, judge_all
from impactlab.paper.statements.statement import Verdict
from impactlab.solver import outputs

Build = Callable[..., xr.Dataset]
HOLDS, READING, FAILS, UNKNOWN = Verdict
GRIDS = [301, 601, 1201]
SPEEDS = [0.99, 5.0, 6.0, 7.0, 10.0, 15.0, 20.0]


def verdicts(judgements: Any) -> list[Verdict]:
    return [entry.verdict for entry in judgements]


def second_order(nodes: Any, share: float) -> Any:
    """Return values with a relative error of `share` at 601 nodes."""
    return 1.0 + share * (600.0 / (nodes - 1.0)) ** 2


@pytest.fixture
def fig08(grid_runs: Build) -> Callable[..., dict[str, xr.Dataset]]:
    def build(power: float = -0.2, lumped: float = 0.9, rise: float = 0.0) -> Any:
        def duration(velocity: Any, contact: Any, beam_model: Any, nodes: Any) -> Any:
            spring = xr.where(beam_model == "spring_mass", lumped, 1.0)
            late = xr.where(velocity > 12.0, 1.0 + rise, 1.0)
            return 1e-4 * velocity**power * spring * late * second_order(nodes, 1e-5)

        axes = {
            "velocity": SPEEDS,
            "contact": ["hertz"],
            "beam_model": ["euler_bernoulli", "spring_mass"],
            "nodes": GRIDS,
        }
        return {"fig08": grid_runs(axes, contact_duration=duration)}

    return build


def test_duration_falls(fig08: Any) -> None:
    assert verdicts(beam.duration_falls.judge(fig08())) == [HOLDS]
    assert verdicts(beam.duration_falls.judge(fig08(power=0.2))) == [FAILS]
    (partly,) = beam.duration_falls.judge(fig08(rise=0.5))
    assert partly.verdict == READING
    assert "up to 10 m/s and rises" in partly.why


def test_a_fall_within_the_uncertainty_does_not_count(fig08: Any) -> None:
    (flat,) = beam.duration_falls.judge(fig08(power=-1e-7))
    assert flat.verdict == FAILS
    assert "does not fall by more than its uncertainty" in flat.why


def test_above_spring_mass(fig08: Any) -> None:
    assert verdicts(beam.above_spring_mass.judge(fig08())) == [HOLDS]
    assert verdicts(beam.above_spring_mass.judge(fig08(lumped=1.1))) == [FAILS]
    data = fig08(lumped=1.1, rise=0.5)
    data["fig08"]["contact_duration"].loc[{"beam_model": "spring_mass"}] /= 1.2
    data["fig08"]["contact_duration"].loc[{"velocity": 20.0, "beam_model": "spring_mass"}] *= 2.0
    (partly,) = beam.above_spring_mass.judge(data)
    assert partly.verdict == READING
    assert partly.why.endswith("not at 20.")


@pytest.fixture
def fig10(grid_runs: Build) -> Callable[..., dict[str, xr.Dataset]]:
    """Strains of 0 up to the velocity `begins`, then growing by `slope` per m/s, at both times."""

    def build(begins: float = 6.0, slope: float = 2e-4, error: float = 1e-3) -> Any:
        def strain(velocity: Any, nodes: Any) -> Any:
            return slope * (velocity - begins).clip(min=0.0) * second_order(nodes, error)

        def dent(velocity: Any, nodes: Any) -> Any:
            return 1e-5 * velocity * second_order(nodes, 1e-4)

        axes = {"velocity": SPEEDS, "nodes": GRIDS}
        late = grid_runs(
            axes,
            remote_plastic_strain=strain,
            peak_plastic_strain=strain,
            permanent_indentation=dent,
        )
        return {"fig10_nodes": late, "fig10_first": late}

    return build


def test_dent_grows(fig10: Any) -> None:
    assert verdicts(beam.dent_grows.judge(fig10())) == [HOLDS]
    data = fig10()
    data["fig10_nodes"]["permanent_indentation"].loc[{"velocity": 7.0}] = 1e-6
    (found,) = beam.dent_grows.judge(data)
    assert found.verdict == FAILS
    assert "6 to 7 m/s" in found.why


def test_a_dent_that_shrinks_in_the_last_step_fails(fig10: Any) -> None:
    data = fig10()
    data["fig10_nodes"]["permanent_indentation"].loc[{"velocity": SPEEDS[-1]}] = 1e-6
    (found,) = beam.dent_grows.judge(data)
    assert found.verdict == FAILS
    assert f"to {SPEEDS[-1]:g} m/s" in found.why


def test_plastic_strain_as_in_the_paper(fig10: Any) -> None:
    data = fig10(begins=6.5, slope=4e-4)
    assert verdicts(beam.elastic_to_5.judge(data)) == [HOLDS, READING]
    assert verdicts(beam.below_limit_at_10.judge(data)) == [HOLDS, READING, READING, READING]
    assert verdicts(beam.above_limit_at_15.judge(data)) == [HOLDS, READING] * 2
    assert verdicts(beam.plasticity_begins.judge(data)) == [HOLDS, READING, READING, READING]


def test_plastic_strain_other_than_in_the_paper(fig10: Any) -> None:
    assert verdicts(beam.elastic_to_5.judge(fig10(begins=3.0))) == [FAILS, FAILS]
    assert verdicts(beam.below_limit_at_10.judge(fig10(slope=1e-3))) == [FAILS] * 4
    assert verdicts(beam.above_limit_at_15.judge(fig10(begins=12.0))) == [FAILS] * 4
    assert verdicts(beam.plasticity_begins.judge(fig10(begins=12.0))) == [FAILS] * 4
    assert verdicts(beam.plasticity_begins.judge(fig10(begins=30.0))) == [UNKNOWN] * 4


def test_a_strain_limit_within_the_uncertainty_cannot_be_judged(fig10: Any) -> None:
    """The strain at 10 m/s on the finest grid is about 0.2 %."""
    data = fig10(begins=6.0, slope=5e-4, error=0.01)
    assert verdicts(beam.below_limit_at_10.judge(data)) == [UNKNOWN] * 4


@pytest.fixture
def fig06(grid_runs: Build) -> Callable[..., dict[str, xr.Dataset]]:
    def build(share: float, bad_points: int = 0) -> Any:
        def answer(velocity: Any, points: Any, nodes: Any) -> Any:
            return velocity * second_order(nodes, share)

        def by_points(velocity: Any, rule: Any, points: Any) -> Any:
            return velocity * xr.where(points <= bad_points, 1.1, 1.0)

        names = (
            "peak_force",
            "contact_duration",
            "maximum_indentation",
            "maximum_deflection",
            "peak_plastic_strain",
            "remote_plastic_strain",
        )
        nodes = {"velocity": [0.99, 15.0], "points": [5, 21], "nodes": [201, 401, 601, 801, 1201]}
        rules = {
            "velocity": [0.99, 15.0],
            "rule": ["lobatto", "legendre"],
            "points": [2, 3, 4, 9, 21],
        }
        return {
            "fig06_nodes": grid_runs(nodes, **dict.fromkeys(names, answer)),
            "fig06_points": grid_runs(rules, **dict.fromkeys(names, by_points)),
        }

    return build


def test_nodes(fig06: Any) -> None:
    assert verdicts(beam.nodes_suffice.judge(fig06(0.006))) == [HOLDS] * 4
    assert verdicts(beam.nodes_suffice.judge(fig06(0.0005))) == [READING] * 4
    assert verdicts(beam.nodes_suffice.judge(fig06(0.02))) == [FAILS] * 4


def test_points(fig06: Any) -> None:
    good = verdicts(beam.points_suffice.judge(fig06(0.0)))
    assert good == [HOLDS] * 4 + [READING] * 12
    assert verdicts(beam.points_suffice.judge(fig06(0.0, bad_points=2))) == (
        [FAILS] * 4 + [READING] * 8 + [FAILS] * 4
    )


def test_one_inaccurate_response_is_enough_to_fail(fig06: Any) -> None:
    data = fig06(0.0005)
    where = {"velocity": 15.0, "points": 21, "nodes": 601}
    data["fig06_nodes"]["contact_duration"].loc[where] *= 1.05
    found = {entry.case: entry for entry in beam.nodes_suffice.judge(data)}
    assert found["15 m/s, force and motion"].verdict == FAILS
    assert "contact duration" in found["15 m/s, force and motion"].why
    assert found["15 m/s, plastic strain (PEEQ)"].verdict == READING


def test_a_failed_run_is_reported_and_not_judged(fig08: Any) -> None:
    data = fig08()
    where = {"velocity": 5.0, "beam_model": "euler_bernoulli", "nodes": 601}
    data["fig08"]["status"].loc[where] = outputs.DIVERGED
    (found,) = beam.duration_falls.judge(data)
    assert found.verdict == UNKNOWN
    assert "at 5 m/s 1 of 3 runs lack it: the run diverged" in found.why


def test_without_studies_only_closed_forms_are_judged() -> None:
    for statement, found in judge_all({}):
        if statement.studies:
            assert set(verdicts(found)) == {UNKNOWN}, statement.name
            assert all("has not been solved" in judgement.why for judgement in found)
            continue
        assert statement.holds, "only misprints are judged by closed forms"
        judged = found[1:] if statement.name == "unloading_radius" else found
        assert UNKNOWN not in verdicts(judged), statement.name


def test_names_are_unique() -> None:
    assert len({statement.name for statement in STATEMENTS}) == len(STATEMENTS)


def test_two_grids_give_no_uncertainty(fig10: Any) -> None:
    data = {name: runs.isel(nodes=slice(2)) for name, runs in fig10().items()}
    assert verdicts(beam.below_limit_at_10.judge(data)) == [UNKNOWN] * 4
