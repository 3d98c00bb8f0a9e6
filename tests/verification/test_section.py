"""The fibre section under imposed curvature, against closed forms."""

import numpy as np
import pytest

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.solve import fibre_section
from impactlab.solver import RULES
from impactlab.solver.section import bend as bend_row
from impactlab.solver.types import CASE
from impactlab.verification.cases import with_beam_material
from impactlab.verification.solutions import bending

IMPACT = il.paper_impact()


def bend(section, kappa, plastic, peeq):
    """Bend one section with its fibres' strains, shape (P // 2,)."""
    return bend_row(section, kappa, plastic[np.newaxis], peeq[np.newaxis], 0)


def make_section(points, rule, isotropic=0.0, kinematic=0.0):
    moduli = {"isotropic_hardening_modulus": isotropic, "kinematic_hardening_modulus": kinematic}
    impact = with_beam_material(IMPACT, **moduli)
    cases = case_table(impact, il.Discretisation(points=points, rule=rule), duration=1e-3)
    assert cases.dtype == CASE
    return fibre_section(cases[0]), impact.beam


def moments(cut, curvatures):
    """Moment (sign of docs/theory.md) along a history of curvature."""
    plastic_strain, peeq = np.zeros(cut.z.size), np.zeros(cut.z.size)
    history = []
    for kappa in curvatures:
        M_0, low, high = bend(cut, kappa, plastic_strain, peeq)
        assert low <= kappa * (1 + 1e-9) + 1e-12
        assert kappa <= high * (1 + 1e-9) + 1e-12 or kappa < 0
        history.append(M_0 - cut.stiffness * kappa)
    return np.array(history), plastic_strain, peeq


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("points", [2, 3, 4, 5, 9, 21, 64])
def test_monotone_bending_is_that_of_the_rule(rule, points):
    cut, beam = make_section(points, rule)
    positions, weights = bending.rule(rule, points)
    curvatures = np.linspace(0.1, 20, 40) * bending.yield_curvature(beam)
    ours, _, _ = moments(cut, curvatures)
    expected = bending.path_moments(beam, curvatures, positions, weights)
    assert -ours == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("rule", RULES)
def test_moment_curvature_tends_to_the_exact_one(rule):
    beam = IMPACT.beam
    curvatures = np.linspace(0.5, 8, 16) * bending.yield_curvature(beam)
    exact = np.array([bending.moment(beam, kappa) for kappa in curvatures])
    errors = []
    for points in (11, 41, 161):
        ours, _, _ = moments(make_section(points, rule)[0], curvatures)
        errors.append(np.abs(-ours / exact - 1).max())
    assert errors[-1] < 2e-3
    assert errors[-1] < errors[0] / 10


@pytest.mark.parametrize(("isotropic", "kinematic"), [(5e9, 0.0), (0.0, 5e9), (3e9, 2e9)])
def test_reversed_loading(isotropic, kinematic):
    """After loading, the elastic range of the outermost fibre is 2 (S_y + H_i p) wide."""
    cut, _ = make_section(9, "lobatto", isotropic, kinematic)
    E, S_y = cut.moduli.E, cut.moduli.S_y
    kappa = 6 * cut.yield_curvature
    plastic, peeq = np.zeros(cut.z.size), np.zeros(cut.z.size)
    _, low, high = bend(cut, kappa, plastic, peeq)
    # the outermost fibre by hand
    strain = kappa * cut.z[0]
    slip = (E * strain - S_y) / (E + isotropic + kinematic)
    assert peeq[0] == pytest.approx(slip, rel=1e-12)
    assert plastic[0] == pytest.approx(-slip, rel=1e-12)
    assert high == pytest.approx(kappa, rel=1e-12)
    assert high - low == pytest.approx(2 * (S_y + isotropic * slip) / (E * cut.z[0]), rel=1e-12)


def test_unloading_is_elastic():
    cut, _ = make_section(9, "lobatto", 1e9, 1e9)
    kappa_y = cut.yield_curvature
    history, _, peeq = moments(cut, np.array([3.0, 2.5, 2.0, 1.5]) * kappa_y)
    assert np.diff(history) == pytest.approx(0.5 * kappa_y * cut.stiffness, rel=1e-9)
    once = moments(cut, np.array([3.0]) * kappa_y)[2]
    assert peeq == pytest.approx(once, rel=1e-15)
