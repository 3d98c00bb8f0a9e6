"""Every contact law through the same tests; its flaws are those that the registry has."""

import re
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from impactlab.solver.contact import CONTACT_LAWS, LAWS, finite_element, metals
from impactlab.solver.contact.switch import curve, limit
from impactlab.verification.solutions.contact_laws import LAWS as REFERENCE
from impactlab.verification.solutions.contact_laws import LawOnHalfSpace, joints

STEEL = (115e9, 0.035, 345e6, 0.3)
SOFT = (40e9, 0.002, 40e6, 0.35)
HARD = (100e9, 0.01, 2e9, 0.25)
BODIES = {"steel": STEEL, "soft": SOFT, "hard": HARD}

every_law = pytest.mark.parametrize("law", LAWS)
every_pair = pytest.mark.parametrize("bodies", BODIES.values(), ids=BODIES)


def first_yield(law, bodies=STEEL):
    """Indentation of first yield by the law's own measure, which is that of nu = 0.3."""
    E, R, S_y, _ = bodies
    return R * (0.5 * np.pi * CONTACT_LAWS[law].yield_pressure * S_y / E) ** 2


def depths(law, bodies, number=2001):
    """From 1e-6 of the sphere's radius to the law's limit, none on a joint."""
    return np.geomspace(1e-6 * bodies[1], limit(LAWS.index(law), *bodies), number)


def along(law, bodies, deltas):
    """(F, K, delta_r, n), each of the shape of `deltas`; of bodies of one modulus."""
    if law == "finite_element":
        E, _, S_y, nu = bodies
        of = metals.shape(E / S_y, 0.5, nu, 0.0, 0.0, np.inf)
        return np.array([finite_element.curve(delta, *bodies, of) for delta in deltas]).T
    return np.array([curve(LAWS.index(law), delta, *bodies) for delta in deltas]).T


def released(deltas, K, delta_r, n):
    return K * (deltas - delta_r) ** (n + 1) / (n + 1)


def test_every_law_has_its_file_and_its_texts():
    for name in LAWS:
        assert import_module(f"impactlab.solver.contact.{name}").__doc__
        law = CONTACT_LAWS[name]
        assert law.name == name
        assert all((law.title, law.source, law.holds_for))
    # All but those added since, which the registry must mark as unconfirmed until they are.
    assert set(LAWS[:8]) <= set(REFERENCE) <= set(LAWS)
    assert all(CONTACT_LAWS[law].unconfirmed for law in LAWS if law not in REFERENCE)
    # the page has every law derived twice and none that is unknown
    page = Path(__file__).parents[4] / "docs" / "contact_laws.md"
    tables = [line for line in page.read_text(encoding="utf-8").splitlines() if line[:1] == "|"]
    named = [name for line in tables for name in re.findall(r"`(\w+)`", line.split("|")[1])]
    assert set(named) <= set(LAWS)
    assert all(named.count(name) == 2 for name in REFERENCE)


@pytest.mark.parametrize("law", REFERENCE)
@every_pair
def test_force_and_unloading_are_those_of_the_formulas(law, bodies):
    deltas = np.append(depths(law, bodies, 201), 2.0 * limit(LAWS.index(law), *bodies))
    formulas = LawOnHalfSpace(law, *bodies)
    F, K, delta_r, n = along(law, bodies, deltas)
    expected = np.array([formulas.loading_force(delta) for delta in deltas])
    np.testing.assert_allclose(F, expected, rtol=1e-12)
    start, end, exponent = np.array([formulas.unloading(delta) for delta in deltas]).T
    np.testing.assert_allclose(K * (deltas - delta_r) ** n, start, rtol=1e-8)
    np.testing.assert_allclose(delta_r, end, atol=1e-12 * deltas.max())
    np.testing.assert_allclose(n, exponent, rtol=1e-13)


@every_law
@every_pair
def test_hertz_until_first_yield(law, bodies):
    """Other ratios of Poisson than that of the record move first yield by less than a tenth.

    The fit to finite elements has a dent from where the von Mises stress reaches the yield stress.
    """
    share = 0.999 if bodies == STEEL else 0.9
    if law == "finite_element":
        share = 0.999 * (min(metals.first_yield(bodies[3]), 1.0) / metals.first_yield(0.3)) ** 2
    below = [share * first_yield(law, bodies)]
    np.testing.assert_allclose(along(law, bodies, below), along("hertz", bodies, below), rtol=1e-14)


@every_law
@every_pair
def test_force_is_never_negative_and_grows_within_the_laws_range(law, bodies):
    F = along(law, bodies, depths(law, bodies))[0]
    assert F[0] > 0
    assert np.all(np.diff(F) > 0)


def candidates(law):
    """Return where the loading force of steel may jump: first yield, known joints, those stated."""
    stated = first_yield(law) * np.array([at for at, _ in CONTACT_LAWS[law].jumps])
    found = [
        d
        for d in [first_yield(law), *joints(*STEEL)]
        if not np.isclose(d, stated, rtol=1e-12).any()
    ]
    return np.sort([*found, *stated])


