"""From what varies to the table of cases: the same as run by run, and as strict."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest

import impactlab as il
from impactlab.fem3d.wing import SIZES
from impactlab.model.case_table import case_table
from impactlab.model.contact_compliance import TIMOSHENKO_OPTIONS
from impactlab.model.parameters import PARAMETERS, SECTION, flatten, with_values
from impactlab.solver import BEAM_MODELS, FLOW_LAWS, LOADS, RULES, SCHEMES
from impactlab.solver.contact import LAWS

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

IMPACT = il.paper_impact(15.0)
GRID = il.Discretisation(nodes=21, points=5)
DURATION = 2e-3
DOOR = import_module("impactlab.model.case_table")


def test_an_unknown_parameter_is_named_with_the_known_ones():
    with pytest.raises(ValueError, match=r"^run 0: unknown parameter 'weight': choose from"):
        case_table(IMPACT, GRID, duration=DURATION, varied={"weight": [1.0]})


RUNS = 40
RANDOM = np.random.default_rng(3)
NAMES = tuple(name for name in PARAMETERS if name not in {*SECTION, "further_spheres"})
"""Of any beam; those of one shape are in test_shapes."""
CONTRADICTING = (SIZES[1], "beam_rate_sensitivity", "strikes")
TOGETHER = tuple(name for name in NAMES if name not in CONTRADICTING)
WORDS = {"contact": LAWS, "beam_model": BEAM_MODELS[:2], "load": LOADS}
WORDS |= {name: (word,) for name, word in TIMOSHENKO_OPTIONS.items()}
WORDS |= {"beam_flow_law": FLOW_LAWS, "rule": RULES, "scheme": SCHEMES}
WORDS |= {"support_left": ("pinned",), "support_right": ("pinned",), "strike_position": (0.5,)}
WORDS |= {"damping_ratio": (0.0,)}
COUNTS = {"strikes": (1, 2, 91), "nodes": (5, 19, 1201), "points": (2, 3, 64)}


def any_values(name):
    """Values that every run may have beside any of the others."""
    if name == "shear_coefficient":
        return RANDOM.uniform(0.7, 1.0, RUNS)
    if choices := WORDS.get(name) or COUNTS.get(name):
        return RANDOM.choice(choices, RUNS)
    value = flatten(IMPACT, GRID).get(name) or {"sphere_mass": 1.4}.get(name, 1e9)
    return value * RANDOM.uniform(0.9, 1.1, RUNS)


@pytest.fixture
def one_by_one(monkeypatch):
    """The case table as it is when each run is made and checked alone."""

    def refuse(values):
        raise ValueError("no columns")

    def table(varied):
        with monkeypatch.context() as without:
            without.setattr(DOOR, "column", refuse)
            return case_table(IMPACT, GRID, duration=DURATION, varied=varied)

    return table


@pytest.mark.parametrize("names", [*((name,) for name in NAMES), TOGETHER])
def test_columns_give_the_table_of_single_runs_bit_by_bit(names, one_by_one, monkeypatch):
    varied = {name: any_values(name) for name in names}
    alone = one_by_one(varied)
    monkeypatch.setattr(DOOR, "_one_by_one", None)
    for form in (np.asarray, list, np.ndarray.tolist, lambda values: values.astype(object)):
        given = {name: form(values) for name, values in varied.items()}
        many = case_table(IMPACT, GRID, duration=DURATION, varied=given)
        assert many.tobytes() == alone.tobytes()
        assert many.dtype == alone.dtype


def test_ends_and_places_in_columns_are_those_of_single_runs(one_by_one):
    varied = {
        "support_left": ["pinned", "clamped", "free", "free"],
        "support_right": ["clamped", "free", "pinned", "free"],
        "strike_position": [0.5, 1.0, 0.05, 0.0],
        "velocity": [1.0, 2.0, 3.0, 4.0],
    }
    alone = one_by_one(varied)
    assert case_table(IMPACT, GRID, duration=DURATION, varied=varied).tobytes() == alone.tobytes()
    assert alone["strike_position"].tolist() == varied["strike_position"]
    varied["strike_position"][1] = 0.0
    with pytest.raises(
        ValueError, match=r"^run 1 .*: Impact\.strike_position = 0\.0: must be a share"
    ):
        case_table(IMPACT, GRID, duration=DURATION, varied=varied)
    varied["strike_position"][1] = 0.33
    with pytest.raises(ValueError, match=r"^run 1: strike_position = 0\.33: lies between two"):
        case_table(IMPACT, GRID, duration=DURATION, varied=varied)


WRONG = {
    "beam_density": [0, -1.0, np.nan, np.inf, "1 A", None, True],
    "beam_yield_stress": [210e9, np.nan],
    "beam_poissons_ratio": [-0.1, 0.5, np.nan],
    "beam_isotropic_hardening_modulus": [-1e-9, np.inf],
    "sphere_mass": [0, True],
    "beam_depth": [0.78, 1.0],
    "gravity": [-1.0],
    "contact": ["hooke", "", 0, None],
    "beam_model": ["Rigid", "spring-mass", 1],
    "rule": ["Lobatto"],
    "scheme": ["semi_implicit", "Leapfrog", 1, None],
    "nodes": [3, 20, 21.5, np.nan, "21", None, True],
    "points": [1, 2.5],
    "courant": [0, 1.0001],
}


@pytest.mark.parametrize(
    ("name", "wrong"), [(name, value) for name, values in WRONG.items() for value in values]
)
def test_a_refused_run_is_told_in_the_words_of_the_model(name, wrong):
    right = any_values(name).tolist()[0]
    with pytest.raises(ValueError, match=name.split("_")[-1]) as alone:
        with_values(IMPACT, GRID, {name: wrong})
    with pytest.raises(ValueError, match=r"^run 2: ") as among:
        case_table(IMPACT, GRID, duration=DURATION, varied={name: [right, right, wrong, right]})
    assert str(among.value) == f"run 2: {alone.value}"


def test_auto_stands_for_the_fastest_scheme_of_every_model_in_question():
    grid = il.Discretisation(scheme="auto")

    def chosen(**varied):
        cases = case_table(IMPACT, grid, duration=DURATION, varied=varied)
        return [SCHEMES[case.scheme] for case in cases]

    assert chosen() == ["modal"]
    assert chosen(beam_model=["elastic", "euler_bernoulli"]) == ["modal", "modal"]
    assert chosen(beam_model=["elastic", "timoshenko"]) == ["leapfrog", "leapfrog"]
    assert chosen(scheme=["auto", "leapfrog"]) == ["modal", "leapfrog"]
    run = il.simulate(IMPACT, replace(grid, nodes=21), duration=1e-6)
    assert run.scheme.item() == "modal"


@pytest.mark.parametrize("model", ["timoshenko", "spring_mass", "rigid"])
def test_the_run_is_named_whose_beam_has_no_such_scheme(model):
    varied = {"beam_model": ["elastic", model], "scheme": ["modal", "modal"]}
    words = rf"^run 1: scheme = 'modal': beam_model = '{model}'"
    with pytest.raises(ValueError, match=words):
        case_table(IMPACT, GRID, duration=DURATION, varied=varied)


def test_what_is_no_column_may_still_be_right(one_by_one):
    """A mass that follows from the density in some runs."""
    varied = {"sphere_mass": [None, 2.0], "velocity": [1, 2.0]}
    cases = case_table(IMPACT, GRID, duration=DURATION, varied=varied)
    assert cases["sphere_mass"].tolist() == [IMPACT.sphere.total_mass, 2.0]
    assert cases.tobytes() == one_by_one(varied).tobytes()
