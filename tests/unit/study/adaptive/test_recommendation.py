"""A recommendation holds against the exact solution, and says where there is none."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from impactlab.files import write_netcdf
from impactlab.report.console import print_recommendation
from impactlab.study import RESOLUTION
from impactlab.study.adaptive import recommendation
from impactlab.study.adaptive.recommendation import (
    apply_recommendation,
    recommend,
    recommended_grid,
)
from impactlab.study.design import design
from impactlab.study.engine import Engine
from impactlab.study.schema.readers import read_study
from impactlab.study.steps import resolved as resolved_study
from impactlab.study.store import holder
from impactlab.validation.errors import StudyError
from impactlab.verification.solutions import modal

ROOT = Path(__file__).parents[4]
ELASTIC = """
title: Elastic impacts
impact: {base: paper, contact: hertz, beam_model: elastic}
discretisation: DISCRETISATION
duration: 0.3 ms
responses: [peak_force, contact_duration, peak_plastic_strain]
sampling: {method: grid, parameters: {velocity: [0.5, 1, 2]}}
"""
PLASTIC = """
title: A yielding beam
impact: {base: paper}
discretisation: {auto: {tolerance: 10 %}}
duration: 0.3 ms
responses: [contact_duration, peak_plastic_strain]
sampling: {method: grid, parameters: {velocity: [15]}}
"""


@pytest.fixture
def study(tmp_path):
    def read(text):
        (tmp_path / "some.yaml").write_text(text)
        return read_study(tmp_path / "some.yaml")

    return read


@pytest.fixture(scope="module", params=["{nodes: 101}", "{nodes: 37, scheme: modal}"])
def found(tmp_path_factory, request):
    folder = tmp_path_factory.mktemp("trials")
    (folder / "some.yaml").write_text(ELASTIC.replace("DISCRETISATION", request.param))
    study = read_study(folder / "some.yaml")
    return recommend(study, folder, Engine(workers=2)), study


def test_pilot_runs_lock_their_folder_throughout(study, tmp_path, monkeypatch):
    def looking(*_):
        raise OSError(holder(tmp_path / "trials"))

    monkeypatch.setattr(recommendation, "_evidence", looking)
    with pytest.raises(OSError, match=f"process {os.getpid()} on "):
        recommend(study(PLASTIC), tmp_path / "trials", Engine())


def test_the_cheapest_that_is_good_enough(found):
    trials, study = found
    grid = recommended_grid(trials, study.discretisation)
    best = int(trials["recommended"])
    enough = (trials["candidate_uncertainty"] <= 0.01).all("response").values
    assert enough[best]
    assert not enough[:best].any()
    assert (np.diff(trials["candidate_cost"]) >= 0).all()
    assert grid.points == 3  # no fibre yields: more of them change nothing
    asked = {"nodes": grid.nodes, "points": 3, "courant": grid.courant}
    parts = [trials[f"{axis}_uncertainty"].sel({axis: asked[axis]}) for axis in asked]
    whole = parts[0].drop_vars("nodes") + parts[1].drop_vars("points")
    whole = whole + parts[2].drop_vars("courant")
    assert (trials["check_difference"] <= whole).all()
    nodes = study.discretisation.nodes
    assert trials.attrs["grid_nodes"] == nodes  # the uncertainty is told of the study's own grid
    own = trials["grid_uncertainty"].sel(response="peak_force")
    assert (own >= trials["nodes_uncertainty"].sel(response="peak_force", nodes=nodes)).all()
    # a response without variation is certain
    trials, _ = found
    assert (trials["candidate_uncertainty"].sel(response="peak_plastic_strain") == 0).all()
    # every levels uncertainty holds the exact solution
    trials, study = found
    for case, velocity in enumerate(trials["velocity"].values):
        exact = modal.solve(replace(study.impact, velocity=float(velocity)), 3e-4)
        for name in ("peak_force", "contact_duration"):
            here = trials.sel(response=name).isel(case=case)
            error = abs(here["nodes_value"] - getattr(exact, name))
            assert (error <= here["nodes_uncertainty"] + 2e-4 * getattr(exact, name)).all()


def test_auto_becomes_what_was_recommended(study, tmp_path):
    declared = study(ELASTIC.replace("DISCRETISATION", "{auto: {tolerance: 1 %}, rule: legendre}"))
    with pytest.raises(StudyError, match="find it before the runs are drawn"):
        design(declared)
    trials = recommend(declared, tmp_path / "trials", Engine(workers=2))
    resolved = apply_recommendation(declared, trials)
    write_netcdf(trials, tmp_path / RESOLUTION, "resolution")
    assert resolved_study(declared, tmp_path) == resolved
    assert resolved_study(replace(declared, text="another"), tmp_path) is None
    assert resolved.discretisation == recommended_grid(trials, declared.discretisation)
    assert resolved.discretisation.rule == "legendre"
    runs = design(resolved)
    assert runs["nodes"].item() == trials.attrs["grid_nodes"]
    assert (trials["grid_relative"] <= 0.01).all()


def test_what_cannot_be_reached_is_named(study, tmp_path, capsys):
    declared = study(PLASTIC)
    trials = recommend(declared, tmp_path / "trials", Engine(workers=2))
    with pytest.raises(StudyError) as caught:
        apply_recommendation(declared, trials)
    (problem,) = caught.value.args
    assert problem.key == "discretisation.auto"
    assert "meets 10 % for peak_plastic_strain" in problem.reason
    assert "contact_duration" not in problem.reason
    print_recommendation(trials)
    told = " ".join(capsys.readouterr().out.split())
    assert "meets 10 % for peak_plastic_strain. Without them: the cheapest" in told


@pytest.mark.long
def test_the_grid_of_the_largest_study_is_found(tmp_path):
    """Its corner cases yield widely, where no scheme has a clean order."""
    declared = read_study(ROOT / "studies" / "sobol_large.yaml")
    found = recommend(declared, tmp_path / "trials", Engine(workers=2))
    assert apply_recommendation(declared, found).discretisation.nodes <= 145


@pytest.mark.parametrize(
    ("given", "key", "reason"),
    [
        ("{auto: {tolerance: 1 %}, nodes: 101}", "discretisation.nodes", "beside auto"),
        ("{auto: {tolerance: 0}}", "discretisation.auto.tolerance", "must be at least"),
        ("{auto: {responses: [impulse]}}", "discretisation.auto.responses", "impulse"),
        ("auto2", "discretisation", "expected"),
    ],
)
def test_wrong_wishes(study, given, key, reason):
    with pytest.raises(StudyError) as caught:
        study(ELASTIC.replace("DISCRETISATION", given))
    assert [(p.key, reason in str(p)) for p in caught.value.args] == [(key, True)]


def test_varied_nodes_are_not_sought(study):
    text = ELASTIC.replace("DISCRETISATION", "auto").replace(
        "{velocity:", "{nodes: [11], velocity:"
    )
    with pytest.raises(StudyError, match=r"sampling\.parameters\.nodes: cannot be varied beside"):
        study(text)
