"""A fibre against closed forms; a section's elastic interval and energies."""

from itertools import pairwise

import numpy as np
import pytest

from impactlab.solve import fibre_section
from impactlab.solver import RULES
from impactlab.solver.fibre_plasticity import plastic_energies
from impactlab.solver.section import bend as bend_row
from impactlab.solver.section import return_mapping
from impactlab.verification.solutions import bending

HARDENINGS = [(0.0, 0.0), (5e9, 0.0), (0.0, 5e9), (2e9, 3e9)]
every_hardening = pytest.mark.parametrize(("isotropic", "kinematic"), HARDENINGS)


@pytest.fixture
def cut(make_case):
    """A function that makes a section of the paper's beam."""

    def make(rule="lobatto", points=9, isotropic=0.0, kinematic=0.0):
        return fibre_section(
            make_case(
                rule=rule,
                points=points,
                beam_isotropic_hardening_modulus=isotropic,
                beam_kinematic_hardening_modulus=kinematic,
            )
        )

    return make


def bend(section, kappa, plastic, peeq):
    """Bend one section with its fibres' strains, shape (P // 2,)."""
    return bend_row(section, kappa, plastic[np.newaxis], peeq[np.newaxis], 0)


def follow(section, curvatures):
    """((M_0, kappa_min, kappa_max), moments, plastic strain, PEEQ) along a path."""
    plastic, peeq = np.zeros(section.z.size), np.zeros(section.z.size)
    interval, moments = (0.0, -section.yield_curvature, section.yield_curvature), []
    for kappa in curvatures:
        interval = bend(section, kappa, plastic, peeq)
        moments.append(interval[0] - section.stiffness * kappa)
    return interval, np.array(moments), plastic, peeq


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("points", [2, 3, 8, 9])
def test_fibres_are_the_rules_scaled_to_the_depth(cut, rule, points):
    section = cut(rule, points)
    positions, weights = bending.rule(rule, points)
    z, area = positions * 0.0139, weights * 0.0139 * 0.06
    upper = slice(None, -(points // 2) - 1, -1)
    assert section.z == pytest.approx(z[upper], rel=1e-12)
    assert section.area == pytest.approx(2 * area[upper], rel=1e-12)
    assert section.stiffness == pytest.approx(210e9 * np.sum(area * z**2), rel=1e-12)
    assert section.yield_curvature == pytest.approx(345e6 / (210e9 * z.max()), rel=1e-12)


@every_hardening
def test_interval_ends_where_the_first_fibre_yields(cut, isotropic, kinematic):
    section = cut(isotropic=isotropic, kinematic=kinematic)
    kappa_y = section.yield_curvature
    (_, low, high), _, plastic, peeq = follow(section, np.array([4.0, -2.0, 3.0]) * kappa_y)
    assert high == pytest.approx(3 * kappa_y, rel=1e-12)
    for end, outwards in ((low, -1.0), (high, 1.0)):
        inside, outside = (end + sign * outwards * 1e-9 * kappa_y for sign in (-1.0, 1.0))
        for kappa, flows in ((inside, False), (outside, True)):
            after = peeq.copy()
            bend(section, kappa, plastic.copy(), after)
            assert np.any(after > peeq) == flows


@every_hardening
def test_work_of_the_moment_is_stored_or_dissipated(cut, isotropic, kinematic):
    """Along a path back to zero curvature; kappa = w_xx, so the work is that of -M."""
    section = cut(isotropic=isotropic, kinematic=kinematic)
    turns = [0.0, 5.0, -4.0, 2.0, 0.0]
    legs = [np.linspace(a, b, 501)[1:] for a, b in pairwise(turns)]
    path = np.concatenate([[0.0], *legs]) * section.yield_curvature
    _, moments, plastic, peeq = follow(section, path)
    work = np.trapezoid(-moments, path)
    stored, dissipated = plastic_energies(section, plastic[np.newaxis], peeq[np.newaxis], 0)
    assert stored > 0
    assert stored + dissipated == pytest.approx(work, rel=1e-4)


E, S_y = 210e9, 345e6
YIELD_STRAIN = S_y / E
FIBRE_HARDENINGS = [(0.0, 0.0), (5e9, 0.0), (0.0, 5e9), (2e9, 40e9)]

every_fibre_hardening = pytest.mark.parametrize(("H_i", "H_k"), FIBRE_HARDENINGS)


@every_fibre_hardening
@pytest.mark.parametrize("sign", [-1, 1])
def test_one_step_is_the_closed_form(H_i, H_k, sign):
    """stress = S_y + H (strain - yield strain) E/(E + H), H the sum of the moduli."""
    strain, H = 5 * YIELD_STRAIN, H_i + H_k
    plastic, peeq = return_mapping(sign * strain, 0.0, 0.0, E, S_y, H_i, H_k)
    stress = E * (sign * strain - plastic)
    expected = S_y + E * H / (E + H) * (strain - YIELD_STRAIN)
    assert stress == pytest.approx(sign * expected, rel=1e-13)
    assert plastic == pytest.approx(sign * (strain - expected / E), rel=1e-13)
    assert peeq == pytest.approx(abs(plastic), rel=1e-15)


@every_fibre_hardening
def test_after_a_slip_the_fibre_lies_on_its_yield_surface(H_i, H_k):
    for strain in (3 * YIELD_STRAIN, -5 * YIELD_STRAIN):
        plastic, peeq = return_mapping(strain, 2e-3, 7e-3, E, S_y, H_i, H_k)
        distance = abs(E * (strain - plastic) - H_k * plastic) - (S_y + H_i * peeq)
        assert distance == pytest.approx(0, abs=1e-6 * S_y)
        assert peeq > 7e-3
        assert return_mapping(strain, plastic, peeq, E, S_y, H_i, H_k) == pytest.approx(
            (plastic, peeq), rel=1e-14
        )
