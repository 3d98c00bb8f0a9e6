"""Statements on the 3-D model, judged on synthetic runs that confirm or refute them."""

import numpy as np
import pytest
import xarray as xr

from impactlab.paper.statements import three_d
from impactlab.paper.statements.statement import Ruling

HOLDS, READING, FAILS, UNKNOWN = Ruling
AXES = {
    "velocity": [0.99, 5.0],
    "beam_model": ["euler_bernoulli", "solid"],
    "nodes": [151, 301, 601],
    "element_size": [1e-3, 0.75e-3, 0.5e-3],
}
TIME = np.linspace(0.0, 0.45e-3, 451)


@pytest.fixture
def witness(grid_runs):
    """Beams with values `gap` above those of a 3-D model with a second-order error `error`.

    The force is a half sine of 0.2 ms, the beam's `late` s later.
    """

    def build(gap=0.01, error=1e-4, reach=1.5e-3, late=0.0, meshes=False):
        def value(velocity, beam_model, nodes, element_size):
            solid = velocity * (1.0 + error * (element_size / 0.5e-3) ** 2)
            beam = velocity * (1.0 + gap) * (1.0 + 1e-5 * (600.0 / (nodes - 1.0)) ** 2)
            return xr.where(beam_model == "solid", solid, beam)

        def zone(beam_model, element_size, **others):
            return xr.where(beam_model == "solid", 2.0 * reach, 0.0) + 0.0 * element_size

        def indentation(beam_model, element_size, **others):
            return 1.5e-3**2 / 35e-3 * (1.0 + error * (element_size / 0.5e-3) ** 2)

        runs = grid_runs(
            AXES,
            plastic_zone_length=zone,
            maximum_indentation=indentation,
            remote_plastic_strain=lambda **axes: 0.0,
            **dict.fromkeys(("peak_force", "contact_duration"), value),
        )
        runs["plastic_zone_radius"] = runs["plastic_zone_depth"] = 0.5 * runs["plastic_zone_length"]
        time = xr.DataArray(TIME, {"time": TIME})
        delay = xr.where(runs["beam_model"] == "solid", 0.0, late)
        pushed = np.sin(np.pi * ((time - delay) / 0.2e-3).clip(0.0, 1.0))
        histories = {"contact_force": pushed, "midspan_deflection": time / TIME[-1]}
        histories = {
            name: (runs["peak_force"] * shape).rename(None) for name, shape in histories.items()
        }
        studies = {"witness": runs.assign(histories)}
        return studies | {"witness_mesh": mesh_study(studies)} if meshes else studies

    return build


def mesh_study(data):
    """Return the 3-D runs at the paper's velocity, as a study of meshes has them."""
    runs = data["witness"].drop_dims("time").isel(nodes=0, drop=True)
    return runs.sel(velocity=0.99, beam_model=["solid"])


def verdicts(assessments):
    return [entry.verdict for entry in assessments]


def test_measures_of_the_force_history(witness):
    """L2, shifted, peak and impulse: all differ by the gap; a delay alone by L2."""
    assert verdicts(three_d.force_history.judge(witness())) == [HOLDS] + [READING] * 3
    found = list(three_d.force_history.judge(witness(gap=-0.05)))
    assert verdicts(found) == [FAILS] * 4
    for entry in found:
        assert abs(entry.numbers[-1].value) == pytest.approx(0.05, abs=5e-4)
        assert entry.numbers[-1].uncertainty < 3e-3
    assert "−5 ±" in found[2].why
    late = list(three_d.force_history.judge(witness(gap=0.0, late=9e-6)))
    assert verdicts(late) == [FAILS] + [READING] * 3
    sines = np.pi * 9e-6 / 0.2e-3  # of a delayed sine: the phase, for small delays
    assert late[0].numbers[0].value == pytest.approx(sines, rel=0.02)
    assert late[1].numbers[0].value < 1e-3
    assert "−9 µs" in late[1].numbers[0].name


