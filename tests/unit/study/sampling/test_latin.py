from __future__ import annotations

import numpy as np


def test_every_stratum_of_every_parameter_is_met_once(sampled, cube):
    draws = cube(sampled("delta", samples=100))
    for column in draws.T:
        assert sorted(np.floor(column * 100).astype(int)) == list(range(100))
    assert np.abs(np.corrcoef(draws.T) - np.eye(3)).max() < 0.3


def test_the_methods_share_their_runs(sampled, cube):
    """So that a change of method asks for no new run."""
    delta, pawn, regression = (
        cube(sampled(method, samples=64, seed=0)) for method in ("delta", "pawn", "regression")
    )
    np.testing.assert_array_equal(delta, pawn)
    np.testing.assert_array_equal(delta, regression)