@every_law
def test_jumps_of_the_loading_force(law):
    """Told from steep by halving the step: a jump stays."""
    jumps = []
    for joint in (d for d in candidates(law) if d < limit(LAWS.index(law), *STEEL) * 1.01):
        F = along(law, STEEL, joint * np.array([1 - 1e-9, 1 + 1e-9]))[0]
        if abs(F[1] / F[0] - 1) > 1e-7:
            jumps.append((joint / first_yield(law), F[1] / F[0] - 1))
    stated = CONTACT_LAWS[law].jumps
    np.testing.assert_allclose(np.ravel(jumps), np.ravel(stated), rtol=2e-3)


@every_law
def test_no_jump_elsewhere(law):
    deltas = depths(law, STEEL, 20001)
    far = np.min(np.abs(np.log(deltas[:-1, None] / candidates(law))), axis=1) > 1e-3
    F = along(law, STEEL, deltas)[0]
    assert np.all(np.diff(np.log(F))[far] < 3 * np.diff(np.log(deltas))[far])


@every_law
def test_force_at_the_start_of_unloading(law):
    """Unloading starts where the source says, and never above the loading force."""
    deltas = depths(law, STEEL)
    F, K, delta_r, n = along(law, STEEL, deltas)
    share = K * (deltas - delta_r) ** n / F
    assert share.max() < 1 + 1e-9
    assert share.min() == pytest.approx(CONTACT_LAWS[law].unloading_start, rel=1e-6)


@every_law
def test_energy_created_and_where(law):
    """Restitution after every depth, the work by scipy's quadrature of the kernel's own curve."""
    unit = first_yield(law)
    ratios = np.concatenate([np.linspace(0.5, 3.5, 1201), np.geomspace(3.5, 1e3, 60)])
    deltas = unit * ratios[unit * ratios < limit(LAWS.index(law), *STEEL)]
    _, K, delta_r, n = along(law, STEEL, deltas)
    ends = np.unique(np.concatenate([[0.0], candidates(law), deltas]))
    pieces = [
        quad(lambda d: along(law, STEEL, [d])[0][0], *ends[i : i + 2], epsrel=1e-9)[0]
        for i in range(ends.size - 1)
    ]
    work = np.interp(deltas, ends, np.append(0.0, np.cumsum(pieces)))
    restitution = np.sqrt(released(deltas, K, delta_r, n) / work)
    flaws = CONTACT_LAWS[law]
    assert restitution.max() == pytest.approx(flaws.restitution, abs=2e-4)
    creating = deltas[restitution > 1 + 1e-6] / unit
    if flaws.restitution == 1.0:
        assert creating.size == 0
    else:
        assert creating[[0, -1]] == pytest.approx(flaws.creates, abs=5e-3)
    assert (delta_r / deltas).min() == pytest.approx(flaws.dent, abs=2e-4)
    assert restitution[-1] < 0.6 or law in ("hertz", "hunt_crossley")  # its loss is the damper's


@every_law
@every_pair
def test_dent_is_shallower_than_the_indentation_even_beyond_the_range(law, bodies):
    deltas = np.geomspace(1e-6, 1, 400) * bodies[1]
    F, K, delta_r, n = along(law, bodies, deltas)
    assert np.isfinite(F).all()
    assert np.all(delta_r < deltas)
    assert np.all(K > 0)
    assert np.all(n > 1)


@every_law
def test_what_it_does_to_energy_is_said(law):
    """A flaw that the tests know is one that the reader is told."""
    flaws, told = CONTACT_LAWS[law], CONTACT_LAWS[law].flaws
    assert ("jumps" in told) == bool(flaws.jumps)
    assert ("creates energy" in told) == (flaws.restitution > 1)
    assert ("dent below zero" in told) == (flaws.dent < 0)
    assert ("begins below the loading force" in told) == (flaws.unloading_start < 1)


@pytest.mark.parametrize(
    ("law", "name", "radius"),
    [
        ("jackson_green", "steel", 0.41),
        ("jackson_green", "hard", 0.41),
        *(("brake", name, 1.0) for name in BODIES),
    ],
)
def test_limits_are_where_the_contact_circle_has_that_radius(law, name, radius):
    E, R, S_y, nu = BODIES[name]
    d = limit(LAWS.index(law), *BODIES[name])
    d_c = R * (0.5 * np.pi * 1.295 * np.exp(0.736 * nu) * S_y / E) ** 2
    B = 0.14 * np.exp(23 * S_y / E)
    assert np.sqrt(d / R * (d / d_c / 1.9) ** B) == pytest.approx(radius, rel=1e-12)


@pytest.mark.parametrize(("law", "radii"), [("hertz", 1.0), ("stronge", 0.5), ("thornton", 1.0)])
def test_limits_of_laws_without_one_are_the_spheres(law, radii):
    assert limit(LAWS.index(law), *STEEL) == pytest.approx(radii * STEEL[1], rel=1e-3)


def test_limits_of_the_fits():
    d_c = first_yield("jackson_green")
    assert limit(LAWS.index("kogut_etsion"), *STEEL) == pytest.approx(
        110 * first_yield("kogut_etsion"), rel=1e-12
    )
    assert limit(LAWS.index("mjg"), *STEEL) == pytest.approx(4725 * d_c, rel=1e-4)
    F, _, delta_r, _ = curve(LAWS.index("mjg"), 4700 * d_c, *STEEL)
    assert F > 0
    assert 0.98 * 4700 * d_c < delta_r < 0.99 * 4700 * d_c
    # an unknown number has no limit
    assert np.isnan(limit(len(LAWS), *STEEL))
