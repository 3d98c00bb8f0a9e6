"""The rebound by Stronge's law on a half-space, against the closed form.

The law itself creates energy while the largest indentation is 1 to 2.673 times that at first yield.
A restitution above 1 is correct there, and the solver has to show it.
"""

import math

import pytest

from impactlab.model.discretisation import Discretisation
from impactlab.simulate import simulate
from impactlab.verification.cases import rigid_backed
from impactlab.verification.solutions.contact_laws import stronge_impact

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

LAW = stronge_impact(rigid_backed(1.0, "stronge"))
MASS = rigid_backed(1.0, "stronge").sphere.total_mass
GRID = Discretisation(nodes=11, points=3, courant=0.005)  # the contact alone limits the time step


def reaching(x):
    """The velocity (m/s) whose largest indentation is x times that at first yield."""
    return math.sqrt(2.0 * LAW.loading_work(x * LAW.yield_indentation) / MASS)


VELOCITIES = [*map(reaching, (0.9, 1.2, 1.4, 2.0, 2.673)), 0.3, 0.99, 3.0, 10.0, 20.0]
"""Elastic, restitution above 1 thrice, and 1; fully plastic from 3 m/s on."""


@pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning")
@pytest.mark.parametrize("velocity", VELOCITIES)
def test_rebound_is_the_closed_form(velocity):
    duration = 0.3e-3 * (0.99 / velocity) ** 0.2 + 0.1e-3  # until the sphere has left
    run = simulate(rigid_backed(velocity, "stronge"), GRID, duration=duration, samples=2)
    deepest, restitution = LAW.maximum_indentation(velocity, MASS), LAW.restitution(velocity, MASS)
    dent = LAW.residual_indentation(deepest)
    lost = run.contact_dissipation.item() / (0.5 * MASS * velocity**2)
    assert run.restitution.item() == pytest.approx(restitution, abs=2e-5)
    assert run.peak_force.item() == pytest.approx(LAW.loading_force(deepest), rel=2e-5)
    assert run.maximum_indentation.item() == pytest.approx(deepest, rel=2e-5)
    assert run.permanent_indentation.item() == pytest.approx(dent, abs=2e-5 * deepest)
    assert lost == pytest.approx(1.0 - restitution**2, abs=2e-5)
