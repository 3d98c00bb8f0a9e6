"""Calibration of a whole study: recovered parameters, contact laws, confirmation, command."""

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import called

import impactlab as il
from impactlab.figures.data import drawn
from impactlab.figures.questions import calibration
from impactlab.files import read_netcdf
from impactlab.report.calibration import sentences
from impactlab.report.results import write_index
from impactlab.simulate import run_dataset
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


@pytest.mark.slow
def test_known_parameters_are_recovered_and_confirmed_by_runs(
    study, monkeypatch, tmp_path, blank_pictures
):
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
    first, second, silent, joint, predictions, rest = sentences(found)
    assert first.startswith("Rate: 0.")
    assert second.startswith("Start: 5.")
    assert silent == "The data cannot tell idle (spread 1.00 of the prior's)."
    correlation = found["posterior_correlation"].sel(parameter="rate", other_parameter="start")
    inverse = np.linalg.inv(slopes.T @ slopes)
    exact = inverse[0, 1] / np.sqrt(inverse[0, 0] * inverse[1, 1])
    assert correlation.item() == pytest.approx(exact, abs=0.03)
    assert joint.startswith(f"Correlated given the data: rate and start ({correlation:+.2f})")
    assert predictions.startswith("Predictions: 3 of 3 measured values within the 95 %")
    assert rest.startswith("Confirmed by 48 runs")
    assert found.attrs["answer"].splitlines() == sentences(found)
    assert (study.folder / "calibration.svg").exists()
    report = " ".join((study.folder / "calibration.html").read_text().split())
    assert first.removesuffix(".") in report
    assert "The data cannot tell:</strong> idle" in report
    assert "Made from the study" in report
    assert '<th scope="row">Value, time 0.5</th>' in report
    write_index(tmp_path, tmp_path / "index.html")
    assert f'href="{study.folder.name}/calibration.html"' in (tmp_path / "index.html").read_text()
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


def square(start, time):
    return (start - 5.5) ** 2 + 0.1 * time


def measured_square(**keys):
    """Zero or one, at two times; the uncertainty is partly systematic."""
    entry = {"quantity": "value", "standard_uncertainty": 0.05, "conditions": {"time": 0}} | keys
    return {"title": "Square", "source": "made by the model", "measurements": [entry]}


@pytest.mark.parametrize(("low", "high", "count"), [(4, 7, 2), (5.5, 7, 1)])
def test_two_roots_are_told_as_two_ranges(tmp_path, blank_pictures, low, high, count):
    ranges = {"start": il.Uniform(low, high), "time": il.Uniform(0, 3)}
    sampling = il.Pawn(samples=200, parameters=ranges)
    study = il.Study(title="Square", function=square, sampling=sampling, results=tmp_path)
    found = il.calibrate(study, measured_square(value=1), workers=1)
    assert np.isfinite(found["mode_weight"]).sum() == count
    if count == 1:
        assert sentences(found)[0].startswith("Start: 6.499 ± 0.025 ")
        return
    first, *rest = sentences(found)
    assert first.startswith("Start: the data allow 2 separate ranges, 4.4")
    assert not any("cannot tell" in sentence for sentence in rest)
    assert found["mode_weight"].values == pytest.approx(np.array([[0.5, 0.5]]), abs=0.02)
    wanted = np.array([4.5, 6.5])[:, None] + 1.96 * 0.05 / 2 * np.array([-1, 1])  # slope 2
    ours = np.stack([found["mode_low"].values[0], found["mode_high"].values[0]]).T
    assert ours == pytest.approx(wanted, abs=0.005)
    labels = {text.get_text() for ax in calibration(found).axes for text in ax.texts}
    assert "the data cannot tell" not in labels


@pytest.mark.slow
@pytest.mark.parametrize("method", [il.Fast, il.Sobol])
def test_a_single_parameter_is_sampled_reported_and_calibrated(tmp_path, method):
    size = {"base_samples": 64} if method is il.Sobol else {"samples": 612}
    sampling = method(**size, parameters={"start": il.Uniform(5.4, 7)})
    study = il.Study(
        title="Single", function=lambda start: square(start, 0), sampling=sampling, results=tmp_path
    )
    study.run(workers=1)
    analysis = study.analyse()
    for name in ("first_order", "total_order"):  # alone, it explains all of the variance
        off = abs(analysis[name].item() - 1)
        assert off <= max(analysis[f"{name}_interval"].item(), 0.005)
    assert "second_order" not in analysis
    if method is il.Fast:
        return
    assert study.report().exists()  # the most figures
    data = measured_square(value=1, conditions={})
    found = il.calibrate(study, data, workers=1)
    assert found["posterior_mean"].item() == pytest.approx(6.5, abs=0.005)
    assert found["posterior_deviation"].item() == pytest.approx(0.025, rel=0.05)


def test_a_measured_zero_has_finite_differences(tmp_path, blank_pictures):
    sampling = il.Pawn(samples=200, parameters={"start": il.Uniform(5, 7)})
    study = il.Study(
        title="Zero", function=lambda start: start - 6, sampling=sampling, results=tmp_path
    )
    found = il.calibrate(study, measured_square(value=0, conditions={}), workers=1)
    assert "inf" not in found.attrs["answer"]
    points = [curve for curve in drawn(calibration(found)) if curve.curve in CURVES]
    assert points
    assert all(np.isfinite(curve.x).all() for curve in points)


CURVES = {"measured", "predicted"}
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
    truth = run_dataset(il.paper_impact("5 m/s", "thornton"), grid, duration=0.3e-3)
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
