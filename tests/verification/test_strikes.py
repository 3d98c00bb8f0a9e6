"""Repeated strikes: energy balances, the beam at rest as the mean of its swing, both schemes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import impactlab as il
from impactlab.verification.solutions.contact_laws import law_on_half_space

from ..end_modes import held

FLOATING = replace(il.paper_impact(5.0), gravity=0.0)
SERIES = ("permanent_indentation", "peak_force", "restitution", "contact_dissipation")


def series(run, name):
    return run[f"{name}_over_strikes"].values


@pytest.mark.parametrize(
    ("law", "velocity"),
    [
        ("stronge", 0.4),  # creates energy
        ("stronge", 5.0),
        ("jackson_green", 5.0),
        ("thornton", 5.0),
        ("kogut_etsion", 2.0),
        ("finite_element", 0.99),
        ("finite_element", 10.0),
    ],
)
def test_a_rigid_beam_is_dented_as_the_energies_ask(law, velocity):
    """A strike first takes what the one before gave back, then what loading on takes."""
    impact = replace(FLOATING, velocity=velocity, contact=law, beam_model="rigid", strikes=5)
    run = il.simulate(impact, il.Discretisation(nodes=5), duration="1 ms", samples=2)
    half_space, mass = law_on_half_space(impact), impact.sphere.total_mass
    energy = 0.5 * mass * velocity**2
    deepest, spent, dents, forces, rebounds, losses = 0.0, 0.0, [], [], [], []
    for _ in range(5):
        needed = spent + energy
        if deepest == 0.0 or half_space.loading_work(deepest) < needed:
            deepest = brentq(
                lambda d, W=needed: half_space.loading_work(d) - W, 1e-9, 0.01, xtol=1e-15
            )
            forces.append(half_space.loading_force(deepest))
        else:  # a law that creates energy: on the unloading curve, which stays
            force, end, n = half_space.unloading(deepest)
            forces.append(force * (energy / half_space.released_work(deepest)) ** (n / (n + 1)))
        released = half_space.released_work(deepest)
        spent = half_space.loading_work(deepest) - released
        dents.append(half_space.residual_indentation(deepest))
        rebounds.append(np.sqrt(min(released / energy, 1.0)) if len(dents) > 1 else np.nan)
        losses.append(spent)
    assert series(run, "permanent_indentation") == pytest.approx(dents, rel=2e-5, abs=1e-12)
    assert series(run, "peak_force") == pytest.approx(forces, rel=2e-5)
    assert series(run, "restitution")[1:] == pytest.approx(rebounds[1:], rel=2e-5)
    assert series(run, "contact_dissipation") == pytest.approx(losses, rel=1e-4, abs=1e-5 * energy)
    assert run.maximum_indentation.item() == pytest.approx(deepest, rel=2e-5)
    if law == "finite_element":
        growth = np.diff(dents)
        assert (growth > 0).all()
        assert (np.diff(growth) < 0).all()


@pytest.mark.parametrize(
    ("model", "scheme"),
    [
        ("elastic", "leapfrog"),
        ("elastic", "modal"),
        ("timoshenko", "leapfrog"),
        ("spring_mass", "leapfrog"),
    ],
)
def test_strikes_that_leave_nothing_are_alike(model, scheme):
    impact = replace(FLOATING, contact="hertz", velocity=1.0, beam_model=model, strikes=3)
    grid = il.Discretisation(nodes=41, scheme=scheme)
    once, thrice = (
        il.simulate(replace(impact, strikes=n), grid, duration="11 ms", samples=2)
        for n in (1, 3)
    )
    names = ("maximum_indentation", "time_of_peak_force", "contact_duration", "maximum_deflection",
             "impulse", "number_of_contacts", "total_contact_time", *SERIES[1:3])
    for name in names:
        assert thrice[name].item() == pytest.approx(once[name].item(), rel=1e-9), name
    assert thrice.shakedown_strike.item() == 1
    assert np.ptp(series(thrice, "peak_force")) < 1e-9 * once.peak_force.item()
    assert np.abs(series(thrice, "residual_deflection")).max() < 1e-12
    assert thrice.energy_error.item() == pytest.approx(once.energy_error.item(), rel=1e-6)


CORRECTED = replace(il.corrected_impact(20.0), gravity=0.0)
TIMOSHENKO = replace(FLOATING, beam_model="timoshenko", velocity=20.0)
YIELDING = replace(FLOATING, velocity=20.0)


@pytest.mark.parametrize(
    ("impact", "scheme"),
    [
        (YIELDING, "leapfrog"),
        (YIELDING, "modal"),
        (TIMOSHENKO, "leapfrog"),
        (CORRECTED, "leapfrog"),
        *((held(*ends, 0.25, YIELDING), scheme) for ends in (
            ("clamped", "clamped"), ("pinned", "clamped"), ("clamped", "free"),
        ) for scheme in ("leapfrog", "modal")),
        (held("clamped", "pinned", 0.25, TIMOSHENKO), "leapfrog"),
        (held("clamped", "clamped", 0.5, replace(CORRECTED, contact_prestress="ignored")),
         "leapfrog"),
    ],
)
def test_rest_is_the_mean_of_the_swing(impact, scheme):
    """Of the free motion, after the contacts, under a window that lets no swing through."""
    grid = il.Discretisation(nodes=41, scheme=scheme)
    swinging = il.simulate(impact, grid, duration="120 ms", samples=24001)
    rested = il.simulate(replace(impact, strikes=2), grid, duration="12 ms", samples=2)
    w = swinging.midspan_deflection.values[4001:]
    window = np.blackman(w.size)
    assert np.abs(swinging.contact_force.values[2401:]).max() == 0.0
    mean = np.sum(window * w) / np.sum(window)
    rest = series(rested, "residual_deflection")[0]
    assert abs(rest) > 1e-4
    assert rest == pytest.approx(mean, rel=2e-3)
    assert rested.energy_error.item() < 5e-3
