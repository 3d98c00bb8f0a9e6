"""The contact's memory: loading, unloading, reloading, and where the work goes."""

import numpy as np
import pytest
from scipy.integrate import quad

import impactlab as il
from impactlab.solver.contact import LAWS
from impactlab.solver.contact.history import (
    CONTACT,
    Pair,
    energies,
    force,
    load,
    make_pair,
)
from impactlab.solver.contact.switch import curve
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.contact_laws import StrongeImpact

E, R, S_y, nu = 115e9, 0.035, 345e6, 0.3
STRONGE = StrongeImpact(E, R, S_y)
DEEP = 40 * STRONGE.yield_indentation

every_law = pytest.mark.parametrize("law", LAWS)


def pair_of(law):
    return Pair(LAWS.index(law), E, R, S_y, nu)


def untouched():
    contact = np.zeros(1, CONTACT)[0]
    contact.n = 1.5
    return contact


def along(contact, pair, deltas):
    return np.array([force(contact, pair, delta) for delta in deltas])


def loading_force(pair, delta):
    return curve(pair.law, delta, pair.E, pair.R, pair.S_y, pair.nu)[0]


@every_law
def test_reloading_retraces_unloading_and_then_loading_goes_on(law):
    contact, pair = untouched(), pair_of(law)
    along(contact, pair, np.linspace(0, DEEP, 50))
    back = np.linspace(DEEP, 0, 201)[1:-1]
    unloading = along(contact, pair, back)
    reloading = along(contact, pair, back[::-1])
    assert np.array_equal(unloading[::-1], reloading)
    assert contact.delta_m == DEEP
    deeper = np.linspace(1.001, 2, 20) * DEEP
    fresh = np.array([loading_force(pair, delta) for delta in deeper])
    assert np.array_equal(along(contact, pair, deeper), fresh)
    assert contact.delta_m == deeper[-1]


@every_law
def test_unloading_leaves_the_furthest_point_without_a_jump_and_never_pulls(law):
    """But for stronge_original, whose jump test_laws.py measures."""
    contact, pair = untouched(), pair_of(law)
    top = force(contact, pair, DEEP)
    if law != "stronge_original":
        assert force(contact, pair, DEEP * (1 - 1e-12)) == pytest.approx(top, rel=1e-9)
    forces = along(contact, pair, np.linspace(DEEP, -DEEP, 101))
    assert forces.min() == 0.0
    assert np.all(np.diff(forces) <= 0)
    assert force(contact, pair, contact.delta_r) == 0.0


@every_law
@pytest.mark.parametrize("exponent", [1.5, 2.0])
def test_unloading_follows_the_exponent_of_the_curve(law, exponent):
    contact, pair = untouched(), pair_of(law)
    load(contact, pair, DEEP)
    contact.n = exponent
    over = 0.5 * (DEEP - contact.delta_r)
    expected = contact.K * over**exponent
    assert force(contact, pair, contact.delta_r + over) == pytest.approx(expected, rel=1e-14)


@every_law
def test_work_along_a_path_is_stored_or_dissipated(law):
    """Loading, partial unloading, reloading further, unloading: against scipy's quadrature."""
    contact, pair = untouched(), pair_of(law)

    def go(start, stop):
        """Work (J) that the path takes: asked at many points, as the audit does."""
        for delta in np.linspace(start, stop, 101)[1:]:
            force(contact, pair, delta)
            energies(contact, pair, delta)
        stored, dissipated = energies(contact, pair, stop)
        return stored + dissipated

    def on_loading(start, stop):
        return quad(lambda delta: loading_force(pair, delta), start, stop, epsrel=1e-10)[0]

    def on_unloading(start, stop):
        K, dent, n = contact.K, contact.delta_r, contact.n
        return quad(lambda delta: K * max(delta - dent, 0) ** n, start, stop, epsrel=1e-10)[0]

    first = on_loading(0, DEEP)
    assert go(0, DEEP) == pytest.approx(first, rel=1e-5)
    half = 0.5 * (DEEP + contact.delta_r)
    back = on_unloading(DEEP, half)
    assert go(DEEP, half) == pytest.approx(first + back, rel=1e-5)
    further = on_loading(DEEP, 2 * DEEP)
    assert go(half, 2 * DEEP) == pytest.approx(first + further, rel=1e-5)
    released = on_unloading(2 * DEEP, contact.delta_r)
    rest = first + further + released
    assert go(2 * DEEP, contact.delta_r) == pytest.approx(rest, abs=1e-5 * first)
    stored, dissipated = energies(contact, pair, -DEEP)
    assert stored == 0.0
    assert dissipated == pytest.approx(rest, abs=1e-5 * first)
    assert dissipated > 0.1 * first or law in ("hertz", "hunt_crossley")


def test_pair_of_the_papers_case(make_case):
    pair, impact = make_pair(make_case()), il.paper_impact()
    assert hertz.effective_modulus(impact) == pytest.approx(pair.E, rel=1e-14)
    assert impact.sphere.radius == pair.R
    assert LAWS[pair.law] == impact.contact


@pytest.mark.parametrize(("sphere", "beam"), [(300e6, 345e6), (345e6, 300e6)])
def test_the_softer_body_yields(make_case, sphere, beam):
    case = make_case(
        sphere_yield_stress=sphere,
        sphere_poissons_ratio=0.25,
        beam_yield_stress=beam,
        beam_poissons_ratio=0.35,
        beam_width=0.03,
        beam_model="timoshenko",
        contact_compliance="strip",
    )
    pair = make_pair(case)
    assert pair.S_y == 300e6
    assert pair.nu == (0.25 if sphere < beam else 0.35)
    assert (max(pair.crowding) > 0.0) == (sphere > beam)  # a sphere has no sides
