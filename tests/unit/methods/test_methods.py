"""The samples of every method."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from impactlab.methods import INDICES, METHODS, SAMPLES
from impactlab.methods.hypercube import Hypercube
from impactlab.variables import RESPONSES

SETTINGS = {
    "sobol": {"base_samples": 16, "second_order": False},
    "morris": {"trajectories": 12, "levels": 6},
    "fast": {"samples": 1188, "harmonics": 4},
    "latin": {"samples": 100, "indices": ["delta", "pawn"]},
}
SETTINGS |= {name: {"samples": 128} for name in METHODS if name not in SETTINGS}
del SETTINGS["grid"]
methods = pytest.mark.parametrize("method", SETTINGS)
designs = pytest.mark.parametrize("method", ["sobol", "morris", "fast", "latin"])


def test_every_method_but_the_grid_is_analysed_and_in_the_docs():
    assert SAMPLES.keys() - {"latin", "table"} == INDICES.keys()
    assert all(SAMPLES[name].label and SAMPLES[name].records[0].name == name for name in INDICES)
    docs = (Path(__file__).parents[3] / "docs" / "studies.md").read_text(encoding="utf-8")
    assert [name for name in SETTINGS if f"| `{name}` | " not in docs] == []
    # those that are not drawn below share the draws of a Latin hypercube
    others = SETTINGS.keys() - {"sobol", "morris", "fast"}
    assert {METHODS[name].draws for name in others} == {Hypercube.draws}


@designs
def test_every_seed_repeats_itself_and_differs_from_the_others(sampled, cube, method):
    """Seed 0 among them, which SALib takes for none in places."""
    first = {
        seed: cube(sampled(method, seed=seed, **SETTINGS[method])) for seed in (0, 1, 2**32 - 1)
    }
    for seed, draws in first.items():
        again = cube(sampled(method, seed=seed, **SETTINGS[method]))
        np.testing.assert_array_equal(again, draws)
    for one, other in pairwise(first.values()):
        assert not np.allclose(one, other)


@methods
def test_the_design_says_how_it_was_drawn(sampled, method):
    sample = sampled(method, seed=3, **SETTINGS[method])
    said = {key: sample.attrs[key] for key in ("method", "varied", "seed", *SETTINGS[method])}
    varied = ["velocity", "beam_depth", "gravity"]
    assert said == {"method": method, "varied": varied, "seed": 3} | SETTINGS[method]
    spread = "replicates" if method == "sobol" else "resamples"
    assert {"confidence", spread, "failed_runs"} <= sample.attrs.keys()
    assert not {"groups", "until", "until_interval", "parameters"} & sample.attrs.keys()
    assert sample["run"].values.tolist() == list(range(sample.sizes["run"]))
    expected = {"distribution": "uniform", "low": 0.0, "high": 10.0}
    assert sample["gravity"].attrs.items() >= (expected | {"units": "m s-2"}).items()
    assert sample.attrs["responses"] == list(RESPONSES)


@designs
def test_draws_keep_off_the_ends_of_the_ranges(sampled, cube, method):
    """There the quantiles of unbounded distributions are infinite."""
    draws = cube(sampled(method, **SETTINGS[method]))
    assert 0 < draws.min() < 0.05
    assert 0.95 < draws.max() < 1


@designs
def test_a_fixed_parameter_leaves_the_sample_as_it_is(sampled, cube, method):
    width = {"beam_width": {"distribution": "fixed", "value": "61 mm"}}
    mass = {"sphere_mass": {"distribution": "fixed", "value": 1.4}}
    law = {"contact": {"distribution": "fixed", "value": "hertz"}}
    with_it = sampled(method, width | mass | law, **SETTINGS[method])
    without = sampled(method, **SETTINGS[method])
    np.testing.assert_array_equal(cube(with_it), cube(without))
    assert with_it.attrs["varied"] == without.attrs["varied"]
    held = {name: with_it[name].item() for name in ("beam_width", "sphere_mass", "contact")}
    assert held == {"beam_width": 0.061, "sphere_mass": 1.4, "contact": "hertz"}
    assert with_it["beam_width"].attrs["units"] == "m"
    assert "sphere_mass" not in without.coords


@designs
def test_a_distribution_shapes_its_column_alone(sampled, cube, method):
    mode = {"distribution": "triangular", "low": 0.0, "mode": 0.0, "high": 10.0}
    shaped = cube(sampled(method, {"gravity": mode}, **SETTINGS[method]))
    plain = cube(sampled(method, **SETTINGS[method]))
    np.testing.assert_array_equal(shaped[:, :2], plain[:, :2])
    # the probability below x is 1 - (1 - x)^2
    np.testing.assert_allclose(1 - (1 - shaped[:, 2]) ** 2, plain[:, 2], atol=1e-9)
