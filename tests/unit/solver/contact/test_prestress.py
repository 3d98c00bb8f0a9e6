"""A contact on metal under stress: first yield, the data of the fit, energy."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.linalg import solve_banded
from scipy.optimize import minimize_scalar

import impactlab as il
from impactlab.model.contact_compliance import AT, bending_across, contact_stress
from impactlab.solver.contact import LAWS, finite_element, prestress
from impactlab.solver.contact.history import CONTACT, Pair, energies
from impactlab.solver.contact.history import force as plain_force
from impactlab.solver.contact.metals import shape
from impactlab.solver.contact.stronge import yield_indentation

E, R, S_y, nu = 115e9, 0.035, 345e6, 0.3
DEPTH = 0.0278
DATA = pd.read_csv(Path(finite_element.__file__).with_name("prestress.csv"))
FIRST = yield_indentation(E, R, S_y)


def untouched():
    contact = np.zeros(1, CONTACT)[0]
    contact.n = 1.5
    return contact


def pair(law="finite_element", compliance=0.0):
    return Pair(LAWS.index(law), E, R, S_y, nu, compliance, 0.0, (DEPTH, 500.0, -300.0))


def hertz_pressure(along, across):
    """Return Hertz's largest pressure at first yield on the axis, in yield stresses."""

    def spare(z):
        upright = -1.0 / (1.0 + z * z)
        sideways = -(1.0 + nu) * (1.0 - z * np.arctan(1.0 / z)) - 0.5 * upright
        apart = sideways - upright  # times the pressure p: both stresses along the surface, of z
        # von Mises with p apart + along, p apart + across is 1: a quadratic in p
        b = apart * (along + across)
        c = along**2 - along * across + across**2 - 1.0
        return (-b + np.sqrt(b * b - 4.0 * apart**2 * c)) / (2.0 * apart**2)

    return minimize_scalar(spare, bounds=(0.2, 1.0), method="bounded").fun


@pytest.mark.parametrize(
    ("along", "across"), [(-0.1, -0.1), (0.1, 0.1), (-0.05, 0.0), (0.0, 0.05), (0.1, -0.1)]
)
def test_first_yield_is_von_mises_in_the_field_of_hertz(along, across):
    ratio = (hertz_pressure(along, across) / hertz_pressure(0.0, 0.0)) ** 3
    # B and C are those of deep contacts
    small = 0.44 * (along - across) ** 2 + 0.26 * (along + across) ** 2
    strength = prestress.strengthening(1.0 + 1e-12, along, across)
    assert strength == pytest.approx(ratio, abs=1e-6 + 1.5 * small)


@pytest.mark.parametrize("stress", [-0.6, -0.3, 0.3])
@pytest.mark.parametrize("span", [(10.0, 40.0), (40.0, 120.0), (120.0, 301.0)])
def test_force_under_an_even_stress_is_that_of_finite_elements(stress, span):
    """In the mean over a range; nodes that touch one by one make single points scatter."""

    def force(x, stress):
        F, K, residual, n = finite_element.curve(x * FIRST, E, R, S_y, nu)
        F *= prestress.strengthening(x, stress, stress)
        return F, (residual + (F / K) ** (1.0 / n)) / FIRST

    def raised(x):
        forces, at = zip(
            *(force(each, stress) for each in np.linspace(5.0, 320.0, 400)), strict=True
        )
        return np.interp(x, at, forces) / np.array([force(each, 0.0)[0] for each in x]) - 1.0

    loaded, plain = (DATA[DATA.stress == each].set_index("x").F for each in (stress, 0.0))
    change = (loaded / plain - 1.0)[span[0] : span[1]]
    assert np.mean(raised(change.index)) == pytest.approx(change.mean(), abs=0.016)
    assert abs(change.mean()) > 0.03


