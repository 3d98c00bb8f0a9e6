"""The kernels against the plain solver: same histories, strains and responses, case by case.

They differ in everything that makes the kernels fast (half the beam, half the fibres, elastic
intervals, wave front, sections left alone while far from yielding), so beyond rounding they may not
differ in their answers.
"""

from collections import Counter
from dataclasses import replace
from typing import Any, NamedTuple

import numba
import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.parameters import with_values
from impactlab.simulate import run_dataset
from impactlab.solve import fibre_section
from impactlab.solver import RULES, SCHEMES
from impactlab.solver.contact.history import make_pair
from impactlab.solver.stability import discretise
from impactlab.variables import FLAGS, HISTORIES, STATUS_FLAGS

from .. import plain_beam

pytestmark = [
    pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="takes hours as plain Python"),
    pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning"),
]

TOLERANCE = 1e-9
SHAKE, MOST_GROWTH = 1e-12, 25.0


RANGES = {
    "velocity": (0.1, 40.0),
    "gravity": (0.0, 50.0),
    "sphere_radius": (0.005, 0.05),
    "sphere_mass": (0.05, 5.0),
    "sphere_yield_stress": (200e6, 3e9),
    "beam_span": (0.2, 1.0),
    "beam_width": (0.01, 0.1),
    "beam_depth": (0.005, 0.05),
    "beam_yield_stress": (100e6, 1e9),
    "beam_isotropic_hardening_modulus": (-50e9, 50e9),
    "beam_kinematic_hardening_modulus": (-50e9, 50e9),
    "courant": (0.2, 1.0),
}
"""Least and largest values; a hardening modulus below zero is none."""
HARD = {"velocity": (5.0, 20.0), "sphere_mass": (0.5, 2.0), "beam_yield_stress": (100e6, 300e6)}


def drawn(random: np.random.Generator) -> dict[str, Any]:
    """Draw an impact and its discretisation: every other one is hard, one value in ten at an end.

    Not by hypothesis, whose draws resemble each other and depend on what else is imported: by
    chance, a feature of the model was then hardly met.
    """
    ranges = RANGES | (HARD if random.random() < 0.5 else {})
    if random.random() < 0.3:
        del ranges["sphere_mass"]  # that of the density
    unit = np.clip(random.uniform(-0.05, 1.05, len(ranges)), 0.0, 1.0)
    values = {
        name: max(low + share * (high - low), 0.0)
        for (name, (low, high)), share in zip(ranges.items(), unit, strict=True)
    }
    return values | {"points": int(random.integers(2, 22)), "rule": random.choice(RULES).item()}


HALVES = {"leapfrog": (2, 30), "modal": (2, 12)}
"""Least and most spacings in the half beam."""
MOST_STEPS = {"leapfrog": 6000, "modal": 4000}
EXAMPLES = 150


class Case(NamedTuple):
    """An impact and its discretisation; duration and dt in s."""

    impact: il.Impact
    grid: il.Discretisation
    duration: float
    dt: float
    steps: int

    def plain(self, shake: float = 0.0) -> plain_beam.Run:
        """Solve with the plain solver, the velocity changed by the share `shake`."""
        impact = replace(self.impact, velocity=self.impact.velocity * (1.0 + shake))
        return plain_beam.solve(impact, self.grid, self.dt, self.steps)

    def kernels(self) -> xr.Dataset:
        """Solve with the kernels, one sample per step."""
        return run_dataset(self.impact, self.grid, duration=self.duration, samples=self.steps + 1)


def make_case(values: dict[str, Any], steps: int) -> Case:
    """The paper's case with these values, over about so many of the kernels' time steps."""
    impact, grid = with_values(il.paper_impact(), il.Discretisation(), values)
    case = case_table(impact, grid, duration=1.0)[0]
    pair, section = make_pair(case), fibre_section(case)
    case.duration = steps * discretise(case, pair, section)[0].dt
    cut, steps = discretise(case, pair, section)
    return Case(impact, grid, float(case.duration), cut.dt, steps)


def difference(one: np.ndarray, other: np.ndarray, least: float = 0.0) -> float:
    """Return the largest difference over the largest value of `other` (at least `least`)."""
    return float(np.abs(one - other).max() / max(np.abs(other).max(), least))


