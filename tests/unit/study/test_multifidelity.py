"""Statistics of a study's slow model: stored runs, workers, missing runs, budgets, refusals."""

import sys
from html import unescape

import numpy as np
import pytest
from scipy.special import ndtr

import impactlab as il
from impactlab.fem3d.solver import solve
from impactlab.study.schema.readers import describe

pytestmark = pytest.mark.usefixtures("blank_pictures")


def power_of(x, noise, power):
    return (1 + x) ** power + 0.1 * noise


def sometimes_failing(x, noise, power):
    return np.nan if power == 2 and x > 0.9 else power_of(x, noise, power)


FINE = {"nodes": 101, "scheme": "leapfrog"}


def study(folder, function=power_of, **changes):
    parameters = {"x": il.Uniform(0, 1), "noise": il.Normal(0, 1), "power": 1.7}
    arguments = {"function": function, "limits": {"value": 3}}
    arguments |= {"sampling": il.Pawn(samples=128, seed=2, parameters=parameters)} | changes
    return il.Study(title="Power", results=folder, **arguments)


def impacts(folder, **changes):
    arguments = {
        "impact": il.paper_impact("2 m/s"),
        "duration": "0.8 ms",
        "discretisation": il.Discretisation(nodes=13, scheme="modal"),
        "responses": ["peak_force", "maximum_indentation"],
        "limits": {"peak_force": "26 kN"},
        "sampling": il.Pawn(
            samples=128,
            parameters={
                "velocity": il.Uniform("1.5 m/s", "2.5 m/s"),
                "beam_depth": il.Uniform("26 mm", "29 mm"),
            },
        ),
    }
    return il.Study(title="Impacts", results=folder, **(arguments | changes))


def test_runs_are_kept_and_give_the_same_bits_for_any_number_of_workers(tmp_path):
    results = [
        il.multifidelity(study(tmp_path / name), {"power": 2}, runs=1000, workers=workers)
        for name, workers in (("one", 1), ("one", 1), ("two", 2))
    ]
    for other in results[1:]:
        np.testing.assert_array_equal(results[0].estimate, other.estimate)
        np.testing.assert_array_equal(results[0].slow, other.slow)
    more = il.multifidelity(study(tmp_path / "two"), {"power": 2}, runs=1500, workers=1)
    np.testing.assert_array_equal(more.fast, results[0].fast)  # the first draws are the same
    exact = {"mean": 7 / 3, "standard_deviation": np.sqrt(6.2 - (7 / 3) ** 2 + 0.01)}
    for name, value in exact.items():
        low, high = results[0].estimate.sel(statistic=name).values[0, 1:]
        assert low < value < high, name
    page = (tmp_path / "one" / "power" / "multifidelity.html").read_text("utf-8")
    headline = results[0].answer.splitlines()[0].removesuffix(".")
    assert headline in unescape(page).replace("\xa0", " ")
    assert page.count("<figure") == 1


@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
def test_statistics_are_those_of_the_slow_model_of_impacts(tmp_path):
    """Held against plain runs of the slow model at other draws."""
    result = il.multifidelity(impacts(tmp_path), FINE, workers=1)
    rng = np.random.default_rng(5)
    varied = {
        "velocity": rng.uniform(1.5, 2.5, 1000),
        "beam_depth": rng.uniform(26e-3, 29e-3, 1000),
    }
    plain = il.simulate_many(
        il.paper_impact(), il.Discretisation(**FINE), duration="0.8 ms", varied=varied
    )
    for name in ("peak_force", "maximum_indentation"):
        values, row = plain[name].values, result.sel(response=name)
        for statistic, value in (("mean", values.mean()), ("standard_deviation", values.std())):
            _, low, high = row.estimate.sel(statistic=statistic).values
            assert low - 0.05 * values.std() < value < high + 0.05 * values.std()
    beyond = np.mean(plain["peak_force"].values > 26e3)
    _, low, high = result.estimate.sel(response="peak_force", statistic="exceedance").values
    assert low - 0.03 < beyond < high + 0.03
    assert result.slow_seconds > 2 * result.fast_seconds
    assert result.saving.sel(statistic="mean").min() > 3
    assert "one core" in result.answer


def test_a_budget_sets_the_numbers_of_both_models(tmp_path):
    result = il.multifidelity(impacts(tmp_path), FINE, budget="0.1 s", workers=1)
    pairs, runs = int(result.pairs), int(result.runs)
    cost = pairs * result.slow_seconds + (runs - pairs) * result.fast_seconds
    assert cost.item() == pytest.approx(0.1, rel=0.05)
    assert (runs - pairs) / pairs == pytest.approx(result.best_ratio.item(), rel=0.02)
    with pytest.raises(
        ValueError, match="budget = 1 ms: 20 runs of the slow model alone need about"
    ):
        il.multifidelity(impacts(tmp_path), FINE, budget="1 ms", workers=1)


