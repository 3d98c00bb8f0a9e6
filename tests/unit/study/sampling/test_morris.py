from __future__ import annotations

import numpy as np
import pytest


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


def test_trajectories_far_apart_are_chosen_from_those_drawn(sampled, cube):
    every = cube(sampled("morris", trajectories=40)).reshape(40, 4, 3)
    chosen = cube(sampled("morris", trajectories=40, optimal_trajectories=6)).reshape(6, 4, 3)
    among = [any(np.array_equal(one, other) for other in every) for one in chosen]
    assert all(among)

    def spread(trajectories):
        """Mean distance of the points of one trajectory from those of another (Campolongo)."""
        apart = trajectories[:, None, :, None] - trajectories[None, :, None, :]
        distances = np.sqrt((apart**2).sum(axis=-1)).sum(axis=(2, 3))
        return distances[~np.eye(len(trajectories), dtype=bool)].mean()

    assert spread(chosen) > 1.1 * spread(every)
