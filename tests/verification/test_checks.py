"""All checks pass, and the modal series is far closer to its limit than their tolerance."""

from dataclasses import replace

import numpy as np
import pytest

from impactlab.verification.catalogue import CATALOGUE
from impactlab.verification.modal_series import (
    BERNOULLI_CASES,
    HISTORIES,
    LEAPFROG,
    MODAL,
    TIMOSHENKO_CASES,
    solve_sheared,
)
from impactlab.verification.solutions.modal import solve, solve_timoshenko

SLOW = ("contact_patch", "contact_prestress", "strain_rate", "strip")
"""They need kernels of their own, each compiled for ten seconds."""


@pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning")
@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.long] * (name in SLOW)) for name in CATALOGUE]
)
def test_check(name):
    finding = CATALOGUE[name].check()
    assert finding.comparisons
    failing = [
        f"{entry.quantity}, {entry.where}: {entry.ours:.9g} {entry.units}, independently "
        f"{entry.independent:.9g}: {entry.error:.3g} {entry.measure} is beyond {entry.tolerance:g}"
        for entry in finding.comparisons
        if not entry.passed
    ]
    assert not failing, "\n".join(failing)


SERIES = {f"bernoulli-{beam}": (case, solve, solve) for beam, case in BERNOULLI_CASES.items()} | {
    f"timoshenko-{beam}": (case, solve_sheared, solve_timoshenko)
    for beam, case in TIMOSHENKO_CASES.items()
}


@pytest.mark.parametrize(("case", "used", "solve"), SERIES.values(), ids=SERIES)
def test_series_is_converged(case, used, solve):
    impact = replace(case.impact, velocity=case.velocities[-1])  # the hardest one
    series = used(impact, case.duration)
    fine = solve(impact, case.duration, modes=200, step=series.time[1] / 2)
    time = np.linspace(0, case.duration, 401)
    for scheme in (LEAPFROG, MODAL):
        finest = (scheme.middle / scheme.nodes[-1]) ** 2
        for name, tolerance in zip(HISTORIES, scheme.tolerances, strict=True):
            one, other = series.at(name, time), fine.at(name, time)
            largest = np.abs(other).max()
            assert np.abs(one - other).max() < 0.1 * tolerance * finest * largest, name
