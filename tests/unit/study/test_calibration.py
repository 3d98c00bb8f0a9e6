"""Calibration of a whole study: recovered parameters, contact laws, confirmation, command."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import called

import impactlab as il
from impactlab.figures.calibration import calibration
from impactlab.figures.data import drawn
from impactlab.files import read_netcdf
from impactlab.report.calibration import sentences
from impactlab.study import calibration as of_study

TRUTH = {"rate": 0.6, "start": 5.4}


def decay(rate, start, idle, time):
    return start * np.exp(-rate * time)


def values(uncertainty=0.05):
    """Exact values of the model at three times."""
    return {
        "title": "Decay",
        "source": "made by the model itself",
        "measurements": [
            {"quantity": "value", "value": decay(**TRUTH, idle=0.0, time=time)}
            | {"standard_uncertainty": uncertainty, "conditions": {"time": time}}
            for time in (0.5, 1.0, 2.0)
        ],
    }


@pytest.fixture
def study(tmp_path):
    ranges = {"rate": (0, 1), "start": (4, 7), "idle": (0, 1), "time": (0, 3)}
    return il.Study(
        title="Decay",
        function=decay,
        sampling=il.Pawn(
            samples=300, parameters={name: il.Uniform(*ends) for name, ends in ranges.items()}
        ),
        results=tmp_path,
    )


def test_known_parameters_are_recovered_and_confirmed_by_runs(study, monkeypatch):
    found = il.calibrate(study, values(), workers=1)
    for name, truth in TRUTH.items():
        one = found.sel(parameter=name)
        assert one["posterior_low"] < truth < one["posterior_high"]
        assert abs(one["posterior_mean"] - truth) < one["posterior_deviation"]
        assert one["spread_ratio"] < 0.3
    # the linearised covariance, from the derivatives of the closed form
    times = np.array([0.5, 1.0, 2.0])
    slopes = np.exp(-TRUTH["rate"] * times)[:, None] * np.column_stack(
        [-TRUTH["start"] * times, np.ones(3)]
    )
    wanted = 0.05 * np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))
    ours = found["posterior_deviation"].sel(parameter=["rate", "start"]).values
    assert ours == pytest.approx(wanted, rel=0.1)
    first, second, silent, predictions, rest = sentences(found)
    assert first.startswith("Rate: 0.")
    assert second.startswith("Start: 5.")
    assert silent == "The data cannot tell idle (spread 1.00 of the prior's)."
    assert predictions.startswith("Predictions: 3 of 3 measured values within the 95 %")
    assert rest.startswith("Confirmed by 48 runs")
    assert found.attrs["answer"].splitlines() == sentences(found)
    assert (study.folder / "calibration.svg").exists()
    kept = read_netcdf(study.folder / "calibration.nc", "calibration")
    assert kept["posterior_mean"].equals(found["posterior_mean"])
    curves = [curve.curve for curve in drawn(calibration(kept))]
    assert {"measured", "predicted"} <= set(curves)

    solved = of_study.execute

    def shifted(*args):
        runs = solved(*args)
        return runs.assign(value=runs["value"] + 0.2)

    monkeypatch.setattr(of_study, "execute", shifted)
    with pytest.raises(ValueError, match=r"at the posterior the surrogate is off by 0\.2"):
        il.calibrate(study, values(), workers=1)

    def lost(*args):
        return solved(*args).assign(status=1 + 0 * solved(*args)["status"])

    monkeypatch.setattr(of_study, "execute", lost)
    with pytest.raises(ValueError, match="most runs at the posterior gave no answer"):
        il.calibrate(study, values(), workers=1)


RANGE = "{distribution: uniform, low: 250 MPa, high: 450 MPa}"
STUDY = """
title: Steel
impact: {base: paper, velocity: 5 m/s}
discretisation: {nodes: 21, points: 5, scheme: modal}
duration: 0.3 ms
responses: [peak_force, maximum_indentation]
sampling:
  method: METHOD
  parameters:
    beam_yield_stress: VALUES
    beam_depth: {distribution: uniform, low: 25 mm, high: 30 mm}
"""


@pytest.mark.parametrize(
    ("kind", "joined", "words"),
    [
        (il.Choice(["soft", "hard"]), None, "kind: draws words, and no surrogate is fitted"),
        (il.Uniform(0, 1), [("kind", "rate", 0.5)], "correlations: no surrogate is fitted over"),
    ],
)
def test_what_has_no_surrogate_is_refused_before_a_run_is_solved(tmp_path, kind, joined, words):
    given = {"kind": kind, "rate": il.Uniform(0, 1)}
    sampling = il.Pawn(samples=100, parameters=given, correlations=joined)
    study = il.Study(title="Words", function=decay, sampling=sampling, results=tmp_path)
    with pytest.raises(il.StudyError, match=words):
        il.calibrate(study, values(), workers=1)
    assert study.status().done == 0


def test_the_command_refuses_without_a_traceback(tmp_path):
    (tmp_path / "steel.yaml").write_text(
        STUDY.replace("METHOD", "grid").replace("VALUES", "[300 MPa, 400 MPa]").rsplit("\n", 2)[0]
    )
    (tmp_path / "force.yaml").write_text(json.dumps(values()))
    sample = STUDY.replace("METHOD", "pawn\n  samples: 100").replace("VALUES", RANGE)
    (tmp_path / "drawn.yaml").write_text(sample)
    for file, options, words in (
        ("steel.yaml", [], "sampling.method: calibration needs a sample"),
        ("drawn.yaml", ["--contact", "stronge,stronger"], "did you mean 'stronge'"),
    ):
        ended = called("calibrate", file, "force.yaml", *options, cwd=tmp_path)
        assert ended.returncode == 1
        assert words in ended.stderr
        assert "Traceback" not in ended.stderr
    assert not (tmp_path / "results").exists(), "and before anything is solved"


@pytest.mark.long
def test_the_law_that_made_the_data_is_found(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = STUDY.replace("METHOD", "pawn\n  samples: 200").replace("VALUES", RANGE)
    Path("steel.yaml").write_text(text)
    grid = il.Discretisation(nodes=21, points=5, scheme="modal")
    truth = il.simulate(il.paper_impact("5 m/s", "thornton"), grid, duration="0.3 ms")
    given = [
        {"quantity": name, "value": float(truth[name])}
        | {"standard_uncertainty": 0.01 * float(truth[name])}
        for name in ("peak_force", "maximum_indentation")
    ]
    data = {"title": "Made", "source": "the model itself", "measurements": given}
    study = il.Study.from_yaml("steel.yaml")
    laws = ["stronge", "thornton", "hertz"]
    found = il.calibrate(study, data, contact=laws, workers=1)
    weight = found["model_weight"].to_series()
    assert weight["thornton"] > 0.1
    assert weight["hertz"] < 0.01
    assert "Weights of the contact laws given the data: " in found.attrs["answer"]

    # a sample that draws the law names laws and weights itself
    choice = f"    contact: {{distribution: choice, values: {laws}, weights: [1, 2, 1]}}\n"
    Path("drawn.yaml").write_text(text.rstrip() + "\n" + choice)
    drawn = il.calibrate(il.Study.from_yaml("drawn.yaml"), data, workers=1)
    assert drawn["model_weight_before"].values.tolist() == [0.25, 0.5, 0.25]
    odds = found["model_weight"] * drawn["model_weight_before"]
    assert drawn["model_weight"].values == pytest.approx((odds / odds.sum()).values, abs=0.01)
