"""Statements on the 3-D model, judged on synthetic runs that confirm or refute them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr

from impactlab.paper.statements import three_d
from impactlab.paper.statements.statement import Verdict

HOLDS, READING, FAILS, UNKNOWN = Verdict
AXES = {
    "velocity": [0.99, 5.0],
    "beam_model": ["euler_bernoulli", "timoshenko", "solid"],
    "nodes": [151, 301, 601],
    "element_size": [1e-3, 0.75e-3, 0.5e-3],
}
BEAM_AND_SOLID = (
    three_d.force_of_witness,
    three_d.duration_of_witness,
    three_d.displacement_of_witness,
)


@pytest.fixture
def witness(grid_runs: Callable[..., xr.Dataset]) -> Callable[..., dict[str, xr.Dataset]]:
    """Beams with values `gap` above those of a 3-D model with a second-order error `error`."""

    def build(gap: float = 0.01, error: float = 1e-4, reach: float = 1.5e-3) -> Any:
        def value(velocity: Any, beam_model: Any, nodes: Any, element_size: Any) -> Any:
            solid = velocity * (1.0 + error * (element_size / 0.5e-3) ** 2)
            beam = velocity * (1.0 + gap) * (1.0 + 1e-5 * (600.0 / (nodes - 1.0)) ** 2)
            return xr.where(beam_model == "solid", solid, beam)

        def zone(beam_model: Any, element_size: Any, **others: Any) -> Any:
            return xr.where(beam_model == "solid", 2.0 * reach, 0.0) + 0.0 * element_size

        names = ("peak_force", "contact_duration")
        runs = grid_runs(AXES, plastic_zone_length=zone, **dict.fromkeys(names, value))
        runs["plastic_zone_radius"] = 0.5 * runs["plastic_zone_length"]
        ramp = xr.DataArray(np.linspace(0.0, 1.0, 5), dims="time")
        history = (runs["peak_force"] * ramp).rename(None)
        return {"witness": runs.assign(midspan_deflection=history, sphere_displacement=history)}

    return build


def verdicts(judgements: Any) -> list[Verdict]:
    return [entry.verdict for entry in judgements]


def test_the_peak_force_within_the_limit(witness: Any) -> None:
    found = list(three_d.force_of_witness.judge(witness()))
    assert verdicts(found) == [HOLDS, READING, READING, READING]
    beam, solid, gap = found[0].numbers
    assert beam.value == pytest.approx(0.99 * 1.01, rel=1e-4)
    assert solid.value == pytest.approx(0.99, rel=2e-4)
    assert gap.value == pytest.approx(0.01, abs=2e-4)
    assert 1e-4 < gap.uncertainty < 5e-4
    assert verdicts(three_d.force_of_witness.judge(witness(gap=-0.03))) == [FAILS] * 4


def test_a_limit_within_the_uncertainty_cannot_be_judged(witness: Any) -> None:
    assert verdicts(three_d.force_of_witness.judge(witness(gap=0.01, error=0.02))) == [UNKNOWN] * 4
    assert (
        verdicts(three_d.duration_of_witness.judge(witness(gap=0.05, error=0.01))) == [UNKNOWN] * 4
    )


def test_finer_meshes_are_used_at_the_papers_velocity(witness: Any) -> None:
    data = witness(gap=0.01, error=0.02)
    finer = witness(gap=0.01, error=1e-4)["witness"].isel(nodes=0).sel(velocity=0.99)
    data["witness_mesh"] = finer.sel(beam_model=["solid"])
    coarse = [UNKNOWN, UNKNOWN]
    assert verdicts(three_d.force_of_witness.judge(data)) == [HOLDS, READING, *coarse]


def test_element_counts_per_radius_replace_element_sizes(witness: Any) -> None:
    """The judgements do not depend on whether element sizes or counts are varied."""
    data = witness(gap=0.01, error=1e-3)
    runs = data["witness"].rename(element_size="elements_per_radius")
    sizes = runs["elements_per_radius"].values
    counted = {"witness": runs.assign_coords(elements_per_radius=2e-3 / sizes)}
    for statement in BEAM_AND_SOLID:
        for one, other in zip(statement.judge(data), statement.judge(counted), strict=True):
            assert one.verdict == other.verdict
            for mine, its in zip(one.numbers, other.numbers, strict=True):
                assert mine.value == pytest.approx(its.value)
                assert mine.uncertainty == pytest.approx(its.uncertainty, rel=1e-6)
    (zone, _) = three_d.plastic_zone_of_witness.judge(counted)
    assert zone.verdict == UNKNOWN
    assert "witness_mesh has not been solved" in zone.why


def test_the_contact_duration(witness: Any) -> None:
    assert verdicts(three_d.duration_of_witness.judge(witness(gap=0.03))) == [READING] * 4
    assert verdicts(three_d.duration_of_witness.judge(witness(gap=0.08))) == [FAILS] * 4


def test_the_displacements(witness: Any) -> None:
    found = list(three_d.displacement_of_witness.judge(witness(gap=0.06)))
    assert verdicts(found) == [READING] * 4
    assert found[0].numbers[0].value == pytest.approx(0.06, abs=1e-3)
    assert "displacement, more than the uncertainty" in found[0].why
    assert verdicts(three_d.displacement_of_witness.judge(witness(gap=0.2))) == [FAILS] * 4
    bare = {"witness": witness()["witness"].drop_vars("midspan_deflection")}
    assert verdicts(three_d.displacement_of_witness.judge(bare)) == [UNKNOWN] * 2 + [READING] * 2


def test_the_plastic_zone(witness: Any) -> None:
    for found in three_d.plastic_zone_of_witness.judge(witness()):
        assert found.verdict == READING
        assert found.numbers[0].value == pytest.approx(1.5e-3)
        assert found.numbers[0].uncertainty == pytest.approx(0.5e-3)  # an element
    assert verdicts(three_d.plastic_zone_of_witness.judge(witness(reach=2.5e-3))) == [FAILS] * 2


def test_a_missing_study_or_run_is_reported(witness: Any) -> None:
    for statement in BEAM_AND_SOLID:
        assert {*verdicts(statement.judge({}))} == {UNKNOWN}
    data = witness()
    data["witness"]["peak_force"].loc[{"velocity": 5.0, "beam_model": "solid"}] = np.nan
    data["witness"]["status"].loc[{"velocity": 5.0, "beam_model": "solid"}] = 256
    found = list(three_d.force_of_witness.judge(data))
    assert verdicts(found) == [HOLDS, READING, UNKNOWN, UNKNOWN]
    assert "the 3-D model stopped before its time" in found[-1].why
    two = {"witness": witness()["witness"].isel(element_size=[0], nodes=slice(None))}
    assert UNKNOWN in verdicts(three_d.force_of_witness.judge(two))
