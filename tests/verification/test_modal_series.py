"""The series that the solver is held against must itself be far closer than the tolerance."""

from dataclasses import replace

import numpy as np
import pytest

from impactlab.reference.modal import solve
from impactlab.verification.modal_series import CASES, FINEST, HISTORIES, MIDDLE


@pytest.mark.parametrize("name", HISTORIES)
@pytest.mark.parametrize("beam", CASES)
def test_series_is_converged(beam, name):
    case = CASES[beam]
    impact = replace(case.impact, velocity=case.velocities[-1])  # the hardest one
    series = solve(impact, case.duration)
    fine = solve(impact, case.duration, modes=150, step=series.time[1] / 2)
    tightest = HISTORIES[name][2] * (MIDDLE / FINEST) ** 2
    time = np.linspace(0, case.duration, 401)
    one, other = series.at(name, time), fine.at(name, time)
    assert np.abs(one - other).max() < 0.1 * tightest * np.abs(other).max()
