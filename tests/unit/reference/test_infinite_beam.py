"""The infinite beam against the modal sum of a long one, before the supports' echo."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from impactlab.model.paper import paper_impact
from impactlab.reference.beam_modes import odd_modes
from impactlab.reference.infinite_beam import deflection_under_impulse

BEAM = paper_impact().beam


def test_long_beam_deflects_like_the_infinite_one():
    long, impulse, time = replace(BEAM, span=60.0), 2.0, np.array([1e-4, 5e-4, 2e-3])
    modes = odd_modes(long, 40_000)
    mass = 0.5 * long.mass_per_length * long.span
    series = np.sin(np.outer(time, modes.frequencies)) @ (impulse / (mass * modes.frequencies))
    np.testing.assert_allclose(deflection_under_impulse(long, impulse, time), series, rtol=1e-3)


def test_deflection_grows_with_the_root_of_time_from_zero():
    w = deflection_under_impulse(BEAM, 1.0, [0.0, 1e-3, 4e-3])
    assert w[0] == 0.0
    assert w[2] == pytest.approx(2 * w[1], rel=1e-12)


@pytest.mark.parametrize("time", [-1e-6, np.nan, [0.0, np.inf]])
def test_wrong_time_is_named(time):
    with pytest.raises(ValueError, match="time"):
        deflection_under_impulse(BEAM, 1.0, time)


def test_wrong_impulse_is_named():
    with pytest.raises(ValueError, match="impulse"):
        deflection_under_impulse(BEAM, np.nan, 1e-3)
