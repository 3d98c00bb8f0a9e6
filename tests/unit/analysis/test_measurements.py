"""Measurements: how they are read, matched with runs, judged, drawn and told."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import impactlab as il
from impactlab.analysis.convergence.axes import NODES
from impactlab.analysis.measurements import Agreement, Measurement, compared
from impactlab.figures.catalogue import applicable
from impactlab.figures.data import drawn
from impactlab.report.answer import LINES, answers
from impactlab.report.measured import entries, sections
from impactlab.study.schema.measurement_files import read_measurements
from impactlab.validation.errors import StudyError

ROOT = Path(__file__).parents[3]
FORCE = {"quantity": "peak_force", "value": "12 kN", "standard_uncertainty": 100}
FILE = {"title": "Drop tests", "source": "made up for the tests", "measurements": [FORCE]}


def with_force(**changes):
    given = {key: value for key, value in (FORCE | changes).items() if value is not None}
    return FILE | {"measurements": [given]}


@pytest.fixture
def study():
    """Runs on velocity, contact and three grids that converge with order 2, and their analysis."""
    velocity, nodes = np.array([1.0, 2.0, 3.0]), np.array([51, 101, 201])
    contact = np.array(["hertz", "stronge"])
    scale = 1e4 * velocity[:, None, None] * np.array([1.1, 1.0])[:, None]
    force = scale * (1 + 30.0 / (nodes - 1) ** 2)
    names = ["velocity", "contact", "nodes"]
    runs = xr.Dataset(
        {
            "peak_force": (names, force, {"units": "N", "long_name": "peak force"}),
            "status": (names, np.zeros(force.shape, np.int32)),
        },
        {"velocity": velocity, "contact": contact, "nodes": nodes, "beam_depth": 27.8e-3},
        {"varied": names, "responses": ["peak_force"], "method": "grid", "study": "made"},
    )
    runs["velocity"].attrs["units"] = "m s-1"
    return runs, il.analyse(runs)


def judged(study, measured, standard=100.0, quantity="peak_force", **conditions):
    one = Measurement(quantity, measured, standard, "N", conditions, "made up")
    found = compared(*study, [one])
    return [
        (list(Agreement)[code], str(case), str(why))
        for code, case, why in zip(
            found["compared_verdict"].values,
            found["compared_case"].values,
            found["compared_reason"].values,
            strict=True,
        )
    ]


def test_a_file_is_read_in_si_with_standard_uncertainties():
    given = FILE | {
        "conditions": {"beam_depth": "27.8 mm", "velocity": 1},
        "measurements": [
            FORCE
            | {"conditions": {"velocity": "2 m/s", "contact": "mjg"}}
            | {"systematic_uncertainty": "0.06 kN"},
            {"quantity": "restitution", "value": "50 %", "expanded_uncertainty": "6 %"}
            | {"coverage_factor": 3},
        ],
    }
    force, restitution = read_measurements(given)
    assert (force.value, force.standard_uncertainty, force.units) == (12e3, 100.0, "N")
    assert (force.systematic_uncertainty, restitution.systematic_uncertainty) == (60.0, 0.0)
    assert force.conditions == {"beam_depth": 0.0278, "velocity": 2.0, "contact": "mjg"}
    assert (restitution.value, restitution.standard_uncertainty) == (0.5, pytest.approx(0.02))
    assert restitution.conditions == {"beam_depth": 0.0278, "velocity": 1.0}
    # the committed files are sound and name their source
    for path in (ROOT / "measurements").glob("*.yaml"):
        assert all(len(one.source) > 40 for one in read_measurements(path))


@pytest.mark.parametrize(
    ("given", "key", "words"),
    [
        (with_force(quantity="peak_forse"), "measurements.0.quantity", "did you mean 'peak_force'"),
        (with_force(value="12 mm"), "measurements.0.value", "wrong dimension"),
        (with_force(standard_uncertainty=None), "measurements.0", "give one of"),
        (with_force(standard_uncertainty=0), "measurements.0", "above zero"),
        (with_force(expanded_uncertainty=1, coverage_factor=2), "measurements.0", "give one of"),
        (
            with_force(standard_uncertainty=None, expanded_uncertainty=1),
            "measurements.0",
            "belong together",
        ),
        (
            with_force(systematic_uncertainty="0.1 kN"),
            "measurements.0.systematic_uncertainty",
            "below it (100",
        ),
        (
            with_force(systematic_uncertainty=-1),
            "measurements.0.systematic_uncertainty",
            "at least 0",
        ),
        (with_force(conditions={"speed": 1}), "measurements.0.conditions.speed", "unknown"),
        (
            with_force(conditions={"velocity": "1 mm"}),
            "measurements.0.conditions.velocity",
            "wrong dimension",
        ),
        ({key: FILE[key] for key in ("title", "measurements")}, "source", "is required"),
        (FILE | {"measurements": []}, "measurements", "is empty"),
    ],
)
def test_a_mistake_is_told_at_its_key(given, key, words):
    with pytest.raises(StudyError) as error:
        read_measurements(given)
    (problem,) = error.value.args
    assert problem.key == key
    assert words in problem.reason


@pytest.mark.parametrize("side", [-1, 1])
def test_both_uncertainties_are_added_in_squares(study, side):
    runs, _ = study
    model = float(runs["peak_force"].sel(velocity=2, contact="stronge", nodes=201))
    # order 2, ratio 2: the grid convergence index is 1.25 times the change over 2^2 - 1
    coarser = float(runs["peak_force"].sel(velocity=2, contact="stronge", nodes=101))
    numerical = 1.25 * (coarser - model) / 3
    assert float(NODES.analysis(runs)["nodes_uncertainty"][0, 1, 1]) * model == pytest.approx(
        numerical, rel=1e-6
    )
    width = np.hypot(2 * 5.0, numerical)
    assert 10.0 < numerical < 20.0, "about as large as the measurement's, which is 10"
    for factor, verdict in ((0.99, Agreement.COMPATIBLE), (1.01, Agreement.INCOMPATIBLE)):
        measured = model + side * factor * width
        ((found, _, _),) = judged(study, measured, 5.0, velocity=2.0, contact="stronge")
        assert found is verdict


@pytest.mark.parametrize(("value", "verdict"), [(2.2e4, 0), (2.3e4, 1), (np.inf, 2)])
def test_pilot_runs_of_auto_bound_the_error_of_a_grid(study, value, verdict):
    grid = {"nodes": 201, "points": 5, "courant": 0.5}
    runs = study[0].sel(nodes=201).assign_coords(grid).assign_attrs(study_sha256="f")
    error = 0.04 if np.isfinite(value) else np.inf
    found = xr.Dataset(
        {"grid_relative": ("response", [error])},
        {"response": ["peak_force"]},
        {f"grid_{name}": each for name, each in grid.items()} | {"study_sha256": "f"},
    )
    measured = value if np.isfinite(value) else 2.2e4
    ours = judged((runs, il.analyse(runs, found)), measured, velocity=2.0, contact="hertz")
    assert ours[0][0] == list(Agreement)[verdict]
    other = found.assign_attrs(grid_nodes=101)
    with pytest.raises(ValueError, match="found for nodes = 101"):
        il.analyse(runs, other)


def test_a_measured_zero_shows_the_difference_in_its_unit(study):
    zero = Measurement("peak_force", 0.0, 100.0, "N", {"velocity": 2.0, "contact": "hertz"}, "x")
    found = compared(*study, [zero])
    ((_, line),) = entries(found)
    assert "peak force +22 kN (± " in line
    ((row,),) = (table.rows for table in sections(study[0], found)[0].tables)
    assert row[-2].text == "+22 kN"
    assert "inf" not in line
    # what is not judged says why
    runs, analysis = study
    force = {"velocity": 2.0, "contact": "stronge"}
    other, missing = Agreement.OTHER_IMPACT, Agreement.NOT_JUDGED

    def verdict(given, words, on=study, **conditions):
        ((found, _, why),) = judged(on, 2e4, **conditions)
        assert found is given
        assert words in why

    verdict(other, "0.0278", **force, beam_depth=0.03)
    verdict(other, "has no beam_span", **force, beam_span=0.03)
    verdict(missing, "no run at velocity = 2.5", **force | {"velocity": 2.5})
    verdict(missing, "leaves out the response impulse", quantity="impulse", **force)
    verdict(missing, "bounds the numerical error", on=(runs, xr.Dataset()), **force)
    verdict(missing, "state velocity", contact="stronge")
    failed = runs.copy(deep=True)
    failed["status"][1, 1, 2] = 1
    verdict(missing, "diverged", on=(failed, analysis), **force)
    cases = [case for _, case, _ in judged(study, 2e4, velocity=2.0)]
    assert cases == ["hertz", "stronge"], "one row per law, where none is stated"


def test_report_and_figures_show_them(study):
    runs, analysis = study
    given = [
        Measurement("peak_force", 2.1e4, 50.0, "N", {"velocity": 2.0}, "made up"),
        Measurement("peak_force", 2.6e4, 50.0, "N", {"velocity": 2.5}, "made up"),
        Measurement("peak_force", 9e9, 50.0, "N", {"velocity": 1.0, "beam_depth": 1.0}, "far"),
    ]
    analysis = analysis.merge(compared(runs, analysis, given))
    lines = answers(runs, analysis)
    assert len(lines) <= LINES
    assert lines[-1] == (
        "Beside measurements: 0 of 4 comparisons compatible; peak force +4.8 % (± 0.49, hertz), "
        "peak force −4.7 % (± 0.48, stronge); 1 not judged; 1 of another impact."
    )
    (section,) = sections(runs, analysis)
    assert [row[-1].text for row in section.tables[0].rows] == [
        "incompatible",
        "incompatible",
        "not judged",
        "other impact",
    ]
    record = applicable(runs, analysis)["parameter_effects"]
    figure: Figure = record.plot(runs, analysis)
    (bars,) = figure.axes[0].containers
    assert bars.lines[0].get_xydata().tolist() == [[2.0, 21.0], [2.5, 26.0]], "m/s and kN"
    low, high = bars.lines[2][0].get_segments()[0][:, 1]
    assert (low, high) == pytest.approx((20.9, 21.1)), "expanded"
    assert "Diamonds with expanded uncertainties (k = 2): made up." in record.caption(
        runs, analysis
    )
    assert "measured" in [text.get_text() for text in figure.legends[0].get_texts()]
    assert "measured" in [curve.curve for curve in drawn(figure)], "and in the data of the figure"


def test_a_study_compares_its_measurements_and_refuses_wrong_ones_first(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("good.yaml").write_text(json.dumps(with_force(conditions={"velocity": 2})))
    Path("bad.yaml").write_text(json.dumps(with_force(value="12 mm")))

    def study(file):
        return il.Study(
            title=file,
            impact=il.paper_impact(),
            duration="0.3 ms",
            responses=["peak_force"],
            discretisation=il.Discretisation(nodes=21, points=3),
            sampling=il.Grid(parameters={"velocity": [1, 2]}),
            measurements=[file],
        )

    with pytest.raises(StudyError, match=r"measurements\.0\.value"):
        study("bad.yaml").run(workers=1)
    with pytest.raises(StudyError, match="no such file"):
        study("none.yaml").run(workers=1)
    good = study("good.yaml")
    runs = good.run(workers=1)
    found = good.analyse()
    assert found["compared_model"].item() == runs["peak_force"].sel(velocity=2).item()
    ax = il.plot.response(runs, "peak_force", measurements="good.yaml")
    assert len(ax.containers) == 1
