"""The half beam against numpy, its free vibration in closed form, its energy by its fibres."""

import numpy as np
import pytest

from impactlab.solve import fibre_section
from impactlab.solver.beam import (
    bending_energy,
    kinetic_energy,
    make_beam,
    make_grid,
    move_virgin,
    reach,
    strike,
)
from impactlab.solver.fibre_plasticity import make_plastic_state, plastic_energy
from impactlab.solver.section import bend

N = 20
"""Spacings in the half beam."""
GRID = make_grid(2 * N + 1, 0.02, 1e-6, 13.0, 2e4)
MID = GRID.mid


def shaped(values, now=0, grid=GRID):
    """A beam whose w from the support to mid-span is `values`, mirrored beyond both."""
    beam = make_beam(grid)
    beam.w[now] = mirrored(values)
    return beam


def mirrored(values):
    return np.concatenate([[-values[1]], values, values[-2:-4:-1]])


@pytest.mark.parametrize(
    ("moved", "first", "expected"),
    [(8, 8, 6), (9, 8, 6), (10, 8, 8), (3, 3, 2), (2, 2, 2)],
    ids=["at first", "next to it", "behind it", "near the support", "at the support"],
)
def test_the_front_goes_ahead_of_the_wave(moved, first, expected):
    w = np.zeros((2, N + 4))
    w[1, moved] = -1e-9
    assert reach(w, 1, first) == expected
    assert reach(w, 0, first) == first


def test_the_front_ignores_what_would_become_denormal():
    w = np.zeros((2, N + 4))
    w[0, 8] = 1e-101
    assert reach(w, 0, 8) == 8


@pytest.mark.parametrize("mode", [1, 3, 7])
def test_free_vibration_is_that_of_the_discrete_beam(make_case, mode):
    """sin(k pi x/L) cos(j theta), 4 sin^2(theta/2) = dt^2 EI/mu (4 sin^2(k pi/(4 n))/dx^2)^2."""
    mu, dx, section = 13.0, 0.02, fibre_section(make_case(points=5))
    EI = section.stiffness
    grid = make_grid(2 * N + 1, dx, 0.4 * dx**2 * np.sqrt(mu / EI), mu, EI)
    shape = np.sin(mode * np.pi * np.arange(N + 1) / (2 * N))
    eigenvalue = (4 * np.sin(mode * np.pi / (4 * N)) ** 2 / dx**2) ** 2
    theta = 2 * np.arcsin(0.5 * grid.dt * np.sqrt(EI / mu * eigenvalue))
    amplitude = 1e-7
    beam, plastic_state = shaped(amplitude * shape, grid=grid), make_plastic_state(grid, section)
    # half a step back in time, so that the first whole kick ends half a step on
    beam.u[1 : MID + 1] = amplitude * shape * (1.0 - np.cos(theta))
    totals = []
    for step in range(200):
        now, u_mid = step % 2, beam.u[MID]
        assert beam.w[now, 1 : MID + 1] == pytest.approx(
            amplitude * shape * np.cos(step * theta), abs=1e-10 * amplitude
        )
        args = (grid, section.yield_curvature)
        assert move_virgin(beam.w, now, beam.u, 2, MID + 1, *args) == 0
        strike(beam.w, now, beam.u, 0.0, grid)
        stored = bending_energy(beam, plastic_state.M_0, section.stiffness, grid, now)
        assert plastic_energy(plastic_state, section, grid) == (0.0, 0.0)
        totals.append(stored + kinetic_energy(beam, grid, now, u_mid))
    # EI/2 times the integral of kappa^2, and the cosine of leapfrog's product of velocities
    bending = 0.25 * EI * amplitude**2 * eigenvalue * 2 * N * dx
    expected = bending * np.cos(theta / 2) ** 2
    assert totals == pytest.approx([expected] * len(totals), rel=1e-10)


def test_kinetic_energy_of_a_force_on_a_straight_beam():
    """u before and after the step of a force at mid-span alone."""
    beam, velocity, F = make_beam(GRID), 3.0, 500.0
    u_mid = velocity * GRID.dt
    beam.u[MID] = u_mid
    strike(beam.w, 0, beam.u, F, GRID)
    after = velocity + GRID.dt * F / (GRID.mu * GRID.dx)
    expected = 0.5 * GRID.mu * GRID.dx * velocity * after
    assert kinetic_energy(beam, GRID, 0, u_mid) == pytest.approx(expected, rel=1e-12)


def test_strain_energy_counts_both_halves_and_what_was_dissipated(make_case):
    """Against the fibres' own energy, E/2 (strain - plastic strain)^2 over the section."""
    section = fibre_section(make_case(points=5))
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