def test_the_report_of_the_study_tells_the_answer(tmp_path, page_of):
    answer = il.multifidelity(study(tmp_path), {"power": 2}, runs=500, workers=1).answer
    headline = answer.splitlines()[0].removesuffix(".").replace("'", "&#39;")
    page = page_of(study(tmp_path))
    assert f"Two models:</strong> {headline} (<a" in page
    assert 'href="multifidelity.html"' in page


def test_a_study_with_a_slow_model_opens_with_its_answer(tmp_path, page_of):
    powers = study(tmp_path, multifidelity={"high": {"power": 2}, "pairs": 30, "runs": 500})
    runs = powers.run(workers=1)
    other = il.multifidelity(study(tmp_path / "other"), {"power": 2}, pairs=30, runs=500, workers=1)
    headline = other.answer.splitlines()[0]
    assert il.answers(runs, powers.analyse())[0] == headline
    page = unescape(page_of(powers)).replace("\xa0", " ")
    assert page.index(headline.removesuffix(".")) < page.index("The sample alone")
    assert page.index("Statistics of the slow model") < page.index('<section id="results"')
    assert (tmp_path / "power" / "multifidelity.html").is_file()
    section = il.multifidelity(powers, workers=1)  # all settings are the study's
    np.testing.assert_array_equal(section.estimate, other.estimate)
    (tmp_path / "power" / "multifidelity.nc").unlink()
    unsolved = il.answers(runs, powers.analyse())
    assert unsolved[0] == "No answer yet with power 2."
    assert "`impactlab run` solves the runs that it needs" in unsolved[1]


def test_an_automatic_grid_is_that_of_the_fast_model_alone(tmp_path):
    section = {"high": {"nodes": 101, "scheme": "leapfrog"}, "pairs": 20, "runs": 40}
    auto = {"scheme": "modal", "auto": {"tolerance": 0.1, "responses": ["peak_force"]}}
    impact = impacts(tmp_path, discretisation=auto, multifidelity=section, duration="1 ms")
    assert impact.estimate(workers=1).seconds > impacts(tmp_path).estimate(workers=1).seconds
    text = impact.declared.text
    (tmp_path / "auto.yaml").write_text(text)
    assert describe(tmp_path / "auto.yaml")["traits"] == ["auto", "sample", "multifidelity"]


def test_indices_are_those_of_the_slow_model(tmp_path):
    """The noise hardly matters to the slow model, and half as much again to the fast one."""

    def linear(x, noise, power):
        return power * x + noise + 0.02 * x**2

    parameters = {"x": il.Normal(0, 1), "noise": il.Normal(0, 1), "power": 2.5}
    sampling = il.Pawn(samples=128, parameters=parameters)
    linears = [
        study(tmp_path / name, linear, sampling=sampling, limits=None) for name in ("one", "two")
    ]
    results = [
        il.multifidelity(linears[row], {"power": 3}, runs=500, indices=True, workers=row + 1)
        for row in range(2)
    ]
    np.testing.assert_array_equal(results[0].slow_index, results[1].slow_index)
    for parameter, exact in (("x", 0.9), ("noise", 0.1)):
        for order in ("first_order", "total_order"):
            index = results[0].slow_index.sel(parameter=parameter, order=order).values[0]
            assert index[1] < exact < index[2]
            assert index[2] - index[1] < 0.15
    assert "Sensitivity: the value scatters with x 9" in results[0].answer
    page = (tmp_path / "one" / "power" / "multifidelity.html").read_text("utf-8")
    assert "Sobol indices of the slow model" in page


def test_pairs_without_an_answer_are_left_out_and_counted_and_have_no_indices(tmp_path):
    result = il.multifidelity(
        study(tmp_path, sometimes_failing), {"power": 2}, runs=500, indices=True, workers=1
    )
    assert result.slow_index.isnull().all()
    missing = int(result.slow.isnull().sum())
    assert f"no indices of the value: {missing} runs have no answer" in result.answer
    assert result.missing.item() == missing > 0
    left_out = f"are left out: these may be the extreme ones (up to {missing} a response)"
    assert left_out in result.answer
    assert "missing_runs" in result.verdict.attrs["flag_meanings"].split()[int(result.verdict)]


def test_correlated_parameters_have_no_indices_of_a_slow_model(tmp_path):
    parameters = {"x": il.Uniform(0, 1), "noise": il.Normal(0, 1), "power": 1.7}
    sampling = il.Pawn(samples=128, parameters=parameters, correlations=[("x", "noise", 0.5)])
    with pytest.raises(il.StudyError, match="assume independent parameters"):
        il.multifidelity(
            study(tmp_path / "two", sampling=sampling), {"power": 2}, runs=500, indices=True
        )


