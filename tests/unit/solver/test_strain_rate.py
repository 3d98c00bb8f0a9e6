"""Fibres and contacts that yield at a rate: their stress, their work, and the static limit."""

from itertools import pairwise
from math import exp, log

import numpy as np
import pytest

from impactlab.solve import fibre_section
from impactlab.solver.fibre_plasticity import plastic_energies
from impactlab.solver.section import bend, bend_at_rate, with_rate
from impactlab.solver.strain_rate import RateLaw, overstress, rate_factor

HARDENINGS = [(0.0, 0.0), (5e9, 0.0), (0.0, 5e9), (2e9, 3e9)]
LAWS = {"Cowper-Symonds": RateLaw(40.4, 5.0, 0.0), "Johnson-Cook": RateLaw(0.5, 0.0, 0.06)}
every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
every_hardening = pytest.mark.parametrize(("isotropic", "kinematic"), HARDENINGS)


def at_rate(case):
    return with_rate(fibre_section(case), case)


def cut(make_case, isotropic=0.0, kinematic=0.0, law=LAWS["Cowper-Symonds"]):
    if law.C > 0:
        rate = {"beam_rate_sensitivity": law.C, "beam_reference_rate": law.D}
    else:
        rate = {"beam_rate_coefficient": law.D, "beam_rate_exponent": law.q}
    return at_rate(
        make_case(
            points=9,
            beam_isotropic_hardening_modulus=isotropic,
            beam_kinematic_hardening_modulus=kinematic,
            **rate,
        )
    )


def follow(section, path, dt):
    """Moments (N m), work of the overstress (J/m), plastic strains and PEEQ (steps, P // 2)."""
    strain, peeq = np.zeros((1, section.z.size)), np.zeros((1, section.z.size))
    moments, works, strains, peeqs, before = [], [], [], [], 0.0
    for kappa in path:
        M_0, _, _, work = bend_at_rate(section, section.rate, kappa, before, dt, strain, peeq, 0)
        before = kappa
        moments.append(M_0 - section.stiffness * kappa)
        works.append(work)
        strains.append(strain[0].copy())
        peeqs.append(peeq[0].copy())
    return map(np.array, (moments, works, strains, peeqs))


@pytest.mark.parametrize("trial", [1.0000001, 1.3, 5.0, 400.0])
@pytest.mark.parametrize("dt", [1e-11, 1e-8, 1e-4])
@pytest.mark.parametrize("law", [RateLaw(100.0, 1.0), RateLaw(100.0, 5.0), RateLaw(1.0, 0.0, 0.02)])
def test_the_overstress_is_the_root(trial, dt, law):
    Y, H_i, stiffness = 345e6, 2e9, 212e9
    s, slip = overstress(trial * Y, Y, H_i, stiffness, dt, law)
    if law.C > 0 and slip <= law.D * dt:
        assert s == 0
    else:
        expected = exp(s / law.C) if law.C > 0 else s**law.q
        assert slip == pytest.approx(dt * law.D * expected, rel=1e-12)
        assert s > 0
    assert trial * Y == pytest.approx((Y + H_i * slip) * (1 + s) + stiffness * slip, rel=1e-12)


def test_the_factors_are_those_of_the_papers():
    assert rate_factor(1280.0, RateLaw(40.0, 5.0, 0.0)) == pytest.approx(3.0, rel=1e-14)
    assert rate_factor(1000.0, RateLaw(2.0, 0.0, 0.02)) == pytest.approx(1 + 0.02 * log(500))
    assert rate_factor(1.9, RateLaw(2.0, 0.0, 0.02)) == 1.0
    assert rate_factor(1000.0, RateLaw()) == 1.0


@every_law
@every_hardening
def test_a_fibre_pulled_at_a_constant_rate_has_the_stress_of_the_law(
    make_case, isotropic, kinematic, law
):
    section = cut(make_case, isotropic, kinematic, law)
    rate, steps, last = 100.0, 500, 40.0 * section.yield_curvature
    dt = section.z[0] * last / steps / rate
    path = np.linspace(0.0, last, steps + 1)[1:]
    _, _, strain, peeq = follow(section, path, dt)
    flow = (peeq[-1, 0] - peeq[-2, 0]) / dt
    relative = 210e9 * (-section.z[0] * last - strain[-1, 0]) - kinematic * strain[-1, 0]
    factor = 1 + (0.06 * log(flow / 0.5) if law.C > 0 else (flow / 40.4) ** 0.2)
    assert abs(relative) == pytest.approx((345e6 + isotropic * peeq[-1, 0]) * factor, rel=1e-9)
    assert flow == pytest.approx(rate * 210e9 / (210e9 + factor * isotropic + kinematic), rel=0.02)


@every_law
@every_hardening
def test_work_of_the_moment_is_stored_dissipated_or_done_by_the_overstress(
    make_case, isotropic, kinematic, law
):
    section = cut(make_case, isotropic, kinematic, law)
    turns = [0.0, 5.0, -4.0, 2.0, 0.0]
    legs = [np.linspace(a, b, 1001)[1:] for a, b in pairwise(turns)]
    path = np.concatenate([[0.0], *legs]) * section.yield_curvature
    moments, works, strain, peeq = follow(section, path, 1e-7)
    stored, dissipated = plastic_energies(section, strain[-1:], peeq[-1:], 0)
    assert works.sum() > 0.2 * dissipated
    work = np.trapezoid(-moments, path)
    assert stored + dissipated + works.sum() == pytest.approx(work, rel=2e-4)


@pytest.mark.parametrize("law", [RateLaw(1e12, 1.0), RateLaw(1e12, 0.0, 0.02)], ids=LAWS)
@every_hardening
def test_slow_flow_is_that_of_the_static_fibres(make_case, isotropic, kinematic, law):
    section = cut(make_case, isotropic, kinematic, law)
    path = np.concatenate([np.linspace(0, 5, 50), np.linspace(5, -4, 90)])
    path *= section.yield_curvature
    _, _, strain, peeq = follow(section, path, 1e-6)
    still = np.zeros((2, 1, section.z.size))
    for kappa in path:
        bend(section, kappa, still[0], still[1], 0)
    assert strain[-1] == pytest.approx(still[0, 0], rel=1e-4, abs=1e-9)
    assert peeq[-1] == pytest.approx(still[1, 0], rel=1e-4, abs=1e-9)
