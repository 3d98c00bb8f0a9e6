"""A fibre against closed forms; a section's elastic interval and energies."""

from itertools import pairwise

import numpy as np
import pytest

import impactlab as il
from impactlab.solve import fibre_section
from impactlab.solver import RULES
from impactlab.solver.fibre_plasticity import plastic_energies
from impactlab.solver.section import bend as bend_row
from impactlab.solver.section import elastic_range, return_mapping
from impactlab.verification.solutions import bending

BEAM = il.paper_impact().beam
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


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("points", [2, 3, 4, 5, 9, 21, 64])
def test_monotone_bending_is_that_of_the_rule(cut, rule, points):
    curvatures = np.linspace(0.1, 20, 40) * bending.yield_curvature(BEAM)
    _, moments, _, _ = follow(cut(rule, points), curvatures)
    expected = bending.path_moments(BEAM, curvatures, *bending.rule(rule, points))
    assert -moments == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("rule", RULES)
def test_moment_curvature_tends_to_the_exact_one(cut, rule):
    curvatures = np.linspace(0.5, 8, 16) * bending.yield_curvature(BEAM)
    exact = np.array([bending.moment(BEAM, kappa) for kappa in curvatures])
    moments = [follow(cut(rule, points), curvatures)[1] for points in (11, 41, 161)]
    errors = [np.abs(-ours / exact - 1).max() for ours in moments]
    assert errors[-1] < 2e-3
    assert errors[-1] < errors[0] / 10


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


def test_bending_the_other_way_is_the_mirror_image(cut):
    section = cut(isotropic=1e9, kinematic=2e9)
    path = np.array([5.0, -4.0, 1.0]) * section.yield_curvature
    (M_0, low, high), moments, plastic, peeq = follow(section, path)
    mirrored = follow(section, -path)
    assert mirrored[0] == pytest.approx((-M_0, -high, -low), rel=1e-14)
    assert mirrored[1] == pytest.approx(-moments, rel=1e-14)
    assert mirrored[2] == pytest.approx(-plastic, rel=1e-14)
    assert mirrored[3] == pytest.approx(peeq, rel=1e-14)


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


def strain_fibre(strains, H_i, H_k):
    """(stress, plastic strain, PEEQ) along a path from the virgin fibre, each of its shape."""
    plastic, peeq, states = 0.0, 0.0, []
    for strain in strains:
        plastic, peeq = return_mapping(strain, plastic, peeq, E, S_y, H_i, H_k)
        states.append((E * (strain - plastic), plastic, peeq))
    return np.array(states).T


def path(*turns, steps=200):
    """Strains from 0 through the turns (in yield strains)."""
    ends = np.array([0.0, *turns]) * YIELD_STRAIN
    legs = [np.linspace(a, b, steps + 1)[1:] for a, b in pairwise(ends)]
    return np.concatenate([[0.0], *legs])


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
def test_one_step_is_many_steps(H_i, H_k):
    once = strain_fibre([6 * YIELD_STRAIN, -4 * YIELD_STRAIN], H_i, H_k)[:, -1]
    slowly = strain_fibre(path(6, -4), H_i, H_k)[:, -1]
    assert slowly == pytest.approx(once, rel=1e-12)


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


def reverse_yield_stress(H_i, H_k):
    """(stress at the turn, stress at which the fibre then yields in reverse)."""
    stress, plastic, peeq = strain_fibre([6 * YIELD_STRAIN], H_i, H_k)[:, 0]
    least, _ = elastic_range(plastic, peeq, E, S_y, H_i, H_k)
    return stress, E * (least - plastic)


@pytest.mark.parametrize("kinematic", [True, False])
def test_bauschinger_with_kinematic_hardening_alone(kinematic):
    """The elastic range keeps its width of 2 S_y; isotropic hardening widens it to both sides."""
    stress, reverse = reverse_yield_stress(*((0.0, 20e9) if kinematic else (20e9, 0.0)))
    assert stress > 1.2 * S_y
    assert reverse == pytest.approx(stress - 2 * S_y if kinematic else -stress, rel=1e-12)


def test_cycles_shake_down_with_isotropic_hardening_alone():
    """Between fixed strains it ends up elastic; with kinematic hardening it flows for ever."""
    cycles = path(*[2, -2] * 40, steps=20)
    isotropic, kinematic = strain_fibre(cycles, 60e9, 0.0)[2], strain_fibre(cycles, 0.0, 60e9)[2]
    cycle = slice(-41, None, 40)
    assert np.diff(isotropic[cycle])[0] < 1e-3 * YIELD_STRAIN
    # the loop repeats itself: each half slips by (4 eps_y E - 2 S_y)/(E + H_k)
    expected = 2 * (4 * YIELD_STRAIN * E - 2 * S_y) / (E + 60e9)
    assert np.diff(kinematic[cycle])[0] == pytest.approx(expected, rel=1e-10)
