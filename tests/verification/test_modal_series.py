"""The series that the solver is held against must itself be far closer than the tolerance."""

from dataclasses import replace

import numpy as np
import pytest

from impactlab.verification import modal_series, timoshenko_beam
from impactlab.verification.series import FINEST, HISTORIES, MIDDLE
from impactlab.verification.solutions import modal, timoshenko_modal

SERIES = {
    (theory, beam): (case, file.solve, theory.solve)
    for theory, file in ((modal, modal_series), (timoshenko_modal, timoshenko_beam))
    for beam, case in file.CASES.items()
}


@pytest.mark.parametrize("name", HISTORIES)
@pytest.mark.parametrize(
    ("case", "used", "solve"), SERIES.values(), ids=[f"{t.__name__}-{b}" for t, b in SERIES]
)
def test_series_is_converged(case, used, solve, name):
    impact = replace(case.impact, velocity=case.velocities[-1])  # the hardest one
    series = used(impact, case.duration)
    fine = solve(impact, case.duration, modes=200, step=series.time[1] / 2)
    tightest = HISTORIES[name][2] * (MIDDLE / FINEST) ** 2
    time = np.linspace(0, case.duration, 401)
    one, other = series.at(name, time), fine.at(name, time)
    assert np.abs(one - other).max() < 0.1 * tightest * np.abs(other).max()