def test_what_the_uncertainty_encloses_is_compatible(witness):
    found = list(three_d.force_history.judge(witness(gap=0.05, error=0.02)))
    assert verdicts(found)[2] == READING
    assert "compatible" in found[2].why
    assert (
        verdicts(three_d.duration_of_witness.judge(witness(gap=0.01, error=0.02))) == [READING] * 2
    )
    assert verdicts(three_d.duration_of_witness.judge(witness(gap=0.01))) == [FAILS] * 2
    # finer meshes are used at the papers velocity
    data = witness(gap=0.01, error=0.02)
    data["witness_mesh"] = mesh_study(witness(gap=0.01, error=1e-4))
    assert verdicts(three_d.duration_of_witness.judge(data)) == [FAILS, READING]


def test_element_counts_per_radius_replace_element_sizes(witness):
    """The assessments do not depend on whether element sizes or counts are varied."""
    data = witness(gap=0.01, error=1e-3)
    runs = data["witness"].rename(element_size="elements_per_radius")
    sizes = runs["elements_per_radius"].values
    counted = {"witness": runs.assign_coords(elements_per_radius=2e-3 / sizes)}
    judged = three_d.force_history, three_d.deflection_history, three_d.duration_of_witness
    for statement in judged:
        for one, other in zip(statement.judge(data), statement.judge(counted), strict=True):
            assert one.verdict == other.verdict
            for mine, its in zip(one.numbers, other.numbers, strict=True):
                assert mine.value == pytest.approx(its.value)
                assert mine.uncertainty == pytest.approx(its.uncertainty, rel=1e-6)
    zone = next(iter(three_d.plastic_zone_extent.judge(counted)))
    assert zone.verdict == UNKNOWN
    assert "witness_mesh has not been solved" in zone.why


def test_the_deflection(witness):
    for gap, expected in ((0.0, [READING] * 2), (0.02, [FAILS, READING]), (0.06, [FAILS] * 2)):
        assert verdicts(three_d.deflection_history.judge(witness(gap=gap))) == expected
    bare = {"witness": witness()["witness"].drop_vars("midspan_deflection")}
    assert verdicts(three_d.deflection_history.judge(bare)) == [UNKNOWN] * 2


def test_the_plastic_zone(witness):
    for reach, expected in ((1.5e-3, READING), (2.5e-3, FAILS)):
        found = list(three_d.plastic_zone_extent.judge(witness(reach=reach, meshes=True)))
        assert verdicts(found[:3]) == [expected] * 3
        assert found[0].numbers[0].value == pytest.approx(reach)
        assert found[0].numbers[0].uncertainty == pytest.approx(0.5e-3)  # an element
        assert found[3].verdict == FAILS  # sqrt(R delta) is 1.500 mm, known within 0.1 %
        assert found[3].numbers[0].value == pytest.approx(1.5e-3, rel=1e-3)


def test_the_place_of_the_plastic_zone(witness):
    """The contact's radius is 1.5 or 2.1 mm; the zone's edge is known within an element."""
    place = three_d.plastic_zone_place
    assert verdicts(place.judge(witness(meshes=True))) == [READING] * 3
    assert verdicts(place.judge(witness(reach=2.3e-3, meshes=True))) == [FAILS, READING, READING]
    data = witness(reach=3e-3, meshes=True)
    data["witness"]["remote_plastic_strain"] += 1e-5
    assert verdicts(place.judge(data)) == [FAILS] * 3


def test_a_missing_study_or_run_is_reported(witness):
    for statement in (three_d.force_history, three_d.duration_of_witness):
        assert {*verdicts(statement.judge({}))} == {UNKNOWN}
    data = witness(gap=0.0)
    data["witness"]["contact_duration"].loc[{"velocity": 5.0, "beam_model": "solid"}] = np.nan
    data["witness"]["status"].loc[{"velocity": 5.0, "beam_model": "solid"}] = 256
    found = list(three_d.duration_of_witness.judge(data))
    assert verdicts(found) == [READING, UNKNOWN]
    assert "the 3-D model stopped before its time" in found[-1].why
    one = {"witness": witness()["witness"].isel(element_size=[0])}
    assert {*verdicts(three_d.force_history.judge(one))} == {UNKNOWN}
