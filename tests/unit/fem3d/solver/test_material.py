"""Radial return against closed forms: one step, cycles with hardening, and constant rates."""

import numpy as np
import pytest

from impactlab.fem3d.solver.material import mises, radial_return, slip_at_rate
from impactlab.fem3d.solver.system import metal, rate_law
from impactlab.model.material import Material
from impactlab.verification.solutions.bending import path_stresses

E, NU, SIGMA = 200e9, 0.25, 300e6
G = E / 2 / (1 + NU)
NONE = (0.0,) * 6


RATES = {
    "cowper_symonds": {"rate_coefficient": 40.4, "rate_exponent": 5.0},
    "johnson_cook": {"rate_sensitivity": 0.03, "reference_rate": 0.5},
}
every_rate = pytest.mark.parametrize("name", RATES)


def steel(isotropic=0.0, kinematic=0.0, modulus=E, **rate):
    return Material(
        density=7800.0,
        youngs_modulus=modulus,
        poissons_ratio=NU,
        yield_stress=SIGMA,
        isotropic_hardening_modulus=isotropic,
        kinematic_hardening_modulus=kinematic,
        **rate,
    )


def factor(name, rate):
    """The yield stress over the static one."""
    if name == "johnson_cook":
        return 1 + 0.03 * max(np.log(rate / 0.5), 0.0)
    return 1 + (rate / 40.4) ** 0.2


def test_within_the_yield_surface_nothing_happens():
    trial = (1e8, -4e7, -6e7, 2e7, -3e7, 5e7)
    s, a, dp, along = radial_return(trial, NONE, 0.0, metal(steel(1e9, 2e9)))
    assert s == trial
    assert a == NONE
    assert dp == along == 0.0
    # tau = G gamma_e, yield at sigma/sqrt(3); slope 3 G/(3 G + H) of the stress left.
    H_i, H_k, p = 3e9, 7e9, 0.01
    trial = (0.0, 0.0, 0.0, 4e8, 0.0, 0.0)
    s, a, dp, along = radial_return(trial, NONE, p, metal(steel(H_i, H_k)))
    beyond = np.sqrt(3) * 4e8 - SIGMA - H_i * p
    assert dp == pytest.approx(beyond / (3 * G + H_i + H_k), rel=1e-14)
    assert s[3] == pytest.approx(4e8 - np.sqrt(3) * G * dp, rel=1e-14)
    assert a[3] == pytest.approx(H_k * dp / np.sqrt(3), rel=1e-14)
    assert along == 0.0
    left = tuple(one - other for one, other in zip(s, a, strict=True))
    assert mises(left) == pytest.approx(SIGMA + H_i * (p + dp), rel=1e-14)
    # a return goes straight to the surfaces centre
    trial, back = (
        np.array([5e8, -3e8, -2e8, 1e8, -4e8, 2e8]),
        np.array([4e7, 1e7, -5e7, 3e7, 0.0, 6e7]),
    )
    s, _, _, along = radial_return(tuple(trial), tuple(back), 0.0, metal(steel()))
    kept = (np.array(s) - back) / (trial - back)
    np.testing.assert_allclose(kept, kept[0], rtol=1e-13)
    assert mises(tuple(np.array(s) - back)) == pytest.approx(SIGMA, rel=1e-13)
    assert along == pytest.approx((trial[0] - s[0]) / (2 * G), rel=1e-12)


