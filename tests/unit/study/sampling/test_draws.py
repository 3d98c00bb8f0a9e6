"""The draws of each sampling method."""

from __future__ import annotations

import numpy as np
import pytest

GROUPS = {"others": ["gravity", "velocity"]}


def test_parameters_of_a_group_are_exchanged_together(sampled, cube):
    """A; A with each group's columns of B; B with each group's columns of A; B."""
    sample = sampled("sobol", base_samples=16, groups=GROUPS)
    assert sample.attrs["groups"] == ["others", "beam_depth", "others"]
    swap = np.array([[True, False, True], [False, True, False]])  # groups as they first come
    for block in np.split(cube(sample), 16):
        a, mixed_a, mixed_b, b = block[0], block[1:3], block[3:5], block[5]
        assert not np.isclose(a, b).any()
        np.testing.assert_array_equal(mixed_a, np.where(swap, b, a))
        np.testing.assert_array_equal(mixed_b, np.where(swap, a, b))


def test_a_larger_grouped_sample_begins_with_the_smaller_one(sampled, cube):
    small, large = (cube(sampled("sobol", base_samples=n, groups=GROUPS)) for n in (16, 32))
    np.testing.assert_array_equal(large[: len(small)], small)


def steps(draws, units):
    """Differences along each trajectory: (trajectory, step, parameter)."""
    return np.diff(draws.reshape(-1, units + 1, draws.shape[1]), axis=1)


@pytest.mark.parametrize("levels", [2, 4, 10])
def test_every_parameter_steps_once_along_each_trajectory(sampled, cube, levels):
    draws = cube(sampled("morris", trajectories=20, levels=levels))
    grid = np.linspace(0, 1, levels)
    assert np.abs(draws[..., None] - grid).min(axis=-1).max() < 1e-8
    change = steps(draws, 3)
    moved = np.abs(change) > 1e-6
    assert (moved.sum(axis=1) == 1).all()
    assert (moved.sum(axis=2) == 1).all()
    # Morris (1991): half the levels, in their spacing
    np.testing.assert_allclose(np.abs(change[moved]), levels / (2 * (levels - 1)), atol=1e-8)
    assert {1, -1} == set(np.sign(change[moved]))


def test_parameters_of_a_group_step_together(sampled, cube):
    sample = sampled("morris", trajectories=20, groups={"others": ["gravity", "velocity"]})
    assert sample.sizes["run"] == 20 * 3
    moved = np.abs(steps(cube(sample), 2)) > 1e-6
    np.testing.assert_array_equal(moved[..., 0], moved[..., 2])
    assert (moved.sum(axis=1) == 1).all()
    assert not (moved[..., 0] & moved[..., 1]).any()


def spectra(draws):
    """Magnitudes of each parameter's frequencies along a curve: (frequency, parameter)."""
    return np.abs(np.fft.rfft(draws - draws.mean(axis=0), axis=0))


@pytest.mark.parametrize(("samples", "harmonics"), [(257, 4), (513, 6)])
def test_each_parameter_has_the_high_frequency_in_its_curve_alone(
    sampled, cube, samples, harmonics
):
    """Saltelli, Tarantola and Chan (1999): the others keep below 1/(2 M) of it."""
    draws = cube(sampled("fast", samples=samples, harmonics=harmonics))
    high = (samples - 1) // (2 * harmonics)
    curves = np.split(draws, 4)
    for at, curve in enumerate(curves):
        loudest = spectra(curve).argmax(axis=0)
        for parameter, frequency in enumerate(loudest):
            if parameter == at:
                assert frequency == high
            else:
                assert frequency <= high // (2 * harmonics)


def test_the_last_curve_is_that_of_a_dummy(sampled, cube):
    """In it no parameter has the high frequency, so that what is found there is noise."""
    curves = np.split(cube(sampled("fast", samples=257)), 4)
    assert (spectra(curves[3]).argmax(axis=0) <= 4).all()
    assert [spectra(curve).argmax(axis=0).max() for curve in curves[:3]] == [32] * 3


def test_each_curve_fills_the_ranges_evenly(sampled, cube):
    for curve in np.split(cube(sampled("fast", samples=1025)), 4):
        for column in curve.T:
            counts, _ = np.histogram(column, bins=8, range=(0, 1))
            assert counts.min() > 0.8 * 1025 / 8


def test_every_stratum_of_every_parameter_is_met_once(sampled, cube):
    draws = cube(sampled("delta", samples=100))
    for column in draws.T:
        assert sorted(np.floor(column * 100).astype(int)) == list(range(100))
    assert np.abs(np.corrcoef(draws.T) - np.eye(3)).max() < 0.3


def test_the_methods_share_their_runs(sampled, cube):
    """So that a change of method asks for no new run."""
    delta, pawn, regression = (
        cube(sampled(method, samples=100, seed=0)) for method in ("delta", "pawn", "regression")
    )
    np.testing.assert_array_equal(delta, pawn)
    np.testing.assert_array_equal(delta, regression)