@pytest.mark.parametrize("compliance", [-3e-10, 0.0, 3e-10])
def test_stress_that_changes_creates_no_energy(compliance):
    """Loading and reloading while the bending swings: work is stored or dissipated."""
    approach = np.concatenate(
        [np.linspace(0.0, 60.0, 800), np.linspace(60.0, 50.0, 200), np.linspace(50.0, 80.0, 600)]
    )
    approach = 1e-6 * np.concatenate([approach, np.full(200, 80.0), np.linspace(80.0, 0.0, 800)])
    bending = 0.8 * S_y * np.sin(np.linspace(0.0, 30.0, approach.size))
    contact, forces, dissipated = untouched(), [], []
    bodies = pair(compliance=compliance)
    for delta, stress in zip(approach, bending, strict=True):
        contact.stress_along = stress
        forces.append(prestress.force(contact, bodies, delta))
        dissipated.append(energies(contact, bodies, delta)[1])
    assert np.diff(dissipated).min() >= 0.0
    assert forces[-1] == energies(contact, bodies, 0.0)[0] == 0.0
    work = np.trapezoid(forces, approach)
    assert work == pytest.approx(dissipated[-1], rel=1e-3)
    assert contact.approach_m == approach.max()
    assert contact.peak_force == max(forces)


@pytest.mark.parametrize("law", [law for law in LAWS if law != "stronge_original"])
def test_without_stress_the_law_is_as_it_was(law):
    """Laws whose force does not jump at the turn. Hertz's never yields, with stress or without."""
    alone = pair(law)._replace(prestress=(DEPTH, 0.0, 0.0))
    plain, ours = untouched(), untouched()
    for delta in (
        1e-6 * np.r_[np.linspace(0, 60, 40), np.linspace(60, 45, 10), np.linspace(45, 70, 9)]
    ):
        ours.stress_along = -0.5 * S_y if law == "hertz" else 0.0
        expected = plain_force(plain, alone._replace(prestress=(0.0, 0.0, 0.0)), delta)
        assert prestress.force(ours, alone, delta) == pytest.approx(expected, rel=1e-9, abs=1e-3)
    lost = energies(plain, alone._replace(prestress=(0.0, 0.0, 0.0)), delta)[1]
    assert energies(ours, alone, delta)[1] == pytest.approx(lost, rel=2e-2, abs=1e-6)


@pytest.mark.parametrize(("hardness", "share"), [(1.0, 0.5), (20.0, 1.0)])
def test_a_sphere_that_yields_as_well_is_under_no_stress(hardness, share):
    bodies = pair()._replace(shape=shape(E / S_y, 0.5, nu, 0.0, 0.0, hardness))
    contact = untouched()
    contact.stress_along = 0.3 * S_y
    F = prestress.force(contact, bodies, 2e-4)
    depth = 1.0 - finite_element.radius(contact.delta_m, E, R, S_y, nu, bodies.shape) / DEPTH
    s_x, s_y = bodies.prestress[1] * contact.F_m / S_y - 0.3 * depth, -300.0 * contact.F_m / S_y
    alone = prestress.strengthening(contact.delta_m / FIRST, s_x, s_y)
    assert F / contact.F_m - 1.0 == pytest.approx(share * (alone - 1.0), rel=1e-9)
    assert abs(alone - 1.0) > 0.01


