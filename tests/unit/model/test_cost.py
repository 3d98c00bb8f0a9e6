from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from impactlab.kernels import BEAM_MODELS, SCHEMES
from impactlab.model.cost import node_steps

PAPER: dict[str, Any] = {
    "beam_span": 0.78,
    "beam_depth": 0.0278,
    "beam_density": 7800.0,
    "beam_youngs_modulus": 210e9,
    "duration": 1e-3,
    "courant": 0.5,
    "nodes": 201,
    "scheme": SCHEMES.index("leapfrog"),
    "beam_model": BEAM_MODELS.index("euler_bernoulli"),
}


def test_steps_of_bending_and_of_a_bar_wave_by_hand() -> None:
    dx, speed = 0.78 / 200, (210e9 / 7800.0) ** 0.5
    bending = 0.5 * dx**2 / (speed * 0.0278 / 12**0.5)
    assert node_steps(PAPER) == pytest.approx(0.5 * 201 * 1e-3 / (0.5 * bending))
    wave = node_steps(PAPER | {"scheme": SCHEMES.index("semi_implicit")})
    assert wave == pytest.approx(0.5 * 201 * 1e-3 / (0.5 * 0.5 * dx / speed))
    timoshenko = node_steps(PAPER | {"beam_model": BEAM_MODELS.index("timoshenko")})
    assert timoshenko == pytest.approx(wave)


def test_columns_are_many_runs_at_once() -> None:
    columns = {name: np.array([value, value]) for name, value in PAPER.items()}
    columns["courant"] = np.array([0.5, 0.25])
    one, other = node_steps(columns)
    assert one == pytest.approx(node_steps(PAPER))
    assert other == pytest.approx(2 * one)
