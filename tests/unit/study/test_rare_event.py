"""Rare events of studies: stored runs, workers, words, refusals."""

import sys

import numpy as np
import pytest
import xarray as xr
from scipy.stats import norm

import impactlab as il
from impactlab.study import engine

pytestmark = pytest.mark.usefixtures("blank_pictures")


def load_minus_strength(load, strength):
    return load - strength


def study(folder, function=load_minus_strength, **changes):
    sampling = il.Pawn(
        samples=128, parameters={"load": il.Normal(5, 1), "strength": il.Normal(11, 1)}
    )
    arguments = {"sampling": sampling, "limits": {"value": 0}} | changes
    return il.Study(title="Load", function=function, results=folder, **arguments)


def test_runs_are_kept_and_give_the_same_bits_for_any_number_of_workers(tmp_path, monkeypatch):
    clients, client = [], engine._here
    monkeypatch.setattr(engine, "_here", lambda *a, **kw: clients.append(a) or client(*a, **kw))
    first = il.rare_event(study(tmp_path / "one"), workers=1)
    assert len(clients) == 1, "each level has a client of its own"
    again = il.rare_event(study(tmp_path / "one"), workers=1)
    assert len(clients) == 1, "a client is opened for runs that are stored"
    other = il.rare_event(study(tmp_path / "two"), workers=2)
    assert first.probability.item() == again.probability.item() == other.probability.item()
    np.testing.assert_array_equal(first.design_point, other.design_point)
    exact = norm.sf(6 / np.sqrt(2))
    assert first.low < exact < first.high
    assert "likeliest way to exceed it: " in first.answer
    assert "strength −" in first.answer
    assert "load +" in first.answer
    page = (tmp_path / "one" / "load" / "rare_event.html").read_text("utf-8")
    assert first.answer.splitlines()[0].removesuffix(".") in page.replace("\xa0", " ")
    assert page.count("<figure") == 1


@pytest.mark.slow
def test_a_study_places_runs_until_its_probability_is_known(tmp_path, page_of):
    until = {"coefficient_of_variation": 0.1, "runs": 700}
    parameters = {"load": il.Normal(5, 1), "strength": il.Normal(11, 1)}
    plain = study(tmp_path / "plain")
    sampling = il.Pawn(samples=128, parameters=parameters, until=until)
    grown = study(tmp_path / "grown", sampling=sampling)
    assert grown.run(workers=1).sizes["run"] == 128
    page = page_of(grown)
    result = il.rare_event(plain, surrogate=True, runs=700, workers=2)
    headline = result.answer.splitlines()[0].removesuffix(".")
    assert page.index(headline) < page.index("The likeliest way") < page.index("The sample alone")
    stored = xr.open_dataset(grown.folder / "rare_event.nc")
    assert stored.probability.item() == result.probability.item()
    assert stored.attrs["arguments"] == " --surrogate --runs 700"
    assert result.low < norm.sf(6 / np.sqrt(2)) < result.high


@pytest.mark.parametrize("surrogate", [False, True])
def test_correlations_are_those_of_the_copula(tmp_path, surrogate):
    parameters = {"load": il.Normal(5, 1), "strength": il.Normal(11, 1)}
    pairs = [("load", "strength", -0.5)]
    sampling = il.Pawn(samples=128, seed=2, parameters=parameters, correlations=pairs)
    rare = il.rare_event(study(tmp_path, sampling=sampling), surrogate=surrogate, workers=1)
    linear = 2 * np.sin(np.pi * -0.5 / 6)
    exact = norm.sf(6 / np.sqrt(2 - 2 * linear))
    assert rare.low < exact < rare.high
    assert rare.first_order == pytest.approx(exact, rel=0.3)
    # on the limit load and strength differ by nothing: both are three deviations away
    np.testing.assert_allclose(rare.design_point, [3, -3], atol=0.4)


