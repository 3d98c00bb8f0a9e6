"""Regimes of made-up distributions, and jumps of made-up curves."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr

from impactlab.analysis.analyse import analyse
from impactlab.analysis.regimes import cuts, jumps, of_runs
from impactlab.report.answer import answers
from impactlab.variables import described

Draw = Callable[[np.random.Generator, int], Any]


def _mixture(*shares):
    def values(rng, size):
        centres = np.array([0.155, 0.285, 0.39])
        return centres[rng.choice(len(shares), size, p=shares)] + 0.008 * rng.normal(size=size)

    return values


ONE_REGIME: dict[str, Draw] = {
    "normal": lambda rng, size: rng.normal(size=size),
    "lognormal": lambda rng, size: np.exp(2 * rng.normal(size=size)),
    "cauchy": lambda rng, size: rng.standard_cauchy(size),
    "arcsine": lambda rng, size: np.sin(2 * np.pi * rng.random(size)),
    "sigmoid": lambda rng, size: 1 / (1 + np.exp(-20 * (rng.random(size) - 0.5))),
    "root": lambda rng, size: np.sqrt(np.maximum(rng.random(size) - 0.3, 0)),
    "outliers": lambda rng, size: np.append(rng.normal(size=size - 4), 50 + np.arange(4)),
    "counts": lambda rng, size: rng.poisson(1.0, size),
}


@pytest.mark.parametrize("size", [100, 1000])
@pytest.mark.parametrize("name", ONE_REGIME)
def test_one_regime_raises_few_false_alarms(name, size):
    draws = (ONE_REGIME[name](np.random.default_rng(seed), size) for seed in range(100))
    assert sum(cuts(values).size > 0 for values in draws) <= 2


@pytest.mark.parametrize("shares", [(0.86, 0.08, 0.06), (0.86, 0.14), (0.97, 0.03)])
def test_regimes_are_found_and_counted(shares):
    draw = _mixture(*shares)
    sizes = [cuts(draw(np.random.default_rng(seed), 1000)).size for seed in range(50)]
    assert sizes.count(len(shares) - 1) >= 48


@pytest.mark.parametrize("points", [8, 24, 50])
def test_smooth_curves_do_not_jump(points):
    x = np.linspace(0.05, 1.0, points)
    for curve in (x**-0.5, x**3, np.sin(9 * x), np.maximum(x - 0.5, 0), np.tanh(4 * x - 2)):
        assert not jumps(x, curve).size


def test_a_jump_is_where_it_is_and_missing_values_hide_it():
    x = np.array([0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 17.0, 18.0, 19.0, 20.0])
    y = x**-0.3 + 0.5 * (x > 17.5)
    assert jumps(x, y).tolist() == [7]
    y[9] = np.nan
    assert not jumps(x, y).size


@pytest.fixture(scope="module")
def runs():
    """Draws of two parameters; the contact lasts twice as long where the first is large."""
    x = np.random.default_rng(1).random((600, 2))
    duration = 1e-4 * (1.5 + 1.5 * (x[:, 0] > 0.8) + 0.1 * x[:, 1])
    limits = {"distribution": "uniform", "low": 0.0, "high": 1.0}
    return xr.Dataset(
        {
            "contact_duration": ("run", duration, {"units": "s"}),
            "peak_force": ("run", 1e4 * (1 + x.sum(axis=1)), {"units": "N"}),
            "status": ("run", np.zeros(600, np.int32)),
        },
        {
            "run": np.arange(600),
            "velocity": ("run", x[:, 0], limits | {"units": "m/s"}),
            "beam_depth": ("run", x[:, 1], limits | {"units": "m"}),
        },
        {
            "method": "pawn",
            "samples": 600,
            "seed": 1,
            "resamples": 20,
            "slides": 10,
            "varied": ["velocity", "beam_depth"],
            "responses": ["contact_duration", "peak_force"],
        },
    )


def test_the_answer_tells_regimes_first_and_gives_no_indices(runs):
    analysis = analyse(runs)
    flags = analysis["sensitivity_verdict"].attrs["flag_meanings"].split()
    codes = analysis["sensitivity_verdict"].values
    assert flags[codes[0]] == "several_regimes"
    assert flags[codes[1]] != "several_regimes"
    for name in ("pawn", "surrogate_total_order"):
        assert np.isnan(analysis[name][0]).all()
        assert np.isfinite(analysis[name][1]).all()
    surrogates = analysis["surrogate_verdict"]
    assert surrogates.attrs["flag_meanings"].split()[int(surrogates[0])] == "jumps"
    _, regimes, doubts = answers(described(runs), analysis)
    assert regimes.startswith("Contact duration in several regimes: 0.15 to 0.16 ms in ")
    assert "larger impact velocity" in regimes
    assert doubts.endswith("contact duration (several regimes).")


def test_words_that_lead_from_one_regime_to_the_other_are_no_regimes(runs):
    words = np.where(runs["velocity"] > 0.8, "hertz", "stronge")
    choice = {"distribution": "choice", "values": ["hertz", "stronge"], "weights": [0.2, 0.8]}
    varied = {"varied": ["velocity", "beam_depth", "contact"]}
    chosen = runs.assign_coords(contact=("run", words, choice)).assign_attrs(varied)
    assert of_runs(runs, "contact_duration").size == 1
    assert not of_runs(chosen, "contact_duration").size
    shuffled = np.random.default_rng(2).permutation(words)
    assert of_runs(chosen.assign_coords(contact=("run", shuffled, choice)), "contact_duration").size


def test_the_answer_tells_where_a_grid_jumps():
    velocity = np.arange(10.0, 22.0)
    duration = 1e-4 * (1.5 + 1.2 * (velocity > 17)) + 1e-6 * velocity
    runs = xr.Dataset(
        {
            "contact_duration": ("velocity", duration, {"units": "s"}),
            "status": ("velocity", np.zeros(12, np.int32)),
        },
        {"velocity": ("velocity", velocity, {"units": "m/s"})},
        {"varied": ["velocity"], "responses": ["contact_duration"]},
    )
    first = answers(described(runs), analyse(runs))[0]
    assert first == (
        "From 10 to 21 m/s of impact velocity the contact duration rises from 0.16 to 0.167 ms, "
        "then jumps to 0.288 ms between 17 and 18 m/s."
    )
