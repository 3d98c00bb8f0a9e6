"""The draws of each sampling method."""

import numpy as np
import pytest

GROUPS = {"others": ["gravity", "velocity"]}


@pytest.mark.parametrize("groups", [GROUPS, {}])
def test_parameters_of_a_group_are_exchanged_together(sampled, cube, groups):
    """A; A with each group's columns of B; B with each group's columns of A; B."""
    sample = sampled("sobol", base_samples=16, **({"groups": groups} if groups else {}))
    swap = np.eye(3, dtype=bool)
    if groups:
        assert sample.attrs["groups"] == ["others", "beam_depth", "others"]
        swap = np.array([[True, False, True], [False, True, False]])  # as they first come
    for block in np.split(cube(sample), 16):
        a, b = block[0], block[-1]
        mixed_a, mixed_b = np.split(block[1:-1], 2)
        assert not np.isclose(a, b).any()
        np.testing.assert_array_equal(mixed_a, np.where(swap, b, a))
        np.testing.assert_array_equal(mixed_b, np.where(swap, a, b))


def test_every_replicate_of_a_sample_is_even_and_independent(sampled, cube):
    """Eight points lie in the eight eighths of every dimension of A and of B."""
    points = cube(sampled("sobol", base_samples=64)).reshape(64, -1, 3)[:, [0, -1]]
    replicates = [points[place::8].reshape(8, 6) for place in range(8)]
    for points in replicates:
        np.testing.assert_array_equal(np.sort(np.floor(8 * points), axis=0).T, [range(8)] * 6)
    orders = {tuple(np.floor(8 * points[:, 0])) for points in replicates}
    assert len(orders) == 8


def spectra(draws):
    """Magnitudes of each parameter's frequencies along a curve: (frequency, parameter)."""
    return np.abs(np.fft.rfft(draws - draws.mean(axis=0), axis=0))


@pytest.mark.parametrize(("samples", "harmonics", "own"), [(1188, 4, 33), (2600, 6, 49)])
def test_each_parameter_has_the_high_frequency_in_its_curves_alone(
    sampled, cube, samples, harmonics, own
):
    """Saltelli, Tarantola and Chan (1999): the others keep below 1/(2 M) of it, each at its own.

    The last curves are those of a dummy: what is found at the high frequency there is noise.
    """
    curves = cube(sampled("fast", samples=samples, harmonics=harmonics)).reshape(4, 4, -1, 3)
    assert curves.shape[2] == (2 * harmonics + 1) * own
    frequencies = np.array([[spectra(curve).argmax(axis=0) for curve in four] for four in curves])
    high = frequencies == own
    np.testing.assert_array_equal(
        high, np.eye(4, 3, dtype=bool)[:, None] & np.ones((4, 4, 3), bool)
    )
    assert frequencies[~high].max() <= own // (2 * harmonics)
    for curve in frequencies.reshape(-1, 3):
        assert len(set(curve.tolist())) == 3
    assert len({tuple(curve) for curve in frequencies[3].tolist()}) > 1  # drawn anew for each


def test_curves_fill_the_ranges_evenly(sampled, cube):
    draws = cube(sampled("fast", samples=1188))
    for column in draws.T:
        counts, _ = np.histogram(column, bins=8, range=(0, 1))
        assert counts.min() > 0.8 * len(draws) / 8
