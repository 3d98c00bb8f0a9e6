"""Rank correlations between the parameters of a sample."""

import json

import numpy as np
import pytest
import xarray as xr
from scipy import stats

import impactlab as il
from impactlab.methods import METHODS
from impactlab.methods.hypercube import Hypercube, contradicting
from impactlab.methods.runs import correlations
from impactlab.study.schema.readers import study_of_text
from impactlab.validation.errors import StudyError

NUMBERS = {
    "beam_depth": {"distribution": "uniform", "low": 0.02, "high": 0.03},
    "velocity": {"distribution": "lognormal", "median": 2, "geometric_standard_deviation": 1.2},
    "beam_yield_stress": {"distribution": "normal", "mean": 3e8, "standard_deviation": 1e7},
    "gravity": {"distribution": "triangular", "low": 5, "mode": 6, "high": 10},
}
OTHERS = {
    "contact": {"distribution": "choice", "values": ["mjg", "brake"]},
    "beam_width": {"distribution": "fixed", "value": 0.06},
}
RANKS = {
    ("beam_depth", "beam_yield_stress"): -0.6,
    ("velocity", "beam_yield_stress"): 0.7,
    ("beam_depth", "velocity"): -0.3,
}
GIVEN = [[*pair, rank] for pair, rank in RANKS.items()]
PAWN = {"method": "pawn", "samples": 100, "correlations": GIVEN, "parameters": NUMBERS}
OWN = {"sobol": {"base_samples": 8}, "morris": {"trajectories": 4}, "fast": {"samples": 1188}}


@pytest.fixture
def read():
    """Read a study of all parameters with these correlations."""

    def made(given=GIVEN, method="delta", study=None, **others):
        section = {"method": method, "correlations": given, "parameters": NUMBERS | OTHERS}
        section |= others if method in OWN else {"samples": 400} | others
        whole = {"title": "-", "impact": {"base": "paper"}, "duration": 5e-4, "sampling": section}
        return study_of_text("some", json.dumps(whole | (study or {})))

    return made


@pytest.fixture
def problem(read):
    """Return key and message of the one problem."""

    def found(*args, **others):
        with pytest.raises(StudyError) as error:
            read(*args, **others)
        (one,) = error.value.args
        return one.key.removeprefix("sampling."), str(one)

    return found


def test_ranks_are_those_of_a_gaussian_copula(read):
    """Spearman's coefficient as asked for, and Kendall's as only this copula has it (Kruskal)."""
    number = 20_000
    drawn = read(samples=number).sampling.columns()
    for one, other in [*RANKS, ("gravity", "velocity")]:
        rank = RANKS.get((one, other), 0.0)
        spearman = stats.spearmanr(drawn[one], drawn[other]).statistic
        kendall = stats.kendalltau(drawn[one], drawn[other]).statistic
        scatter = (1 - rank**2) / np.sqrt(number)  # at most
        assert spearman == pytest.approx(rank, abs=2.5 * scatter)
        exact = 2 / np.pi * np.arcsin(2 * np.sin(np.pi * rank / 6))
        assert kendall == pytest.approx(exact, abs=2.5 * scatter)


def test_margins_and_parameters_without_partners_stay_as_they_are(read):
    joined, alone = (read(given).sampling.columns() for given in (GIVEN, []))
    for name, values in joined.items():
        np.testing.assert_array_equal(np.sort(values), np.sort(alone[name]))
    moved = {name for name, values in joined.items() if not np.array_equal(values, alone[name])}
    assert moved == {"velocity", "beam_yield_stress"}  # depth is the first of the three


def test_methods_share_their_runs_and_the_design_names_the_pairs(read, designed, tmp_path):
    def stored(design):
        xr.Dataset(attrs=design.attrs).to_netcdf(tmp_path / "design.nc")
        return xr.load_dataset(tmp_path / "design.nc")

    delta, pawn = (designed(read(method=method).text) for method in ("delta", "pawn"))
    np.testing.assert_array_equal(delta["velocity"], pawn["velocity"])
    assert correlations(stored(delta)) == [(*pair, rank) for pair, rank in RANKS.items()]
    assert correlations(stored(designed(read(GIVEN[:1]).text))) == [tuple(GIVEN[0])]
    assert correlations(designed(read([]).text)) == []


