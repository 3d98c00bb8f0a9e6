"""Designs of studies: stored runs, workers, the front, refusals."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import norm

import impactlab as il
from impactlab.study.engine import Engine
from impactlab.study.rare_event import LimitRuns
from impactlab.study.sizing import sizing

pytestmark = pytest.mark.usefixtures("blank_pictures")


def stress_minus_strength(load, strength, area):
    return load / area - strength


PARAMETERS = {
    "load": il.Normal(5, 1),
    "strength": il.Normal(6, 0.5),
    "area": il.Uniform(1, 3),
}


def study(folder, **changes):
    arguments = {"function": stress_minus_strength, "limits": {"value": 0}} | changes
    sampling = il.Pawn(samples=128, parameters=PARAMETERS)
    return il.Study(title="Rod", results=folder, sampling=sampling, **arguments)


def exact_area(wanted):
    def excess(area):
        return norm.logsf((6 - 5 / area) / np.hypot(1 / area, 0.5)) - np.log(wanted)

    return brentq(excess, 1, 3)


PROBABILITY = 0.01
SETTINGS = {"probability": PROBABILITY, "minimise": "area"}


@pytest.fixture(scope="module")
def sized(tmp_path_factory):
    """The rod, its least area and the page of it."""
    rod = study(tmp_path_factory.mktemp("rod"))
    result = il.size(rod, ["area"], **SETTINGS, workers=1)
    return rod, result, (rod.folder / "sizing.html").read_text("utf-8")


@pytest.mark.slow
def test_the_least_area_is_found_with_the_same_bits_for_any_number_of_workers(sized, tmp_path):
    _, first, page = sized
    other = il.size(study(tmp_path), ["area"], **SETTINGS, workers=2)
    np.testing.assert_array_equal(first.area, other.area)
    np.testing.assert_array_equal(first.front_objective, other.front_objective)
    chosen, low, high = first.area.values
    assert low <= exact_area(PROBABILITY) <= high
    assert exact_area(PROBABILITY) <= chosen < 1.03 * exact_area(PROBABILITY)
    headline, probability, least = first.answer.splitlines()
    assert headline.startswith("The design of least area for which the value exceeds 0")
    for line in (headline, probability.partition(": ")[2], least.partition(": ")[2]):
        assert line.removesuffix(".") in page.replace("\xa0", " ")
    assert page.count("<figure") == 1


@pytest.mark.slow
def test_correlations_count_but_not_with_what_is_chosen(tmp_path):
    def of(pair):
        sampling = il.Pawn(samples=128, parameters=PARAMETERS, correlations=[(*pair, -0.7)])
        return il.Study(
            title="Rod", function=stress_minus_strength, limits={"value": 0}, results=tmp_path,
            sampling=sampling,
        )  # fmt: skip

    result = il.size(
        of(("load", "strength")), ["area"], probability=1e-3, minimise="area", workers=1
    )
    linear = 2 * np.sin(np.pi * -0.7 / 6)

    def excess(area):
        deviation = np.sqrt(1 / area**2 + 0.25 - linear / area)
        return norm.logsf((6 - 5 / area) / deviation) - np.log(1e-3)

    exact = brentq(excess, 1, 3)
    assert exact > 1.05 * exact_area(1e-3)
    assert exact <= result.area[0] < 1.03 * exact
    with pytest.raises(ValueError, match="area is chosen, and so cannot correlate with load"):
        il.size(of(("load", "area")), ["area"], **SETTINGS, workers=1)


def test_the_greatest_load_is_the_one_with_the_probability(tmp_path):
    ranges = PARAMETERS | {"load": il.Uniform(3, 9), "area": il.Normal(1.5, 0.05)}
    declared = il.Study(
        title="Rod", function=stress_minus_strength, limits={"value": 0}, results=tmp_path,
        sampling=il.Pawn(samples=128, parameters=ranges),
    )  # fmt: skip
    result = il.size(declared, ["load"], probability=0.01, maximise="load", workers=1)
    rng = np.random.default_rng(1)
    strength, area = rng.normal(6, 0.5, 10**6), rng.normal(1.5, 0.05, 10**6)
    exact = np.quantile(strength * area, 0.01)  # the load exceeds it with this probability
    chosen, low, high = result["load"].values
    assert 0.97 * exact < chosen <= 1.001 * exact
    assert min(low, high) < 1.002 * exact
    assert max(low, high) > 0.998 * exact
    assert "design of greatest load" in result.answer


@pytest.mark.parametrize(
    ("variables", "settings", "reason"),
    [
        (["area"], {"probability": 0.5}, "probability = 0.5: must be from 1e-06 to 0.3"),
        (["are"], {"probability": 0.01}, "'are': unknown parameter; did you mean 'area'"),
        (["load"], {"probability": 0.01}, "load has no range: give it the distribution uniform"),
        ([], {"probability": 0.01}, "must be 1 to 2 different parameters"),
        (["area"], {"probability": 0.01}, "minimise"),
        (["area"], {"probability": 0.01, "minimise": "load"}, "minimise"),
        (["area"], {"probability": 0.01, "maximise": "mass"}, "maximise"),
        (["area"], {"probability": 0.01, "minimise": "area", "samples": 9}, "samples"),
    ],
)
def test_settings_that_are_wrong_are_refused(tmp_path, variables, settings, reason):
    with pytest.raises(ValueError, match=reason):
        il.size(study(tmp_path), variables, workers=1, **settings)


def test_a_limit_that_no_run_reaches_is_met_by_the_best_end(tmp_path):
    rod = study(tmp_path, limits={"value": 1000})
    result = il.size(rod, ["area"], probability=0.01, minimise="area", workers=1)
    assert result.area.values.tolist() == [1, 1, 1]
    assert "has area 1." in result.answer
    assert "Probability there: too small to estimate" in result.answer
    assert "Caution: even the best end of the ranges hardly reaches the limit" in result.answer
    assert "nan" not in result.answer
    assert (tmp_path / "rod" / "sizing.html").exists()


@pytest.mark.slow
def test_the_mass_is_that_of_the_beam(tmp_path):
    """A brute-force search on a grid, with many more runs, finds no lighter beam."""
    parameters = {
        "beam_depth": il.Uniform("24 mm", "60 mm"),
        "velocity": il.TruncatedNormal("10 m/s", "1 m/s", low="5 m/s", high="15 m/s"),
    }
    spheres = il.Study(
        title="Depth",
        impact=il.paper_impact("10 m/s"),
        duration="3 ms",
        responses=["maximum_deflection"],
        discretisation=il.Discretisation(nodes=9, scheme="modal"),
        limits={"maximum_deflection": "4 mm"},
        sampling=il.Pawn(samples=128, parameters=parameters),
        results=tmp_path,
    )
    result = il.size(spheres, ["beam_depth"], probability=0.05, workers=2)
    depths = np.linspace(float(result.beam_depth[1]) * 0.98, float(result.beam_depth[2]), 8)
    speeds = norm.ppf((np.arange(400) + 0.5) / 400, 10, 1)
    grid = il.Study(
        title="Grid",
        impact=il.paper_impact("10 m/s"),
        duration="3 ms",
        responses=["maximum_deflection"],
        discretisation=il.Discretisation(nodes=9, scheme="modal"),
        sampling=il.Grid(parameters={"beam_depth": depths.tolist(), "velocity": speeds.tolist()}),
        results=tmp_path,
    )
    above = (grid.run(workers=2).maximum_deflection > 4e-3).mean("velocity").values
    enough = depths[np.argmax(above <= 0.05)]
    np.testing.assert_allclose(result.beam_depth[0], enough, rtol=0.02)
    beam = spheres.declared.impact.beam
    np.testing.assert_allclose(
        result.objective[0], beam.mass_per_length * beam.span * result.beam_depth[0] / beam.depth
    )


def test_studies_without_a_sample_are_refused(tmp_path):
    grid = il.Grid(parameters={"load": [1, 2], "strength": [3], "area": [1.0]})
    declared = il.Study(
        title="Rod", function=stress_minus_strength, sampling=grid, results=tmp_path
    )
    with pytest.raises(il.StudyError, match="use any method but grid"):
        sizing(declared.declared, declared.folder, Engine(), ["area"], 0.01)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.2, 5.0])
def test_a_numerical_error_is_stated_and_may_take_the_design(sized, monkeypatch, factor):
    """An error of the load's scatter moves the probability as that of a strength would."""
    rod, plain, _ = sized
    assert "Numerical error" not in plain.answer
    area, spare = plain.area.item(0), PROBABILITY / plain.probability.item(0)
    deviation = np.hypot(1 / area, 0.5)
    error = factor * deviation * (norm.isf(plain.probability.item(0)) - norm.isf(PROBABILITY))
    monkeypatch.setattr(LimitRuns, "numerical_error", lambda self, scores: error)
    result = il.size(rod, ["area"], **SETTINGS, workers=1)
    np.testing.assert_array_equal(result.area, plain.area)  # of the runs that are stored
    index = (6 - 5 / area) / deviation
    exact = norm.sf([index + error / deviation, index - error / deviation])
    np.testing.assert_allclose(result.numerical_probability, exact, rtol=0.25)
    verdict = result.verdict.attrs["flag_meanings"].split()[result.verdict.item()]
    assert spare > 1
    assert verdict == ("usable" if factor < 1 else "numerical")
    assert ("take a finer discretisation" in result.answer) == (factor > 1)
    assert "Numerical error: up to " in result.answer


def test_the_numerical_error_holds_what_a_finer_grid_changes(tmp_path):
    def declared(nodes):
        sampling = il.Pawn(
            samples=128,
            parameters={
                "velocity": il.Uniform("4 m/s", "6 m/s"),
                "beam_depth": il.Uniform("26 mm", "30 mm"),
            },
        )
        return il.Study(
            title=f"{nodes} nodes", impact=il.paper_impact("5 m/s"), duration="0.5 ms",
            discretisation=il.Discretisation(nodes=nodes, points=5, scheme="modal"),
            responses=["peak_force"], limits={"peak_force": "30 kN"},
            sampling=sampling, results=tmp_path,
        )  # fmt: skip

    def solver(nodes):
        rare = declared(nodes)
        return LimitRuns.of(rare.declared, rare.folder, Engine("threads", 1), "sizing")

    scores = np.array([0.5, -1.0])
    coarse, fine = (solver(n).outputs(scores[None])[0] for n in (17, 201))
    error = solver(17).numerical_error(scores)
    assert abs(coarse - fine) < error < 10 * abs(coarse - fine)