def test_words_are_drawn_with_their_weights(tmp_path):
    def response(grade, load):
        return load + {"good": 0.0, "poor": 2.0}[grade]

    sampling = il.Pawn(
        samples=256,
        parameters={
            "grade": il.Choice(["good", "poor"], weights=[9, 1]),
            "load": il.Normal(0, 1),
        },
    )
    rare = il.rare_event(
        study(tmp_path, response, sampling=sampling, limits={"value": 5}), workers=1
    )
    exact = 0.1 * norm.sf(3) + 0.9 * norm.sf(5)
    assert rare.low < exact < rare.high
    assert "grade poor" in rare.answer
    assert np.isnan(rare.first_order), "no plane lies along words"


@pytest.mark.slow
def test_a_process_places_the_same_runs_for_any_number_of_workers(tmp_path, page_of):
    first = il.rare_event(study(tmp_path / "one"), surrogate=True, workers=1)
    stored = sorted((tmp_path / "one" / "load" / "rare_event").rglob("*.npz"))
    assert stored
    times = [file.stat().st_mtime_ns for file in stored]
    again = il.rare_event(study(tmp_path / "one"), surrogate=True, workers=1)
    assert times == [file.stat().st_mtime_ns for file in stored], "runs were solved again"
    other = il.rare_event(study(tmp_path / "two"), surrogate=True, workers=2)
    assert first.probability.item() == again.probability.item() == other.probability.item()
    assert first.low < norm.sf(6 / np.sqrt(2)) < first.high
    assert first.runs < 400
    assert "for a Gaussian process" in first.answer
    assert first.attrs["arguments"] == " --surrogate"
    # the report of the study tells the answer
    page = page_of(study(tmp_path / "one"))
    answer = first.answer.splitlines()[0].removesuffix(".")
    assert f"Rare event:</strong> {answer} (<a" in page
    assert 'href="rare_event.html"' in page
    page = page_of(study(tmp_path / "one", limits={"value": 1}), replace=True)
    assert "of an earlier text of this study, not of these runs (<a" in page


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"limits": None}, "limits: state 0 limits"),
        (
            {"sampling": il.Grid(parameters={"load": [1, 2], "strength": [3]}), "limits": None},
            "use any method but grid",
        ),
    ],
)
def test_studies_without_distributions_or_limit_are_refused(tmp_path, changes, reason):
    with pytest.raises(il.StudyError, match=reason):
        il.rare_event(study(tmp_path, **changes), workers=1)


def test_settings_out_of_range_are_refused(tmp_path):
    for settings in (
        {"samples": 10},
        {"runs": 500},
        {"runs": 200, "surrogate": True},
        {"coefficient_of_variation": 2.0},
    ):
        with pytest.raises(ValueError, match=next(iter(settings))):
            il.rare_event(study(tmp_path), workers=1, **settings)


def test_a_process_needs_an_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "sklearn", None)
    with pytest.raises(OSError, match=r"scikit-learn: pip install 'impactlab\[kriging\]'"):
        il.rare_event(study(tmp_path), surrogate=True, workers=1)


def test_a_process_of_many_parameters_is_refused(tmp_path):
    names = [f"x{number}" for number in range(17)]
    sampling = il.Pawn(samples=128, parameters={name: il.Normal(0, 1) for name in names})
    function = lambda **values: sum(values.values())  # noqa: E731
    many = study(tmp_path, function, sampling=sampling)
    with pytest.raises(ValueError, match="at most 16 parameters, and 17 vary"):
        il.rare_event(many, surrogate=True, workers=1)


def test_many_parameters_take_more_runs_per_level(tmp_path):
    names = [f"u{number}" for number in range(30)]
    total = eval(f"lambda {', '.join(names)}: {' + '.join(names)}")
    sampling = il.Pawn(samples=128, parameters={name: il.Normal(0, 1) for name in names})
    declared = study(tmp_path, function=total, sampling=sampling, limits={"value": 20})
    with pytest.raises(ValueError, match="samples = 500: must be at least 750, which is 25 per"):
        il.rare_event(declared, workers=1)
