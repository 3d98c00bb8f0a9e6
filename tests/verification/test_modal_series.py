"""The series that the solver is held against must itself be far closer than the tolerance."""

from dataclasses import replace

import numpy as np
import pytest

from impactlab.verification.modal_series import (
    BERNOULLI_CASES,
    FINEST,
    HISTORIES,
    MIDDLE,
    TIMOSHENKO_CASES,
    solve_sheared,
)
from impactlab.verification.solutions.modal import solve, solve_timoshenko

SERIES = {f"bernoulli-{beam}": (case, solve, solve) for beam, case in BERNOULLI_CASES.items()} | {
    f"timoshenko-{beam}": (case, solve_sheared, solve_timoshenko)
    for beam, case in TIMOSHENKO_CASES.items()
}


@pytest.mark.parametrize("name", HISTORIES)
@pytest.mark.parametrize(("case", "used", "solve"), SERIES.values(), ids=SERIES)
def test_series_is_converged(case, used, solve, name):
    impact = replace(case.impact, velocity=case.velocities[-1])  # the hardest one
    series = used(impact, case.duration)
    fine = solve(impact, case.duration, modes=200, step=series.time[1] / 2)
    tightest = HISTORIES[name][2] * (MIDDLE / FINEST) ** 2
    time = np.linspace(0, case.duration, 401)
    one, other = series.at(name, time), fine.at(name, time)
    assert np.abs(one - other).max() < 0.1 * tightest * np.abs(other).max()
