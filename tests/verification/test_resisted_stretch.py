"""Von Karman beams on springs, damped, on a foundation, struck again: limits, statics, energy."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

import impactlab as il
from impactlab.solver.outputs import SERIES
from impactlab.verification.cases import elastic

from .test_resisted_shear import BED, CANTILEVER, CLAMPED, EQUAL, RAYLEIGH, SPRINGS, beam_of

pytestmark = [
    pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning"),
    pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning"),
]


def stretching(velocity, **values):
    return beam_of(velocity, "von_karman", **{"radius": 0.035} | values)


@pytest.mark.parametrize(
    ("values", "place", "share"),
    [
        (SPRINGS, 0.4, 1e-4),
        (EQUAL | BED, 0.5, 1e-4),
        (CANTILEVER | RAYLEIGH, 1.0, 1e-4),
        (SPRINGS | BED | RAYLEIGH, 0.25, 1e-4),
        (CLAMPED | RAYLEIGH, 0.5, 1e-4),
        ({}, 0.5, 3e-6),
        (CLAMPED, 0.5, 3e-6),
        ({"support_right": "roller"}, 0.5, 3e-6),
        ({"support_left": "clamped", "support_right": "free"}, 0.25, 3e-6),
        ({"support_left": "free"}, 0.0, 3e-6),
        ({"support_left": "roller", "support_right": "clamped"}, 0.75, 3e-6),
    ],
)
def test_tiny_deflections_are_those_of_euler_and_bernoulli(values, place, share):
    impact = stretching(1e-3, place=place, **values)
    grid = il.Discretisation(nodes=161)
    if share == 1e-4:
        grid = il.Discretisation(nodes=41, courant=0.2)  # steps are not the same: damping lags
    runs = [
        il.simulate(replace(impact, beam_model=model), grid, duration=2e-3, samples=401)
        for model in ("von_karman", "euler_bernoulli")
    ]
    for name in ("contact_force", "midspan_deflection", "sphere_displacement"):
        ours, expected = (run[name].values for run in runs)
        assert np.abs(ours - expected).max() < share * np.abs(expected).max(), name


def least_energy(beam, force, terms=40):
    """Return the deflection under a force in the middle, of a constant and sines (Ritz)."""
    n = np.arange(1, 2 * terms, 2)
    k, L = n * np.pi / beam.span, beam.span
    bent = 0.5 * L * beam.bending_stiffness * k**4
    EA = beam.material.youngs_modulus * beam.section.area
    springs, bed = 2.0 * beam.stiffness_left, beam.foundation_stiffness

    def energy(scaled):
        rigid, a = scaled[0] * beam.depth, scaled[1:] * beam.depth / n**2
        longer = 0.25 * L * np.sum((k * a) ** 2)
        total = 0.5 * (springs * rigid**2 + np.sum(bent * a**2) + EA / L * longer**2)
        total += 0.5 * bed * (L * rigid**2 + 4 * rigid * np.sum(a / k) + 0.5 * L * np.sum(a**2))
        return (total - force * (rigid + np.sum(a * np.sin(0.5 * n * np.pi)))) / force / beam.depth

    least = minimize(energy, np.zeros(terms + 1), method="BFGS", options={"gtol": 1e-9})
    return beam.depth * (least.x[0] + np.sum(least.x[1:] / n**2 * np.sin(0.5 * n * np.pi)))


@pytest.mark.parametrize("bed", [0.0, 5e5])
def test_a_heavy_sphere_at_rest_bends_the_beam_as_in_statics(bed):
    """By more than the depth, on springs that hold the axis, until damping has its way."""
    ends = {
        f"{name}_{side}": value
        for side in ("left", "right")
        for name, value in (("support", "elastic"), ("stiffness", 1e6))
    }
    impact = stretching(5.0, depth=0.01, mass_damping=300.0, foundation_stiffness=bed, **ends)
    impact = replace(elastic(impact), gravity=8e3 if bed else 5e3)
    run = il.simulate(impact, il.Discretisation(nodes=41), duration="150 ms", samples=2001)
    force = impact.sphere.total_mass * impact.gravity
    assert run.contact_force.values[1900:].mean() == pytest.approx(force, rel=1e-3)
    exact = least_energy(impact.beam, force)
    assert exact > impact.beam.depth
    assert run.midspan_deflection.values[1900:].mean() == pytest.approx(exact, rel=5e-3)


@pytest.mark.parametrize(
    ("model", "scheme", "values", "place", "velocity"),
    [
        ("von_karman", "leapfrog", CLAMPED, 0.5, 30.0),
        ("von_karman", "leapfrog", {}, 0.5, 20.0),
        ("von_karman", "leapfrog", SPRINGS | BED, 0.25, 20.0),
        ("von_karman", "leapfrog", CLAMPED | {"support_right": "roller"}, 0.5, 20.0),
        ("euler_bernoulli", "leapfrog", {}, 0.5, 20.0),
        ("euler_bernoulli", "modal", {}, 0.5, 20.0),
    ],
)
def test_a_damped_beam_comes_to_rest_by_itself(model, scheme, values, place, velocity):
    """Alike what static equilibrium leaves, with axial force and fibres that have yielded."""
    impact = beam_of(velocity, model, 0.035, place, mass_damping=600.0, **values)
    stretches = model == "von_karman"
    law = "finite_element" if stretches else "stronge"
    impact = replace(impact, gravity=0.0, strikes=3, contact=law)
    grid = il.Discretisation(nodes=33 if scheme == "modal" else 41, points=9, scheme=scheme)
    still, run = (
        il.simulate(case, grid, duration="12 ms", samples=2)
        for case in (impact, replace(impact, strike_interval="90 ms"))
    )
    assert np.abs(still.residual_deflection_over_strikes).min() > 1e-4
    for name in SERIES:
        ours, expected = (of[f"{name}_over_strikes"].values for of in (still, run))
        assert ours == pytest.approx(expected, rel=1e-5 if stretches else 1e-6), name
    assert still.energy_error.item() < 2e-3 if stretches else run.energy_error.item() < 0.01


def test_stretching_slows_the_growth_of_a_clamped_beams_deflection():
    impact = replace(stretching(20.0, **CLAMPED), gravity=0.0, strikes=5, contact="finite_element")
    grid = il.Discretisation(nodes=41, points=9)
    runs = (
        il.simulate(replace(impact, beam_model=model), grid, duration="12 ms", samples=2)
        for model in ("von_karman", "euler_bernoulli")
    )
    ours, plain = (run.residual_deflection_over_strikes.values for run in runs)
    assert (np.diff(ours) > 0.0).all()
    assert ours[-1] - ours[0] < 0.95 * (plain[-1] - plain[0])  # each strike has its sub-impacts
