"""The first runs of a sample are solved on other grids, and tell what a full finer study gives."""

from functools import partial

import numpy as np
import pytest

from impactlab.analysis.analyse import analyse
from impactlab.study.adaptive.extension import base_samples, refine_cases
from impactlab.study.design import design
from impactlab.study.engine import Engine
from impactlab.study.execute import execute
from impactlab.study.schema.readers import study_of_text

STUDY = """
title: Elastic impacts on a coarse grid
impact: {base: paper, beam_model: elastic}
discretisation: {nodes: NODES, points: 5}
duration: 2 ms
responses: [peak_force, impulse, permanent_indentation, contact_duration, maximum_deflection]
sampling:
  method: sobol
  base_samples: 256
  second_order: false
  parameters:
    velocity: {distribution: uniform, low: 1 m/s, high: 3 m/s}
    beam_depth: {distribution: uniform, low: 20 mm, high: 32 mm}
    sphere_radius: {distribution: uniform, low: 25 mm, high: 40 mm}
store: {histories: true, samples: 20}
"""
SMOOTH = ["peak_force", "impulse", "permanent_indentation"]
ORDERS = ("first_order", "total_order")


def text(nodes):
    return STUDY.replace("NODES", str(nodes))


@pytest.fixture(scope="module")
def solve(tmp_path_factory):
    return partial(
        execute, shards_folder=tmp_path_factory.mktemp("shards"), engine=Engine(workers=2)
    )


@pytest.fixture(scope="module")
def study(solve):
    """Runs and analysis of as many nodes, solved in full."""
    known = {}

    def of(nodes):
        if nodes not in known:
            runs = solve(design(study_of_text("some", text(nodes))))
            known[nodes] = runs, analyse(runs.assign_attrs(analyses="sensitivity"))
        return known[nodes]

    return of


@pytest.mark.slow
@pytest.mark.parametrize(("nodes", "finest"), [(21, 81), (41, 161)])
def test_a_full_study_on_finer_grids_is_within_the_uncertainty(study, solve, nodes, finest):
    runs, analysis = study(nodes)
    found = analyse(runs.assign_attrs(analyses="sensitivity"), None, refine_cases(runs, solve))
    for order in ORDERS:
        away = abs(study(finest)[1][order] - analysis[order])
        bound = found[f"{order}_numerical"]
        assert bound.sel(response=SMOOTH).max() < 0.2
        assert (away <= bound).sel(response=SMOOTH).all()
        change = (study(2 * nodes - 1)[1][order] - analysis[order]).sel(response=SMOOTH)
        told = found.sel(response=SMOOTH)
        missed = abs(change - told[f"{order}_change"])
        assert (missed <= 1.5 * told[f"{order}_change_interval"]).all()


def test_a_response_that_a_refinement_cannot_tell_of_is_said_to_be_open(study, solve):
    """The contact duration jumps, in few runs; the deflection still grows when the runs end."""
    runs, _ = study(41)
    found = analyse(runs.assign_attrs(analyses="sensitivity"), None, refine_cases(runs, solve))
    names = ["measured", "bound", "nothing"]
    assert found["numerical_from"].attrs["flag_meanings"].split() == names
    told = {str(entry["response"].values): names[int(entry)] for entry in found["numerical_from"]}
    assert told == dict.fromkeys(SMOOTH, "measured") | dict.fromkeys(
        ["contact_duration", "maximum_deflection"], "nothing"
    )
    assert found["total_order_numerical"].sel(response="maximum_deflection").isnull().all()
    index, bound = (
        found[name].sel(response="contact_duration")
        for name in ("total_order", "total_order_numerical")
    )
    np.testing.assert_array_equal(bound, np.maximum(index, 1 - index))


def test_the_grids_and_that_the_first_runs_are_the_same(study, solve):
    runs, _ = study(41)
    found = refine_cases(runs, solve)
    pairs = zip(found["nodes"].values, found["points"].values, strict=True)
    grids = dict(zip(found["grid"].values, pairs, strict=True))
    assert grids == {"used": (41, 5), "finer": (81, 5), "more_points": (41, 9)}
    assert found.attrs["base_samples"] == 32
    assert list(np.atleast_1d(found.attrs["varied"])) == list(runs.attrs["varied"])
    used = found.sel(grid="used")
    first = runs.isel(run=slice(32 * 5))
    for name in ("velocity", "peak_force", "status"):
        np.testing.assert_array_equal(used[name], first[name])
    finer = study(81)[0].isel(run=slice(32 * 5))
    np.testing.assert_array_equal(found["impulse"].sel(grid="finer"), finer["impulse"])


@pytest.mark.parametrize(
    ("nodes", "coarser"), [(45, None), (49, 25), (51, 25), (75, 37), (101, 51), (151, 77)]
)
def test_a_coarser_grid_has_a_middle_and_nodes_enough(nodes, coarser):
    def nothing(asked):
        grids.update(zip(asked["grid"].values, asked["nodes"].values, strict=True))
        return asked

    grids = {}
    refine_cases(design(study_of_text("some", text(nodes))), nothing)
    assert grids.get("coarser") == coarser
    assert grids["finer"] - 1 == 2 * (nodes - 1)


def test_of_the_second_order_only_what_the_first_and_total_need():
    asked = text(21).replace("second_order: false", "second_order: true")
    whole = design(study_of_text("some", asked.replace("256", "16")))
    first = refine_cases(whole, lambda asked: asked)
    plain = design(study_of_text("some", text(21).replace("256", "16")))
    assert first.attrs["second_order"] == 0
    for name in ("velocity", "beam_depth", "sphere_radius"):
        np.testing.assert_array_equal(first[name], plain[name])


@pytest.mark.parametrize(
    ("whole", "count"), [(8, 8), (16, 16), (64, 16), (256, 32), (512, 64), (4096, 64)]
)
def test_how_many_are_solved_again(whole, count):
    assert base_samples(whole) == count


@pytest.mark.parametrize(
    ("attrs", "reason"),
    [({"method": "fast"}, "are of method fast"), ({"function": "ishigami"}, "are not of a beam")],
)
def test_what_cannot_be_refined_is_refused(attrs, reason):
    runs = design(study_of_text("some", text(21))).assign_attrs(attrs)
    with pytest.raises(ValueError, match=f"study 'some': .*{reason}"):
        refine_cases(runs, None)