def test_a_statistic_that_is_not_sound_is_refused_with_its_reason(tmp_path):
    """The fast model hardly correlates, and no run exceeds the limit."""

    def unlike(x, noise, power):
        return x if power == 2 else 0.5 * x + noise

    result = il.multifidelity(study(tmp_path, unlike), {"power": 2}, runs=500, workers=1)
    row = result.sel(response="value")
    assert np.isfinite(row.estimate.sel(statistic="mean")).all()
    assert "correlate by" in row.refusal.sel(statistic="standard_deviation").item()
    assert "0 of 40 slow runs exceed it" in row.refusal.sel(statistic="exceedance").item()
    assert "Caution: the models hardly correlate" in result.answer


@pytest.mark.slow
def test_three_dimensional_runs_are_those_at_the_first_draws(tmp_path):
    parameters = {"velocity": il.Uniform("1 m/s", "2 m/s")}
    short = impacts(
        tmp_path,
        duration="0.01 ms",
        responses=["energy_error"],
        limits=None,
        sampling=il.Pawn(samples=128, parameters=parameters),
    )
    high = {"beam_model": "solid", "element_size": "4 mm"}
    result = il.multifidelity(short, high, pairs=20, runs=40, workers=2)
    draw = ndtr(np.random.default_rng([1, 39]).standard_normal())
    alone = solve(il.paper_impact(1 + draw), element_size=4e-3, duration=1e-5)
    assert result.slow.values[0, 0] == pytest.approx(alone.energy_error.item(), rel=1e-9)
    assert result.slow.notnull().all()
    assert result.slow_seconds.item() > result.fast_seconds.item()


@pytest.mark.parametrize(
    ("changes", "high", "settings", "reason"),
    [
        ({}, {}, {}, "state what the slow model has in place"),
        ({}, {"x": 1}, {}, "x is drawn, and both models have the same draws"),
        ({}, {"power": 2}, {"runs": 0}, "runs: must be stated, because what functions cost"),
        ({}, {"power": 2}, {"pairs": 5}, "pairs = 5: must be a whole number of at least 20"),
        ({}, {"power": 2}, {"budget": -1.0}, "budget = -1.0: must be positive"),
        (
            {
                "sampling": il.Grid(parameters={"x": [1, 2], "noise": [3], "power": [1]}),
                "limits": None,
            },
            {"power": 2},
            {},
            "use any method but grid",
        ),
    ],
)
def test_what_cannot_be_estimated_is_refused(tmp_path, changes, high, settings, reason):
    with pytest.raises(ValueError, match=reason):
        il.multifidelity(study(tmp_path, **changes), high, **({"runs": 500} | settings), workers=1)


@pytest.mark.parametrize(
    ("section", "reason"),
    [
        ({}, "multifidelity.high: is required"),
        ({"high": {}}, "multifidelity.high: is empty"),
        ({"high": {"nodes": 4}}, r"multifidelity.high: sampling.parameters.nodes.value: "),
        ({"high": {"velocity": 1}}, "multifidelity.high: velocity is drawn"),
        ({"high": FINE, "pairs": 5}, "multifidelity.pairs = 5: must be at least 20"),
        ({"high": FINE, "budget": "1 m"}, "multifidelity.budget = '1 m'"),
        ({"high": FINE, "pair": 40}, "multifidelity.pair = 40: unknown key; did you mean"),
    ],
)
def test_a_wrong_slow_model_of_a_study_is_refused_at_its_key(tmp_path, section, reason):
    with pytest.raises(il.StudyError, match=reason):
        impacts(tmp_path, multifidelity=section)


def test_a_slow_model_needs_a_sample_and_a_function_the_number_of_runs(tmp_path):
    section = {"high": {"power": 2}}
    with pytest.raises(il.StudyError, match=r"multifidelity\.runs: must be stated"):
        study(tmp_path, multifidelity=section)
    grid = il.Grid(parameters={"x": [1, 2], "noise": [3], "power": [1]})
    with pytest.raises(il.StudyError, match="multifidelity: draws from distributions"):
        study(tmp_path, sampling=grid, limits=None, multifidelity=section | {"runs": 500})


def test_values_that_a_study_cannot_have_are_refused_at_their_key(tmp_path):
    for high, reason in (
        ({"node": 41}, "the slow model: sampling.parameters.node"),
        ({"beam_model": "solid"}, "discretisation.element_size: is required"),
    ):
        with pytest.raises(il.StudyError, match=reason):
            il.multifidelity(impacts(tmp_path), high, workers=1)


def with_words(x, noise, law, count, power):
    return (1 + x) ** power + 0.1 * noise + (law == "b") + 0.1 * count


def mixed(folder, **changes):
    varied = {"x": il.Uniform(0, 1), "noise": il.Normal(0, 1), "power": 1.7}
    varied |= {"law": il.Choice(["a", "b", "c"]), "count": il.Integers(1, 5)}
    sampling = il.Sobol(base_samples=64, parameters=varied)
    return study(folder, with_words, sampling=sampling, **changes)


