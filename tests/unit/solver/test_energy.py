"""The beam's energies against sums over its fibres."""

from __future__ import annotations

import numpy as np
import pytest

from impactlab.solver.beam import bending_energy, kinetic_energy, make_beam, make_grid, strike
from impactlab.solver.fibre_plasticity import make_plastic_state, plastic_energy
from impactlab.solver.section import bend, make_section

GRID = make_grid(20, 0.02, 1e-6, 13.0, 2e4)
MID = GRID.mid


def test_kinetic_energy_of_a_force_on_a_straight_beam():
    """u before and after the step of a force at mid-span alone."""
    beam, velocity, F = make_beam(GRID), 3.0, 500.0
    u_mid = velocity * GRID.dt
    beam.u[MID] = u_mid
    strike(beam.w, 0, beam.u, F, GRID)
    after = velocity + GRID.dt * F / (GRID.mu * GRID.dx)
    expected = 0.5 * GRID.mu * GRID.dx * velocity * after
    assert kinetic_energy(beam, GRID, 0, u_mid) == pytest.approx(expected, rel=1e-12)


def test_kinetic_energy_counts_both_halves():
    beam, velocity = make_beam(GRID), 2.0
    beam.u[:] = velocity * GRID.dt
    expected = 0.5 * GRID.mu * velocity**2 * GRID.dx * (2 * (MID - 2) + 1)
    assert kinetic_energy(beam, GRID, 0, beam.u[MID]) == pytest.approx(expected, rel=1e-12)


def test_strain_energy_counts_both_halves_and_what_was_dissipated(make_case):
    """Against the fibres' own energy, E/2 (strain - plastic strain)^2 over the section."""
    section = make_section(make_case(points=5))
    beam, plastic_state = make_beam(GRID), make_plastic_state(GRID, section)
    random = np.random.default_rng(3)
    half = np.cumsum(np.cumsum(random.uniform(-3, 3, MID))) * section.yield_curvature * GRID.dx**2
    beam.w[1, 1 : MID + 1] = half - half[0]
    beam.w[1, MID + 1] = beam.w[1, MID - 1]
    curvatures = np.concatenate([[0], np.diff(beam.w[1], 2), [0]]) * GRID.per_dx2
    stored, dissipated = 0.0, 0.0
    for i in range(2, MID + 1):
        plastic_state.M_0[i], _, _ = bend(
            section, curvatures[i], plastic_state.plastic_strain, plastic_state.peeq, i
        )
        times = (1 if i == MID else 2) * GRID.dx
        elastic = -section.z * curvatures[i] - plastic_state.plastic_strain[i]
        stored += times * np.sum(section.area * 0.5 * section.moduli.E * elastic**2)
        dissipated += times * np.sum(section.area * section.moduli.S_y * plastic_state.peeq[i])
    assert dissipated > 0
    left, lost = plastic_energy(plastic_state, section, GRID)
    bending = bending_energy(beam, plastic_state.M_0, section.stiffness, GRID, 1)
    assert (bending + left, lost) == pytest.approx((stored, dissipated), rel=1e-12)