@pytest.mark.parametrize(("isotropic", "kinematic"), [(0.0, 0.0), (5e9, 0.0), (0.0, 5e9)])
def test_cycles_along_one_axis_follow_the_fibre(isotropic, kinematic):
    """A deviator along x is a fibre of modulus 3 G: stress 3/2 s_xx against strain e_xx."""
    turns = np.concatenate(
        [np.linspace(a, b, 60)[1:] for a, b in ((0, 6), (6, -7), (-7, 8), (8, 0))]
    )
    strains = 1e-3 * np.concatenate([[0.0], turns])
    material = steel(isotropic, kinematic)
    fibre = path_stresses(steel(isotropic, kinematic, modulus=3 * G), strains)
    s, a, p, stresses, along = NONE, NONE, 0.0, [0.0], 0.0
    for step in np.diff(strains):
        trial = tuple(np.array(s) + 2 * G * step * np.array([1, -0.5, -0.5, 0, 0, 0]))
        s, a, dp, rise = radial_return(trial, a, p, metal(material))
        p, along = p + dp, along + rise
        stresses.append(1.5 * s[0])
    np.testing.assert_allclose(stresses, fibre, atol=1e-9 * SIGMA)
    assert along == pytest.approx(strains[-1] - stresses[-1] / (3 * G), rel=1e-9)


def test_both_hardenings_add_up_in_a_first_loading():
    s, a, p = NONE, NONE, 0.0
    for _ in range(50):
        trial = tuple(np.array(s) + 2 * G * 1e-4 * np.array([1, -0.5, -0.5, 0, 0, 0]))
        s, a, dp, _ = radial_return(trial, a, p, metal(steel(4e9, 6e9)))
        p += dp
    strain = 5e-3
    slope = 3 * G * 10e9 / (3 * G + 10e9)
    first = SIGMA / (3 * G)
    assert 1.5 * s[0] == pytest.approx(SIGMA + slope * (strain - first), rel=1e-12)
    assert 1.5 * a[0] == pytest.approx(6e9 * p, rel=1e-12)


@every_rate
@pytest.mark.parametrize("beyond", [1e-7, 0.01, 0.3, 30.0])
@pytest.mark.parametrize("dt", [1e-9, 1e-5])
def test_slip_at_a_rate_is_the_root(name, beyond, dt):
    Y, H_i, H_k = 1.2 * SIGMA, 3e9, 7e9
    q = (1.0 + beyond) * Y
    dp = slip_at_rate(q, Y, 3 * G + H_k, H_i, dt, rate_law(steel(**RATES[name])))
    left = (Y + H_i * dp) * factor(name, dp / dt) + (3 * G + H_k) * dp
    assert dp > 0
    assert left == pytest.approx(q, rel=1e-11)


@every_rate
@pytest.mark.parametrize(("isotropic", "kinematic"), [(0.0, 0.0), (5e9, 0.0), (0.0, 5e9)])
def test_a_constant_rate_gives_the_stress_of_the_law(name, isotropic, kinematic):
    """Along one axis: 3/2 s_xx, less 3/2 of the back stress, is the yield stress at its rate."""
    material = steel(isotropic, kinematic, **RATES[name])
    rate, steps, strain = 200.0, 400, 0.02
    s, a, p, dt, dp = NONE, NONE, 0.0, strain / steps / rate, 0.0
    for _ in range(steps):
        step = 2 * G * strain / steps * np.array([1, -0.5, -0.5, 0, 0, 0])
        trial = tuple(np.array(s) + step)
        s, a, dp, _ = radial_return(trial, a, p, metal(material), dt, rate_law(material))
        p += dp
    hardened = SIGMA + isotropic * p
    assert 1.5 * (s[0] - a[0]) == pytest.approx(hardened * factor(name, dp / dt), rel=1e-10)
    slope = factor(name, dp / dt) * isotropic + kinematic
    assert dp / dt == pytest.approx(rate * 3 * G / (3 * G + slope), rel=0.01)


def test_without_a_law_the_step_has_no_duration():
    material, trial = steel(1e9, 2e9), (5e8, -3e8, -2e8, 1e8, -4e8, 2e8)
    assert rate_law(material) is None
    still = radial_return(trial, NONE, 0.01, metal(material))
    assert radial_return(trial, NONE, 0.01, metal(material), 1e-6, None) == still
    slow = steel(1e9, 2e9, rate_sensitivity=0.03, reference_rate=1e9)
    rated = radial_return(trial, NONE, 0.01, metal(slow), 1e-6, rate_law(slow))
    np.testing.assert_allclose(np.hstack(rated), np.hstack(still), rtol=1e-12)
