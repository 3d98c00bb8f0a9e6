"""The finite-difference half beam against numpy, and its free vibration in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from impactlab.kernels.beam import (
    bend_yielding,
    elastic_moments,
    kinetic_energy,
    make_beam,
    make_grid,
    move,
    reach,
    strain_energies,
    virgin_moments,
)
from impactlab.kernels.section import bend as bend_row
from impactlab.kernels.section import make_section

N = 20
"""Index of mid-span."""


@pytest.fixture
def section(make_case):
    return make_section(make_case(points=5))


def shaped(values, section):
    """A beam whose w over the half span is `values`."""
    beam = make_beam(len(values) - 1, section)
    beam.w[:-1] = values
    beam.w[-1] = values[-2]
    return beam


def bend(section, kappa, plastic, peeq):
    """Bend one section with its fibres' strains, shape (P // 2,)."""
    cut = (section.z, section.lever, section.E, section.S_y, section.H_i, section.H_k)
    return bend_row(*cut, kappa, plastic[np.newaxis], peeq[np.newaxis], 0)


def bend_beam(beam, section, first, per_dx2):
    """Moments of a beam that may yield."""
    state = (beam.w, beam.M, beam.M_0, beam.kappa_min, beam.kappa_max)
    outside = elastic_moments(*state, first, section.stiffness, per_dx2)
    fibres = (beam.plastic_strain, beam.peeq, section.z, section.lever)
    constants = (section.E, section.S_y, section.H_i, section.H_k, section.stiffness)
    bend_yielding(*state, *fibres, constants, outside, per_dx2)


def second_difference(values):
    return np.diff(values, 2)


def test_a_new_beam_is_straight_and_has_its_elastic_range(section):
    beam = make_beam(N, section)
    assert not np.any(beam.w)
    assert not np.any(beam.u)
    assert beam.peeq.shape == beam.plastic_strain.shape == (N + 1, 2)
    assert np.all(beam.kappa_max == section.yield_curvature)
    assert np.all(beam.kappa_min == -section.yield_curvature)


def test_the_grid_knows_what_follows_from_it():
    grid = make_grid(N, 0.01, 1e-6, 13.0)
    assert grid.per_dx2 == pytest.approx(1e4)
    assert grid.factor == pytest.approx(1e-12 / 13e-4)
    assert grid.push == pytest.approx(1e-12 / 0.13)


@pytest.mark.parametrize(
    ("moved", "first", "expected"),
    [(7, 7, 5), (8, 7, 5), (9, 7, 7), (2, 2, 1), (1, 1, 1)],
    ids=["at first", "next to it", "behind it", "near the support", "at the support"],
)
def test_the_front_goes_ahead_of_the_wave(moved, first, expected):
    w = np.zeros(N + 2)
    w[moved] = -1e-9
    assert reach(w, first) == expected


def test_the_front_ignores_what_would_become_denormal():
    w = np.zeros(N + 2)
    w[7] = 1e-101
    assert reach(w, 7) == 7


@pytest.mark.parametrize("first", [1, 5, N])
def test_elastic_moments_are_the_second_difference(section, first):
    values = 1e-6 * np.cos(np.arange(N + 1.0))
    beam, per_dx2 = shaped(values, section), 1e4
    beam.M[:] = np.nan
    outside = virgin_moments(
        beam.w, beam.M, first, section.stiffness, section.yield_curvature, per_dx2
    )
    expected = -section.stiffness * second_difference(beam.w) * per_dx2
    assert beam.M[first:] == pytest.approx(expected[first - 1 :], rel=1e-9)
    assert np.isnan(beam.M[:first]).all()
    curvature = np.abs(second_difference(beam.w)) * per_dx2
    assert outside == np.sum(curvature[first - 1 :] > section.yield_curvature)


def test_both_signs_of_curvature_yield(section):
    for sign in (-1.0, 1.0):
        values = np.zeros(N + 1)
        values[10] = sign * 2 * section.yield_curvature
        beam = shaped(values, section)
        # curvature -2, 1, 1 times the value: all three nodes are beyond yield
        args = (beam.w, beam.M, 1, section.stiffness, section.yield_curvature, 1.0)
        assert virgin_moments(*args) == 3


@pytest.mark.parametrize("first", [1, 70])
def test_moments_of_a_yielding_beam_are_those_of_each_section(section, first):
    """In two steps, the second back into the elastic range."""
    n, per_dx2 = 150, 1e4
    random = np.random.default_rng(1)
    values = np.cumsum(np.cumsum(random.normal(size=n + 1))) * section.yield_curvature / per_dx2
    beam = shaped(values, section)
    plastic, peeq = np.zeros((n + 1, 2)), np.zeros((n + 1, 2))
    for share in (1.0, 0.6):
        beam.w[:-1] = share * values
        beam.w[-1] = beam.w[-3]
        bend_beam(beam, section, first, per_dx2)
        curvatures = second_difference(beam.w) * per_dx2
        for i in range(first, n + 1):
            kappa = curvatures[i - 1]
            M_0, _, _ = bend(section, kappa, plastic[i], peeq[i])
            assert beam.M[i] == pytest.approx(M_0 - section.stiffness * kappa, rel=1e-9, abs=1e-6)
    assert beam.peeq == pytest.approx(peeq, rel=1e-9)
    assert beam.plastic_strain == pytest.approx(plastic, rel=1e-9)
    assert 0.2 < np.mean(beam.peeq[first:, 0] > 0) < 0.8  # some have yielded, some have not
    assert not np.any(beam.peeq[:first])


