"""Points of the unit cube, and which runs are held out."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import xarray as xr

from impactlab.analysis.surrogate.fitting import Sample, is_sample

Build = Callable[..., xr.Dataset]


def first(unit: Any) -> Any:
    return unit[:, 0]


def test_values_become_the_probabilities_that_they_were_drawn_with(drawn_runs: Build) -> None:
    """The answer is the draw itself: uniform, triangular and normal alike."""
    runs = drawn_runs(
        peak_force=lambda u: u[:, 0], impulse=lambda u: u[:, 1], restitution=lambda u: u[:, 2]
    )
    answers = [runs[name].values for name in ("peak_force", "impulse", "restitution")]
    np.testing.assert_allclose(Sample.of(runs).unit, np.column_stack(answers), atol=1e-9)


def test_whole_blocks_of_saltelli_are_held_out(drawn_runs: Build) -> None:
    sample = Sample.of(drawn_runs(base_samples=64, peak_force=first))
    blocks = sample.held_out.reshape(64, 8)
    assert np.array_equal(blocks.all(axis=1), blocks.any(axis=1))
    assert blocks.any(axis=1).sum() == 13
    assert np.array_equal(sample.tests, np.flatnonzero(sample.held_out))


@pytest.mark.parametrize(
    ("attrs", "length"),
    [
        ({"method": "morris", "trajectories": 32}, 16),
        ({"method": "fast", "samples": 128}, 128),
        ({"method": "delta", "samples": 512}, 1),
        ({"method": "pawn", "samples": 512}, 1),
    ],
)
def test_blocks_of_other_methods(drawn_runs: Build, attrs: Any, length: int) -> None:
    sample = Sample.of(drawn_runs(base_samples=64, attrs=attrs, peak_force=first))
    held_out = sample.held_out.reshape(-1, length)
    assert np.array_equal(held_out.all(axis=1), held_out.any(axis=1))
    assert held_out.any(axis=1).sum() == max(1, round(0.2 * 512 / length))


@pytest.mark.parametrize("seed", [0, 1])
def test_the_seed_of_the_study_chooses(drawn_runs: Build, seed: int) -> None:
    def held_out(seed: int) -> Any:
        return Sample.of(drawn_runs(seed=seed, peak_force=first)).held_out

    assert np.array_equal(held_out(seed), held_out(seed))
    assert not np.array_equal(held_out(seed), held_out(seed + 1))


def test_of_many_held_out_runs_some_are_tested(drawn_runs: Build) -> None:
    sample = Sample.of(drawn_runs(base_samples=4096, peak_force=first))
    assert sample.tests.size == 4000 == np.unique(sample.tests).size
    assert sample.held_out[sample.tests].all()


def test_groups_stand_for_their_parameters(drawn_runs: Build) -> None:
    runs = drawn_runs(peak_force=first)
    assert Sample.of(runs).labels == ["velocity", "beam_depth", "beam_yield_stress"]
    grouped = Sample.of(runs.assign_attrs(groups=["impact", "beam", "beam"]))
    assert grouped.labels == ["impact", "beam"]


def test_runs_that_are_no_whole_sample_are_refused(drawn_runs: Build) -> None:
    runs = drawn_runs(peak_force=first).isel(run=slice(0, 1000))
    with pytest.raises(ValueError, match=r"'synthetic' has 1000 runs, .* method sobol: solve"):
        Sample.of(runs)


def test_what_counts_as_a_sample(drawn_runs: Build) -> None:
    runs = drawn_runs(peak_force=first)
    assert is_sample(runs)
    grid = xr.Dataset(coords={"velocity": [1.0, 2.0]}, attrs={"varied": ["velocity"]})
    assert not is_sample(grid)
    runs["velocity"].attrs.pop("distribution")
    assert not is_sample(runs)