def test_a_strip_has_its_static_stress_across_from_its_own_bending():
    """By finite differences of its equilibrium under a force and the beam's moment."""
    base = replace(il.paper_impact(), beam_model="timoshenko", contact_prestress="bending")
    beam, nu = base.beam, base.beam.material.poissons_ratio
    H, B, EI = beam.depth, beam.width, beam.bending_stiffness
    strip = bending_across(replace(base, contact_compliance="strip"))
    D_s, _, lever, T = (float(value) for value in strip[:4])
    n = 4000
    x = np.linspace(0.0, 6.0 * B, n)  # from mid-span on, where the half force acts
    M, dx = 0.5 * (x[-1] - x), x[1]
    # M = -EI kappa - nu D_s (s + nu kappa): kappa = -(M + nu D_s s)/(EI + nu^2 D_s)
    stiff = EI + nu**2 * D_s
    diagonal = -2.0 * T / dx**2 - D_s * (1.0 - nu**2 * D_s / stiff)
    bands = np.array([np.full(n, T / dx**2), np.full(n, diagonal), np.full(n, T / dx**2)])
    bands[0, 1] *= 2.0  # symmetry
    push = -nu * D_s * M / stiff
    push[0] += lever / dx
    s = solve_banded((1, 1), bands, push)
    kappa = -(M[0] + nu * D_s * s[0]) / stiff
    own = 6.0 * D_s / B / H**2 * (s[0] + nu * kappa) * (1.0 - 2.0 * AT)
    beams, strips = (
        contact_stress(replace(base, contact_compliance=name))[1] for name in ("beam", "strip")
    )
    assert own == pytest.approx(float(beams - strips), rel=2e-3)


def corrected(place, *ends, velocity=1.0, strikes=1, duration="4 ms"):
    impact = replace(il.corrected_impact(velocity), strike_position=place, strikes=strikes)
    beam = replace(impact.beam, support_left=ends[0], support_right=ends[-1])
    run = il.simulate(replace(impact, beam=beam), il.Discretisation(nodes=41), duration=duration)
    assert run.energy_error < 3e-4
    return run


@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
def test_a_dent_kinks_a_pinned_beam_which_rests_straight_on_either_side():
    run = corrected(0.3, "pinned", strikes=2)
    assert run.plastic_dissipation == 0.0
    w, dx = run.deflection.values, float(run.x[1])
    left, right = 2.0 * w[11] - w[10], 2.0 * w[13] - w[14]
    assert 0.0 < w[12] - left < -1e-3 * left  # the struck section has sunk
    assert right == pytest.approx(left, rel=1e-9)
    w[12] = left
    turns = np.diff(w, 2) / dx
    theta = turns[11]
    assert theta > 1e-6
    assert np.abs(np.delete(turns, 11)).max() < 1e-9 * theta
    assert w[12] == pytest.approx(-0.3 * 0.7 * float(run.x[-1]) * theta)


@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
def test_where_the_beam_is_struck_changes_its_kinked_contact_little():
    """Before the waves come back from the ends; other ends than pinned leave the kink out."""
    middle, left, right = (
        corrected(place, "pinned", velocity=5.0, duration="0.3 ms") for place in (0.5, 0.4, 0.6)
    )
    held = corrected(0.4, "clamped", velocity=5.0, duration="0.3 ms")
    for name in ("peak_force", "permanent_indentation"):
        assert float(left[name]) == pytest.approx(float(right[name]), rel=1e-12)
        assert float(left[name]) == pytest.approx(float(middle[name]), rel=1e-3)
        assert float(held[name]) == pytest.approx(float(middle[name]), rel=1e-2)
        assert float(held[name]) != pytest.approx(float(middle[name]), rel=1e-3)


@pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")
def test_a_foundation_holds_the_kink():
    """Too soft a one to be felt during the contact: what is missing is the kink alone."""
    base = replace(il.corrected_impact(5.0), contact_compliance="beam")
    soft = replace(base, beam=replace(base.beam, foundation_stiffness=1e3))
    grid = il.Discretisation(nodes=41)
    free, bedded, held = (
        il.simulate(impact, grid, duration="0.3 ms")
        for impact in (
            base,
            soft,
            replace(base, beam=replace(base.beam, support_left="clamped", support_right="clamped")),
        )
    )
    assert bedded.energy_error < 3e-4
    assert float(bedded.peak_force) == pytest.approx(float(held.peak_force), rel=1e-4)
    assert float(bedded.peak_force) != pytest.approx(float(free.peak_force), rel=1e-3)
