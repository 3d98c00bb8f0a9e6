"""The kink of a dented beam: its size in 3-D, its place, and the energy that it takes."""

from dataclasses import replace

import numpy as np
import pytest

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.simulate import run_dataset
from impactlab.solver import kink
from impactlab.solver.beam import make_beam, make_grid
from impactlab.solver.contact.history import CONTACT, load, make_pair

PAPER = il.corrected_impact(5.0)


def other(depth, radius):
    sphere = replace(PAPER.sphere, radius=radius)
    return replace(PAPER, beam=replace(PAPER.beam, depth=depth), sphere=sphere)


@pytest.mark.parametrize(
    ("impact", "angle"),
    [
        (replace(PAPER, velocity=0.99), 1.110e-5),
        (replace(PAPER, velocity=2.0), 3.600e-5),
        (PAPER, 1.141e-4),
        (other(40e-3, 20e-3), 2.798e-5),
        (other(15e-3, 20e-3), 9.609e-5),
    ],
)
def test_angle_is_that_of_three_dimensions(impact, angle):
    grid = il.Discretisation(nodes=101)
    case = case_table(impact, grid, duration=1e-3)[0]
    run = run_dataset(impact, grid, duration=0.3e-3)
    contact, pair, total = np.zeros(1, CONTACT)[0], make_pair(case), 0.0
    for delta, curvature in zip(run.indentation.values, run.midspan_curvature.values, strict=True):
        if delta > contact.delta_m:
            load(contact, pair, delta)
            contact.stress_along = -case.beam_youngs_modulus * curvature * 0.5 * case.beam_depth
            total += kink.growth(case, contact, pair)
    assert total == pytest.approx(angle, rel=0.07)
    assert kink.growth(case, contact, pair) == 0.0


def test_a_kinked_beam_at_rest_is_two_straight_halves():
    grid = make_grid(21, 0.1, 1e-6, 1.0, 1.0)
    beam, psi = make_beam(grid), np.zeros(14)
    kink.bend_back(beam, 0, psi, grid, 0.02)
    assert beam.w[0, grid.mid] == kink.height(grid, 0.02) == pytest.approx(0.02 * 2.0 / 4.0)
    assert psi[grid.mid] - psi[grid.mid - 1] == -0.02
    kink.straighten(beam.w, grid, 0.02)
    np.testing.assert_allclose(beam.w[0, 1 : grid.mid + 1], 0.0, atol=1e-15)


def test_the_work_of_a_kink_is_in_the_balance_of_energy():
    errors = [
        run_dataset(PAPER, il.Discretisation(nodes=nodes), duration=0.4e-3).energy_error.item()
        for nodes in (101, 201)
    ]
    assert errors[0] < 2e-4  # of which the work is 0.8 %
    assert errors[1] < 0.8 * errors[0]