def growth(case: Case, run: plain_beam.Run) -> float:
    """Return the factor by which the plain solver's histories magnify a change of velocity.

    The larger one of a faster and a slower sphere: by chance, one of them may show little of chaos.
    """
    shaken = [case.plain(share) for share in (SHAKE, -SHAKE)]
    changes = [difference(getattr(one, n), getattr(run, n)) for one in shaken for n in HISTORIES]
    return max(changes) / SHAKE


def assert_same(case: Case, run: plain_beam.Run, dataset: xr.Dataset) -> None:
    if dataset.status.item() & STATUS_FLAGS["diverged"][0]:
        assert dataset.drop_vars(list(FLAGS)).isnull().all().to_array().all()
        return
    for name in (*HISTORIES, "deflection"):
        assert difference(dataset[name].values, getattr(run, name)) < TOLERANCE, name
    material = case.impact.beam.material
    least = material.yield_stress / material.youngs_modulus
    peeq = dataset.equivalent_plastic_strain.values
    assert difference(peeq, run.peeq, least) < TOLERANCE
    assert difference(dataset.plastic_strain.values, run.plastic_strain, least) < TOLERANCE
    if not dataset.status.item() & STATUS_FLAGS["energy_out_of_balance"][0]:
        for name, expected in plain_beam.responses(case.impact, case.grid, run).items():
            approx = pytest.approx(expected, rel=TOLERANCE, abs=1e-15, nan_ok=True)
            assert dataset[name].item() == approx, name


def features(case: Case, run: plain_beam.Run, dataset: xr.Dataset) -> dict[str, bool]:
    """Return which features of the model a run shows."""
    material, deeper = case.impact.beam.material, np.diff(run.deepest) > 0
    return {
        "yields": bool(run.peeq.max() > 0),
        "yields in reverse": bool((run.peeq > np.abs(run.plastic_strain) * (1 + 1e-6)).any()),
        "hardens": bool(run.peeq.max() > 0 and material.isotropic_hardening_modulus > 0),
        "touches again": dataset.number_of_contacts.item() > 1,
        "loads further later": bool((deeper[1:] & ~deeper[:-1]).any()),
        "gives every answer": dataset.status.item() == 0,
    } | {name: name in (case.impact.contact, case.grid.rule) for name in (*plain_beam.LAWS, *RULES)}


@pytest.mark.parametrize("scheme", SCHEMES)
def test_same_answers_as_the_plain_solver(scheme):
    """Runs that bounce into chaos may differ: there no two codes agree, whoever is right."""
    seen: Counter[str] = Counter()
    random = np.random.default_rng(1)
    for law in list(plain_beam.LAWS) * (EXAMPLES // len(plain_beam.LAWS)):
        values = drawn(random) | {"contact": law, "scheme": scheme}
        values["nodes"] = 2 * int(random.integers(*HALVES[scheme], endpoint=True)) + 1
        most = MOST_STEPS[scheme] if random.random() < 0.7 else 60
        case = make_case(values, int(random.integers(10, most)))
        run, dataset = case.plain(), case.kernels()
        try:
            assert_same(case, run, dataset)
        except AssertionError:
            if growth(case, run) < MOST_GROWTH:
                raise
        else:
            seen.update(features(case, run, dataset))
    assert min(seen.values()) >= 15, seen


@pytest.mark.parametrize(
    ("values", "happens"),
    [
        (
            {"velocity": 5.0, "sphere_mass": 5.0, "nodes": 101, "points": 5},
            {"touches again", "loads further later", "yields"},
        ),
        (
            {
                "velocity": 40.0,
                "nodes": 281,
                "contact": "hertz",
                "beam_isotropic_hardening_modulus": 2e9,
                "beam_kinematic_hardening_modulus": 2e9,
            },
            {"yields", "yields in reverse", "hardens"},
        ),
    ],
    ids=["sub-impacts", "hardening"],
)
@pytest.mark.parametrize(("scheme", "steps"), [("leapfrog", 8000), ("modal", 4000)])
def test_larger_beams(values, happens, scheme, steps):
    case = make_case(values | {"scheme": scheme}, steps)
    run, dataset = case.plain(), case.kernels()
    assert happens <= {name for name, is_so in features(case, run, dataset).items() if is_so}
    assert_same(case, run, dataset)
