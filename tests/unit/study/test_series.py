"""Answers by strike and by sphere in the runs of studies: those of each run alone, to the bit."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import impactlab as il
from impactlab.figures import access
from impactlab.figures.catalogue import applicable
from impactlab.report.comparison import on_common_dimensions
from impactlab.solver.outputs import SERIES, by_strike, first_without_growth
from impactlab.solver.types import CASE
from impactlab.study.design import design
from impactlab.study.estimate import estimate
from impactlab.variables import BY_SPHERE, BY_STRIKE, OF_STRIKES, STATUS_FLAGS, WARNINGS

GRID = il.Discretisation(nodes=33, points=5, scheme="modal")
IMPACT = il.paper_impact(1.0, "finite_element")


def grid_study(responses, results):
    """Return a study of 9, 1 and 12 strikes at two velocities."""
    return il.Study(
        title="Strikes",
        impact=IMPACT,
        discretisation=GRID,
        duration="15 ms",
        sampling=il.Grid(parameters={"strikes": [9, 1, 12], "velocity": [0.5, 1.0]}),
        responses=responses,
        results=results,
    )


@pytest.fixture(scope="module")
def strikes(tmp_path_factory):
    """Runs of 9, 1 and 12 strikes, and the study."""
    responses = ["permanent_indentation", "peak_force"]
    study = grid_study(responses, tmp_path_factory.mktemp("results"))
    return study.run(workers=1), study


def test_each_run_has_its_own_strikes_and_no_more(strikes):
    runs, _ = strikes
    assert runs.strike.values.tolist() == list(range(1, 13))
    alone = il.simulate(replace(IMPACT, strikes=9), GRID, duration="15 ms", samples=2)
    run = runs.sel(strikes=9, velocity=1.0)
    for name in BY_STRIKE:
        assert run[name].values[:9].tobytes() == alone[name].values.tobytes(), name
        assert np.isnan(run[name].values[9:]).all()
    longest = runs.sel(strikes=12)
    for name in OF_STRIKES.keys() - BY_STRIKE.keys():
        assert np.isnan(run[name]) == np.isnan(alone[name])
        assert longest[name].sel(velocity=0.5).item() == 11
    for name in BY_STRIKE:
        first = runs[name].sel(strikes=1)
        assert np.isnan(first.values[:, 1:]).all()
        assert first.values[:, 0].tobytes() == longest[name].values[:, 0].tobytes(), name
        assert np.isfinite(first.values[:, 0]).all()


def test_what_a_study_says_of_the_end_of_growth_is_what_its_series_show(strikes):
    runs, _ = strikes
    dents = runs.permanent_indentation_over_strikes.sel(strikes=12, velocity=0.5).values
    grown = np.flatnonzero(np.diff(dents) > 1e-3 * dents[1:])
    assert runs.steady_strike.sel(strikes=12, velocity=0.5).item() == grown[-1] + 3
    never = runs.isel(strikes=[0, 1])
    assert np.isnan(never.shakedown_strike).all()
    assert np.isnan(never.steady_strike).all()
    assert "5 of 6 runs: the last strike still makes" in il.explain(runs)[-1]
    headline, *lines = il.answers(runs)
    assert headline.startswith("Over 12 strikes the dent grows to ")
    assert "in 1 of 2 runs dent and deflection no longer grow from strike " in headline
    assert any("Shakedown" in line for line in lines)


GROWTH = ("steady_strike", "shakedown_strike")


def test_strikes_without_growth_are_responses_of_a_grid(strikes, tmp_path):
    """Their values are those of a study that does not list them, and `status` explains gaps."""
    runs, _ = strikes
    listed = grid_study([*GROWTH, "peak_force"], tmp_path).run(workers=1)
    assert access.responses(listed) == ["peak_force", *GROWTH]
    for name in GROWTH:
        assert listed[name].values.tobytes() == runs[name].values.tobytes()
        bit = STATUS_FLAGS[listed[name].attrs["missing_because"].split()[-1]][0]
        missing = np.isnan(listed[name])
        assert ((listed.status & bit != 0) == missing).all()
        assert (listed.remarks & bit == 0).all()
        assert (runs.status & bit == 0).all()
        assert ((runs.remarks & bit != 0) == missing).all()
    assert (access.failed(listed) == np.isnan(listed.steady_strike)).all()
    assert not access.failed(runs).any()
    assert "5 of 6 runs: missing because the last strike still makes" in il.explain(listed)[-1]
    assert {*GROWTH, "status"} <= set(il.table(listed))
    il.analyse(listed)


def growth_sample(results, velocities, responses, **further):
    return il.Study(
        title="Growth",
        impact=replace(IMPACT, strikes=20),
        discretisation=GRID,
        duration="15 ms",
        sampling=il.Sobol(
            parameters={
                "velocity": il.Uniform(*velocities),
                "sphere_radius": il.Uniform("19 mm", "21 mm"),
            },
            base_samples=8,
        ),
        responses=responses,
        results=results,
        **further,
    )


@pytest.mark.parametrize(("fastest", "missing"), [(0.5, False), (5.0, True)])
def test_strikes_without_growth_have_indices_where_every_run_has_one(tmp_path, fastest, missing):
    study = growth_sample(tmp_path, (0.4, fastest), ["steady_strike", "peak_force"])
    runs = study.run(workers=1)
    assert np.isnan(runs.steady_strike).any().item() is missing
    found = il.analyse(runs).sel(response="steady_strike")
    flags = found.sensitivity_verdict.attrs["flag_meanings"].split()
    assert (flags[found.sensitivity_verdict.item()] == "failed_runs") is missing
    assert np.isnan(found.total_order).all().item() is missing


def test_strikes_without_growth_need_strikes_and_no_values_made_up(tmp_path):
    with pytest.raises(il.StudyError, match="responses: steady_strike needs several strikes"):
        il.Study(
            title="One",
            impact=IMPACT,
            discretisation=GRID,
            duration="15 ms",
            sampling=il.Grid(parameters={"velocity": [1.0, 2.0]}),
            responses=["steady_strike"],
        )
    analysis = {"failed_runs": "impute"}
    with pytest.raises(il.StudyError, match="failed_runs: a run without shakedown_strike has it"):
        growth_sample(tmp_path, (0.4, 1.0), ["shakedown_strike"], analysis=analysis)


def test_the_figure_shows_the_longest_runs(strikes):
    runs, _ = strikes
    figures = applicable(runs, il.analyse(runs))
    assert next(iter(figures)) == "lead"
    drawing = figures["strike_series"].plot(runs, il.analyse(runs))
    dent, *_ = drawing.axes
    label = [axes.get_ylabel() for axes in drawing.axes]
    assert label == [
        "Accumulated dent (µm)",
        "Residual deflection (µm)",
        "Restitution (–)",
        "Separation velocity (m/s)",
    ]
    series = runs.permanent_indentation_over_strikes.sel(strikes=12)
    slow, ring = dent.lines[:2]
    assert slow.get_ydata() == pytest.approx(1e6 * series.values[0])
    assert ring.get_xdata() == [runs.steady_strike.sel(strikes=12, velocity=0.5).item()]
    assert "Rings: the strike" in figures["strike_series"].caption(runs, il.analyse(runs))


def test_spheres_of_a_study_are_those_of_each_run_alone(tmp_path):
    impact = replace(il.paper_impact(), further_spheres=[(0.25, "3 m/s", "0.1 ms")])
    grid = il.Discretisation(nodes=21, points=3)
    study = il.Study(
        title="Spheres",
        impact=impact,
        discretisation=grid,
        duration="0.4 ms",
        sampling=il.Grid(parameters={"velocity": [1.0, 2.0]}),
        store={"histories": True, "samples": 11},
        results=tmp_path,
    )
    runs = study.run(workers=1)
    assert runs.sphere.values.tolist() == [1, 2]
    with pytest.warns(il.TooShortWarning):
        alone = il.simulate(replace(impact, velocity=2.0), grid, duration="0.4 ms", samples=11)
    for name in BY_SPHERE:
        assert runs[name].values[1].tobytes() == alone[name].values.tobytes(), name
    assert len(il.table(runs)) == 2


def dent_of_last(run):
    return run.permanent_indentation_over_strikes.isel(strike=run.strikes.item() - 1)


def test_functions_of_the_user_see_the_series_of_the_study_and_leave_its_status(tmp_path):
    names = ("permanent_indentation", "steady_strike")
    study = il.Study(
        title="Mine",
        impact=IMPACT,
        discretisation=GRID,
        duration="15 ms",
        sampling=il.Grid(parameters={"strikes": [1, 3]}),
        responses={"mine": dent_of_last} | {name: name for name in names},
        results=tmp_path,
    )
    runs = study.run(workers=1)
    assert np.isnan(runs.steady_strike).all()
    assert (runs.status == STATUS_FLAGS["not_steady"][0]).all()
    assert runs.mine.values.tolist() == runs.permanent_indentation.values.tolist()
    assert np.isfinite(runs.mine).all()
    assert np.isfinite(runs.peak_force_over_strikes).sum("strike").values.tolist() == [1, 3]


def test_studies_of_one_strike_and_sphere_have_none_of_it(tmp_path):
    study = il.Study(
        title="Plain",
        impact=IMPACT,
        discretisation=GRID,
        duration="1 ms",
        sampling=il.Grid(parameters={"velocity": [1.0]}),
        results=tmp_path,
    )
    runs = study.run(workers=1)
    assert not {*OF_STRIKES, *BY_SPHERE, "strike", "sphere"} & {*runs.variables}
    assert not {"most_strikes", "spheres"} & design(study.declared).attrs.keys()


def test_series_count_on_disk_and_in_memory(strikes):
    _, study = strikes
    many = estimate(study.declared, Path("nowhere"), 1)
    one = replace(study.declared, sampling=il.Grid(parameters={"velocity": [0.5, 1.0]}))
    few = estimate(one, Path("nowhere"), 1)
    stored = 2 * 8 * len(OF_STRIKES) * 12
    assert many.disk / 6 - few.disk / 2 == pytest.approx(stored + 2 * 8)  # and a parameter
    assert many.memory > few.memory


def test_growth_ends_where_a_geometric_series_says():
    """The series 1 - q^n grows by q^(n - 1) (1 - q)."""
    numbers, strikes = np.arange(1, 61), np.array([60, 60, 20, 1])
    shares = np.array([0.5, 0.8, 0.8, 0.5])[:, np.newaxis]
    values = np.where(numbers <= strikes[:, np.newaxis], 1.0 - shares**numbers, np.nan)
    level = np.where(np.isnan(values), np.nan, 0.0)
    first = [
        next(n for n in numbers if q ** (n - 1) * (1 - q) <= 1e-3 * (1 - q**n)) for q in (0.5, 0.8)
    ]
    ends = first_without_growth(strikes, [level, values])
    assert ends.tolist()[:2] == first
    assert np.isnan(ends[2:]).all()
    late = level.copy()
    late[0, 40:] = -1.0  # grows at strike 41, downwards
    assert first_without_growth(strikes, [late, values])[0] == 42
    late[1, 59] = np.nan  # unknown in the last strike
    assert np.isnan(first_without_growth(strikes, [late, values])[1])


def test_the_last_rest_is_no_growth_of_a_beam_that_moves_on():
    cases = np.zeros(2, CASE)
    cases["strikes"], cases["strike_interval"] = 4, [0.0, 0.1]
    series = np.ones((2, 4, len(SERIES)))
    series[:, -1, SERIES.index("residual_deflection")] = 0.5
    columns = {"status": np.zeros(2, int), "remarks": np.ones(2, int)}
    answers = by_strike(cases, columns, series)
    assert np.isnan(answers["steady_strike"][0])
    assert answers["steady_strike"][1] == 2
    assert answers["shakedown_strike"].tolist() == [2, 2]
    assert answers["remarks"].tolist() == [1 | WARNINGS["not_steady"][0], 1]


@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
def test_an_interval_after_the_only_strike_is_refused():
    reason = "has no effect with one strike: take it out, or set more strikes"
    impact = replace(IMPACT, strike_interval="30 ms")
    with pytest.raises(ValueError, match=f"^strike_interval = 30 ms: {reason}"):
        il.simulate(impact, GRID, duration="25 ms")
    with pytest.raises(ValueError, match=f"^strike_interval = 30 ms: {reason}"):
        il.simulate_many(impact, GRID, duration="25 ms", varied={"velocity": [1.0, 2.0]})
    many = il.simulate_many(impact, GRID, duration="25 ms", varied={"strikes": [1, 2]})
    assert many.sizes["run"] == 2
    given = {"title": "One", "duration": "25 ms", "discretisation": GRID, "impact": impact}
    with pytest.raises(il.StudyError, match=rf"impact\.strike_interval.*: {reason}"):
        il.Study(**given, sampling=il.Grid(parameters={"velocity": [1.0]}))
    study = il.Study(**given, sampling=il.Grid(parameters={"strikes": [1, 2]}))
    assert design(study.declared).attrs["most_strikes"] == 2


def test_tables_and_comparisons_leave_the_series_out_of_their_dimensions(strikes):
    runs, _ = strikes
    table = il.table(runs)
    assert len(table) == 6
    assert np.isfinite(table["steady_strike"]).sum() == 1
    fewer = runs.isel(strikes=[1], strike=slice(0, 1))
    common = on_common_dimensions([runs, fewer])
    assert [access.design_dims(each) for each in common] == [["strikes", "velocity"]] * 2
