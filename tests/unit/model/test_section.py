"""Rules by Newton's method against scipy's eigenvalues; sections against integrals over them."""

from dataclasses import replace

import numpy as np
import pytest
from shapes import beam_of

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.discretisation import integration_rule
from impactlab.model.section import SHAPES, fibre_table, section_of
from impactlab.solver import RULES
from impactlab.verification.solutions import bending

COUNTS = [*range(2, 22), 32, 33, 48, 63, 64]


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("points", COUNTS)
def test_points_and_weights_are_those_of_scipy(rule, points):
    positions, weights = integration_rule(rule, points)
    expected_positions, expected_weights = bending.rule(rule, points)
    np.testing.assert_allclose(positions, expected_positions, rtol=1e-13, atol=1e-14)
    np.testing.assert_allclose(weights, expected_weights, rtol=1e-11, atol=0)
    np.testing.assert_array_equal(positions, -positions[::-1])
    assert np.any(positions == 0) == points % 2


def test_plate_of_a_rectangle():
    """Its other properties are tested with those of all shapes."""
    section = il.paper_impact().beam.section
    plate = section.bending_stiffness(2e11) / (1 - 0.3**2)
    assert section.plate_stiffness(2e11, 0.3) == pytest.approx(plate, rel=1e-12)


def test_kernels_get_the_fibres_above_the_axis_twice_outermost_first():
    varied = {"points": [4, 9, 4], "rule": ["lobatto", "legendre", "layers"]}
    varied["beam_depth"] = [0.02, 0.03, 0.04]
    cases = case_table(il.paper_impact(), il.Discretisation(), duration=1e-3, varied=varied)
    table = fibre_table(cases)
    assert table.shape == (3, 3, 4)
    for case, row, rule in zip(cases, table, varied["rule"], strict=True):
        z, area = section_of(case).fibres(*bending.rule(rule, int(case.points)))
        half = case.points // 2
        np.testing.assert_allclose(row[0, :half], z[::-1][:half], rtol=1e-13)
        np.testing.assert_allclose(row[1, :half], 2 * area[::-1][:half], rtol=1e-11)
        assert not row[:, half:].any()


@pytest.mark.parametrize("shape", SHAPES)
def test_kernels_take_the_section_of_the_beam(shape):
    impact = replace(il.paper_impact(), beam=beam_of(shape))
    section = section_of(case_table(impact, il.Discretisation(), duration=1e-3)[0])
    assert section == impact.beam.section
