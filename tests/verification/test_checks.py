"""All checks pass, and the modal series is far closer to its limit than their tolerance."""

from dataclasses import replace

import numpy as np
import pytest

from impactlab.verification import plasticity
from impactlab.verification.catalogue import CATALOGUE
from impactlab.verification.finding import Comparison, words
from impactlab.verification.modal_series import (
    BERNOULLI_CASES,
    HISTORIES,
    LEAPFROG,
    MODAL,
    TIMOSHENKO_CASES,
    solve_sheared,
)
from impactlab.verification.solutions import fibre_beam
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
    for entry in map(CATALOGUE[name].reference.applied, finding.comparisons):
        assert not entry.uncertainty > 0.5 * entry.tolerance, entry


def test_every_check_states_the_uncertainty_of_its_reference():
    unknown = [name for name, check in CATALOGUE.items() if not check.reference.uncertainty >= 0]
    assert unknown == ["rigid_plastic_mode"]
    assert all(check.reference.kind and check.reference.basis for check in CATALOGUE.values())


def _stated(name, quantity):
    """Return the uncertainty that a check states of a quantity."""
    entry = Comparison(words(quantity), "", "1", 0.0, 0.0, 0.0, 1.0)
    return CATALOGUE[name].reference.applied(entry).uncertainty


SERIES = {f"bernoulli-{beam}": (case, solve, solve) for beam, case in BERNOULLI_CASES.items()} | {
    f"timoshenko-{beam}": (case, solve_sheared, solve_timoshenko)
    for beam, case in TIMOSHENKO_CASES.items()
}


@pytest.mark.parametrize(("case", "used", "solve"), SERIES.values(), ids=SERIES)
def test_series_is_as_certain_as_stated_and_far_more_than_the_checks_ask(case, used, solve):
    name = "timoshenko_beam" if used is solve_sheared else "modal_series"
    time = np.linspace(0, case.duration, 401)
    for velocity in (case.velocities[0], case.velocities[-1]):
        impact = replace(case.impact, velocity=velocity)
        series = used(impact, case.duration)
        fine = solve(impact, case.duration, modes=200, step=series.time[1] / 2)
        for place, quantity in enumerate(HISTORIES):
            one, other = series.at(quantity, time), fine.at(quantity, time)
            change = np.abs(one - other).max() / np.abs(other).max()
            assert change < _stated(name, quantity), quantity
            for scheme in (LEAPFROG, MODAL):
                finest = (scheme.middle / scheme.nodes[-1]) ** 2
                assert change < 0.1 * scheme.tolerances[place] * finest, quantity
        for quantity in ("peak_force", "contact_duration"):
            change = getattr(series, quantity) / getattr(fine, quantity) - 1.0
            assert abs(change) < _stated(name, quantity), quantity


@pytest.mark.parametrize("impact", plasticity.STRUCK.values(), ids=plasticity.STRUCK)
def test_fibre_elements_are_as_certain_as_stated(impact):
    elements, steps = plasticity.ELEMENTS, plasticity.STEPS
    used, fine = (
        fibre_beam.solve(
            impact, plasticity.STRUCK_DURATION, elements=times * elements, steps=times * steps
        )
        for times in (1, 2)
    )
    for quantity in plasticity.FIBRE_TOLERANCES:
        one, other = (np.asarray(getattr(solution, quantity)) for solution in (used, fine))
        change = np.abs(one - (other[::2] if other.ndim else other)).max() / np.abs(other).max()
        stated = _stated("fibre_elements", quantity)
        assert change < stated, quantity