@pytest.mark.parametrize(
    ("given", "key", "words"),
    [
        (0.5, "", "expected a list of entries such as [beam_depth, beam_width, 0.5]"),
        ([["velocity", 0.5]], "", "expected a list of entries"),
        ([["velocity", "beam_depht", 0.5]], ".0.1", "did you mean 'beam_depth'?"),
        ([["beam_width", "velocity", 0.5]], ".0.0", "is fixed"),
        ([["velocity", "contact", 0.5]], ".0.1", "takes words, which have no order"),
        ([["velocity", "velocity", 0.5]], ".0.1", "name two different parameters"),
        ([*GIVEN, ["velocity", "beam_depth", 0.1]], ".3", "state each pair once"),
        ([["velocity", "gravity", 1]], ".0.2", "must be below 1"),
        ([["velocity", "gravity", -1.5]], ".0.2", "must be above -1"),
        ([["velocity", "gravity", ".nan"]], ".0.2", ""),
        ([["velocity", "gravity", True]], ".0.2", ""),
    ],
)
def test_a_mistake_is_one_problem_at_its_key(problem, given, key, words):
    where, said = problem(given)
    assert where == f"correlations{key}"
    assert words in said


def test_a_misspelt_key_is_told_the_right_one(problem):
    where, said = problem(study={"sampling": PAWN | {"correlation": GIVEN}})
    assert where == "correlation"
    assert "did you mean 'correlations'?" in said


def test_impossible_correlations_name_those_that_contradict(problem):
    follows = [["velocity", "gravity", 0.3]]
    for last, others in ((-0.9, 1), (None, 0)):  # left out: 0, which is as impossible
        given = [["beam_depth", "velocity", 0.9], ["velocity", "beam_yield_stress", 0.9]]
        given += [["beam_depth", "beam_yield_stress", last]] * others
        where, said = problem(follows + given)
        assert where == "correlations"
        assert "beam_depth with velocity 0.9, velocity with beam_yield_stress 0.9" in said
        assert "matrix of beam_depth, velocity, beam_yield_stress is not positive" in said


def test_a_matrix_of_ranks_may_be_possible_where_its_copula_is_not():
    """Ranks allow three times -1/2; three normal variables end at -6/π asin(1/4) = -0.483."""
    for rank, none in ((-0.482, True), (-0.484, False)):
        pairs = [("a", "b", rank), ("b", "c", rank), ("a", "c", rank)]
        assert (contradicting("abcd", pairs) == []) is none


@pytest.mark.parametrize(
    "method", sorted(name for name, kind in METHODS.items() if not issubclass(kind, Hypercube))
)
def test_other_methods_refuse_with_the_reason(problem, method):
    uniform = {"distribution": "uniform", "low": 1, "high": 2}
    numbers = dict.fromkeys(("velocity", "gravity"), [1, 2] if method == "grid" else uniform)
    given = [["velocity", "gravity", 0.5]]
    section = {"method": method, "correlations": given, "parameters": numbers}
    where, said = problem(study={"sampling": section | OWN.get(method, {})})
    assert where == "correlations"
    assert "method: latin, delta, hsic, pawn" in said
    assert "Morris and FAST indices assume independent parameters" in said


@pytest.mark.parametrize(
    ("study", "key"),
    [
        ({"analyses": ["surrogate"]}, "analyses"),
        ({"analysis": {"failed_runs": "impute"}}, "analysis.failed_runs"),
    ],
)
def test_no_surrogate_is_promised(problem, study, key):
    where, said = problem(study=study | {"sampling": PAWN})
    assert where == key
    assert "no surrogate is fitted over correlated parameters" in said


SLOPES, RANK = np.array([1.0, 2.0]), 0.5
LINEAR = 2 * np.sin(np.pi * RANK / 6)


def model(x, y, idle):
    return SLOPES[0] * x + SLOPES[1] * y


def test_indices_of_a_linear_model_are_known(tmp_path, monkeypatch):
    """The idle number, which the model never uses, shares with y."""
    monkeypatch.chdir(tmp_path)
    normal = il.Normal(0, 1)
    study = il.Study(
        title="Correlated",
        function=model,
        analysis={"resamples": 20},
        sampling=il.Regression(
            samples=1000,
            seed=2,
            parameters={"x": normal, "y": normal, "idle": normal},
            correlations=[("x", "y", RANK), ("y", "idle", RANK)],
        ),
    )
    runs = study.run(workers=1)
    indices = study.analyse()
    variance = SLOPES @ SLOPES + 2 * SLOPES.prod() * LINEAR
    exact = np.array([*SLOPES, 0]) / np.sqrt(variance)
    found = indices.isel(response=0)
    np.testing.assert_allclose(found["regression"], exact, atol=0.03)
    assert found["sensitivity_verdict"] == 0
    assert not any(str(key).startswith("surrogate") for key in indices)
    assert "The inputs are correlated (x, y and idle): " in il.answers(runs, indices)[0]
