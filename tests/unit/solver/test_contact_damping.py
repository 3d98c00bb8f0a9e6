"""Laws with damping: Hunt and Crossley's, on a rigid beam and on those that bend."""

from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.solver.contact import LAWS, hunt_crossley
from impactlab.solver.contact.history import CONTACT, Pair, energies, force
from impactlab.solver.contact.switch import damping, is_damped
from impactlab.solver.contact_damping import damped_force
from impactlab.verification.solutions import hertz

E, R, S_y, nu = 115e9, 0.035, 345e6, 0.3
LAW = LAWS.index("hunt_crossley")
DT = 1e-7

pytestmark = [
    pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning"),
    pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning"),
]


def test_the_constant_is_that_of_the_solution():
    assert hertz.ALPHA == hunt_crossley.ALPHA


def test_which_laws_are_damped():
    assert [law for law in range(-1, len(LAWS) + 1) if is_damped(law)] == [LAW]
    assert damping(0, 1e3, 1e-5, 2.0, E, R, S_y, nu) == 0.0
    expected = 1.5 * hunt_crossley.ALPHA * 2.0 * 1e3
    assert damping(LAW, 1e3, 1e-5, 2.0, E, R, S_y, nu) == pytest.approx(expected, rel=1e-14)


def follow(approaches, compliance=0.0):
    """Return (contact, law's forces, whole forces) along approaches (m), a step apart."""
    contact, pair = np.zeros(1, CONTACT)[0], Pair(LAW, E, R, S_y, nu, compliance)
    contact.n = 1.5
    curve, damped, earlier, before = [], [], approaches[0], approaches[0]
    for approach in approaches:
        curve.append(force(contact, pair, approach))
        damped.append(damped_force(contact, pair, curve[-1], approach, before, earlier, DT))
        earlier, before = before, approach
    return contact, np.array(curve), np.array(damped)


@pytest.mark.parametrize("compliance", [0.0, 4e-10])
def test_the_rate_is_that_of_the_approach_at_the_step(compliance):
    """Exact for a parabola of the approach; the damper is parallel to law and compliance."""
    time = DT * np.arange(200)
    approaches = 2.0 * time - 1e5 * time**2
    _, curve, damped = follow(approaches, compliance)
    rate = 2.0 - 2e5 * time[2:]
    np.testing.assert_allclose(
        damped[2:], curve[2:] * (1.0 + 1.5 * hunt_crossley.ALPHA * rate), rtol=1e-9
    )


def test_what_it_takes_is_dissipated():
    time = DT * np.arange(1201)
    approaches = 1e-4 * np.sin(np.pi * time / time[-1])
    contact, curve, damped = follow(approaches)
    _, dissipated = energies(contact, Pair(LAW, E, R, S_y, nu), approaches[-1])
    work = np.trapezoid(damped, approaches)
    assert work > 0.01 * np.trapezoid(curve[:601], approaches[:601])
    assert dissipated == pytest.approx(work, rel=1e-5)


def test_contacts_do_not_pull():
    """A contact torn apart faster than 2/(3 alpha)."""
    approaches = np.append(np.linspace(0.0, 1e-4, 501), np.linspace(1e-4, 0.0, 51)[1:])
    assert (approaches[-2] - approaches[-1]) / DT > 1.0 / (1.5 * hunt_crossley.ALPHA)
    contact, curve, damped = follow(approaches)
    assert curve[520] > 0.0
    assert damped[520] == 0.0
    assert damped.min() == 0.0
    loaded = np.trapezoid(damped[:501], approaches[:501])
    _, dissipated = energies(contact, Pair(LAW, E, R, S_y, nu), 0.0)
    assert dissipated == pytest.approx(loaded, rel=0.05)  # nothing comes back


def run(velocity, duration=None, *, grid=None, **changes):
    impact = replace(il.paper_impact(velocity, "hunt_crossley"), gravity=0.0, **changes)
    duration = duration or 3.0 * hertz.contact_duration(*hertz.arguments(impact))
    grid = grid or il.Discretisation(nodes=11, points=3)
    return il.simulate(impact, grid, duration=duration, samples=4001)


def test_the_largest_force_comes_before_the_largest_indentation():
    """Their sizes are a check of the verification."""
    dataset = run(3.0, beam_model="rigid")
    peak = dataset.time.values[np.argmax(dataset.contact_force.values)]
    deepest = dataset.time.values[np.argmax(dataset.indentation.values)]
    step = dataset.time.values[1]
    assert dataset.time_of_peak_force.item() == pytest.approx(peak, abs=step)
    assert peak < deepest - step


@pytest.mark.parametrize("velocity", [1.0, 20.0])
@pytest.mark.parametrize(
    ("model", "scheme", "load", "compliance"),
    [
        ("euler_bernoulli", "leapfrog", "point", "half_space"),
        ("euler_bernoulli", "modal", "contact_patch", "half_space"),
        ("timoshenko", "leapfrog", "contact_patch", "strip"),
        ("spring_mass", "leapfrog", "point", "half_space"),
    ],
)
def test_energy_at_the_largest_time_step(model, scheme, load, compliance, velocity):
    """With damping the step without it would be unstable at 20 m/s."""
    grid = il.Discretisation(nodes=201, points=9, scheme=scheme, courant=1.0)
    choices = {"beam_model": model, "load": load, "contact_compliance": compliance}
    dataset = run(velocity, 2e-3, grid=grid, **choices)
    assert dataset.energy_error.item() < 2e-3  # NaN where it diverges
    assert dataset.contact_force.values.min() == 0.0
