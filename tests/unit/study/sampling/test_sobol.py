from __future__ import annotations

import numpy as np

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