@pytest.mark.parametrize("first", [1, 5, N - 1, N])
def test_one_step_moves_by_the_moments_and_the_force(first):
    random = np.random.default_rng(2)
    w, u, M = (random.normal(size=size) for size in (N + 2, N + 1, N + 1))
    w[-1] = w[-3]
    factor, push = 0.3, 0.7
    mirrored = np.append(M, M[-2])
    expected_u = u[1:] + factor * second_difference(mirrored)
    expected_u[-1] += push
    expected_u[: first - 1] = u[1:first]
    expected_w = w[1:-1] + expected_u
    expected_w[: first - 1] = w[1:first]
    at_support = w[0]
    move(w, u, M, first, factor, push)
    assert u[1:] == pytest.approx(expected_u, rel=1e-12)
    assert w[1:-1] == pytest.approx(expected_w, rel=1e-12)
    assert w[0] == at_support
    assert w[-1] == w[-3]


@pytest.mark.parametrize("mode", [1, 3, 7])
def test_free_vibration_is_that_of_the_discrete_beam(section, mode):
    """sin(k pi x/L) cos(j theta), 4 sin^2(theta/2) = dt^2 EI/mu (4 sin^2(k pi/(4 n))/dx^2)^2."""
    mu, dx = 13.0, 0.02
    dt = 0.4 * dx**2 * np.sqrt(mu / section.stiffness)
    grid = make_grid(N, dx, dt, mu)
    shape = np.sin(mode * np.pi * np.arange(N + 1) / (2 * N))
    eigenvalue = (4 * np.sin(mode * np.pi / (4 * N)) ** 2 / dx**2) ** 2
    theta = 2 * np.arcsin(0.5 * dt * np.sqrt(section.stiffness / mu * eigenvalue))
    amplitude = 1e-7
    beam = shaped(amplitude * shape, section)
    totals = []
    for step in range(200):
        assert beam.w[:-1] == pytest.approx(
            amplitude * shape * np.cos(step * theta), abs=1e-10 * amplitude
        )
        args = (section.stiffness, section.yield_curvature, grid.per_dx2)
        assert virgin_moments(beam.w, beam.M, 1, *args) == 0
        if step > 0:
            stored, dissipated = strain_energies(beam, section, grid, 1)
            assert dissipated == 0
            totals.append(stored + kinetic_energy(beam, grid, 1, 0.0))
        first_kick = 0.5 if step == 0 else 1.0
        move(beam.w, beam.u, beam.M, 1, first_kick * grid.factor, 0.0)
    # EI/2 times the integral of kappa^2, and the cosine of leapfrog's product of velocities
    bending = 0.25 * section.stiffness * amplitude**2 * eigenvalue * 2 * N * dx
    expected = bending * np.cos(theta / 2) ** 2
    assert totals == pytest.approx([expected] * len(totals), rel=1e-10)


def test_kinetic_energy_of_a_force_on_a_straight_beam(section):
    """u before and after the step of a force at mid-span alone."""
    grid = make_grid(N, 0.02, 1e-6, 13.0)
    beam = make_beam(N, section)
    velocity, F = 3.0, 500.0
    beam.u[N] = velocity * grid.dt
    after = velocity + grid.dt * F / (grid.mu * grid.dx)
    expected = 0.5 * grid.mu * grid.dx * velocity * after
    assert kinetic_energy(beam, grid, 1, F) == pytest.approx(expected, rel=1e-12)


def test_strain_energy_counts_both_halves_and_what_was_dissipated(section):
    """Against the fibres' own energy, E/2 (strain - plastic strain)^2 over the section."""
    grid = make_grid(N, 0.02, 1e-6, 13.0)
    beam = make_beam(N, section)
    random = np.random.default_rng(3)
    curvatures = random.uniform(-3, 3, N + 1) * section.yield_curvature
    stored, dissipated = 0.0, 0.0
    for i in range(1, N + 1):
        beam.M_0[i], _, _ = bend(section, curvatures[i], beam.plastic_strain[i], beam.peeq[i])
        beam.M[i] = beam.M_0[i] - section.stiffness * curvatures[i]
        times = (1 if i == N else 2) * grid.dx
        elastic = -section.z * curvatures[i] - beam.plastic_strain[i]
        stored += times * np.sum(section.area * 0.5 * section.E * elastic**2)
        dissipated += times * np.sum(section.area * section.S_y * beam.peeq[i])
    assert dissipated > 0
    energies = strain_energies(beam, section, grid, 1)
    assert energies == pytest.approx((stored, dissipated), rel=1e-12)