@pytest.mark.slow
def test_answers_of_the_slow_model_are_predicted_where_pairs_are(tmp_path):
    """Words and whole numbers among the parameters, the noise at its median."""
    points = {"x": [0.5, 2, 0.9], "law": "b", "count": [2, 3, 3]}
    results = [
        il.multifidelity(
            mixed(tmp_path / str(n)), {"power": 2}, runs=500, workers=n, predict=points
        )
        for n in (1, 2)
    ]
    np.testing.assert_array_equal(results[0].prediction, results[1].prediction)
    answer = results[0].sel(response="value")
    assert answer.prediction.x.values.tolist() == points["x"]
    assert answer.prediction.noise.values.tolist() == [0.0] * 3
    exact = [with_words(x, 0.0, "b", count, 2) for x, count in ((0.5, 2), (0.9, 3))]
    value, low, high = answer.prediction.isel(point=[0, 2]).values.T
    np.testing.assert_allclose(value, exact, atol=0.03)
    assert ((low <= exact) & (exact <= high)).all()
    assert answer.prediction[1].isnull().all()
    assert answer.prediction_refusal.values[1].startswith("x 2 is beyond the pairs, 0.0")
    assert "Prediction: at x 0.5, law b, count 2 the value is 3.4" in results[0].answer
    assert "--predict x=0.5,2,0.9 --predict law=b --predict count=2,3,3" in results[0].arguments
    page = unescape((tmp_path / "1" / "power" / "multifidelity.html").read_text("utf-8"))
    assert "Predictions of the slow model" in page
    assert "x 2 is beyond the pairs" in page
    section = {"high": {"power": 2}, "runs": 500, "predict": points}
    same = il.multifidelity(mixed(tmp_path / "2", multifidelity=section), workers=1)
    np.testing.assert_array_equal(same.prediction, results[0].prediction)


@pytest.mark.parametrize(
    ("points", "reason"),
    [
        ({"law": "b", "power": 1}, "predict.power: unknown drawn parameter; choose from x, noise"),
        ({"x": 0.5}, "predict: words have no median: state law, a, b, c"),
        ({"law": "z"}, "predict.law = 'z': unknown word"),
        ({"law": "a", "count": 2.5}, "predict.count = 2.5: is not drawn: steps of 1 from 1 to 5"),
        ({"law": "a", "x": [0, 1], "noise": [1, 2, 3]}, "predict: lists of 2 and 3 values"),
        ({"law": "a", "x": "1 kg"}, "predict.x = '1 kg'"),
    ],
)
def test_points_that_are_never_drawn_are_refused_at_their_key(tmp_path, points, reason):
    section = {"high": {"power": 2}, "runs": 500, "predict": points}
    with pytest.raises(il.StudyError, match=f"multifidelity.{reason}"):
        mixed(tmp_path, multifidelity=section)


def test_predictions_alone_need_scikit_learn_and_enough_pairs_with_answers(tmp_path, monkeypatch):
    settings = {"high": {"power": 2}, "runs": 500, "workers": 1}
    failing = study(tmp_path, sometimes_failing)
    answer = il.multifidelity(failing, **settings, pairs=20, predict={"x": 0.5})
    assert answer.prediction.isnull().all()
    assert answer.prediction_refusal.item() == "has 18 runs: at least 20"
    monkeypatch.setitem(sys.modules, "sklearn", None)
    il.multifidelity(failing, **settings)
    with pytest.raises(OSError, match=r"scikit-learn: pip install 'impactlab\[kriging\]'"):
        il.multifidelity(failing, **settings, predict={"x": 0.5})


@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
def test_impacts_are_predicted_with_correlated_parameters(tmp_path):
    parameters = {
        "velocity": il.Uniform("1.5 m/s", "2.5 m/s"),
        "beam_depth": il.Uniform("26 mm", "29 mm"),
    }
    sampling = il.Pawn(
        samples=128, parameters=parameters, correlations=[("velocity", "beam_depth", 0.6)]
    )
    points = {"velocity": ["1.8 m/s", 2.2], "beam_depth": "27 mm"}
    result = il.multifidelity(
        impacts(tmp_path, sampling=sampling), FINE, pairs=20, predict=points, workers=1
    )
    varied = {"velocity": [1.8, 2.2], "beam_depth": [27e-3] * 2}
    plain = il.simulate_many(
        il.paper_impact(), il.Discretisation(**FINE), duration="0.8 ms", varied=varied
    )
    _, low, high = result.prediction.sel(response="peak_force").values.T
    assert ((low <= plain.peak_force) & (plain.peak_force <= high)).all()
    assert (high - low < 0.02 * low).all()
