"""The filter against numpy's dense solution, the scheme's free vibration, and its time step."""

from __future__ import annotations

import numpy as np
import pytest

import impactlab as il
from impactlab.model.parameters import with_values
from impactlab.simulate import case_table
from impactlab.simulate import solve as solve_cases
from impactlab.solver.beam import bending_energy, make_beam, make_grid
from impactlab.solver.contact.history import make_pair
from impactlab.solver.fibre_plasticity import make_plastic_state, plastic_energy
from impactlab.solver.section import make_section
from impactlab.solver.semi_implicit import (
    BETA,
    advance,
    filtered_kinetic_energy,
    filtered_step,
    make_filter,
    no_filter,
    pull,
    solve,
)
from impactlab.solver.stability import discretise, largest_time_step, stiffest_contact
from impactlab.variables import STATUS_FLAGS

MU, DX, EI = 13.0, 0.02, 2e4
HALVES = [*range(8, 21), 50, 51, 300, 301]
"""Spacings in the half beam: all kinds of rows begin at 8."""


def grid_with(n, alpha, EI=EI, dx=DX):
    """A grid with n spacings in the half beam whose filter is I + alpha^2 (fourth difference)."""
    return make_grid(n, dx, alpha * dx**2 * np.sqrt(MU / (BETA * EI)), MU, EI)


def second_differences(nodes):
    """Return that of the inner nodes, between supports where w = 0, (nodes - 2, nodes - 2)."""
    inner = nodes - 2
    return np.eye(inner, k=-1) - 2 * np.eye(inner) + np.eye(inner, k=1)


def dense(n, alpha):
    """The filter over the whole beam: w = w_xx = 0 at the supports."""
    bend = second_differences(2 * n + 1)
    return np.eye(2 * n - 1) + alpha**2 * bend @ bend


@pytest.mark.parametrize("n", HALVES)
@pytest.mark.parametrize("alpha", [1e-3, 0.3, 1.0, 30.0, 1e3])
def test_the_filter_is_solved_as_numpy_solves_the_whole_beam(n, alpha):
    grid = grid_with(n, alpha)
    filter = make_filter(grid, EI)
    assert filter.alpha2 == pytest.approx(alpha**2, rel=1e-12)
    pulled = np.random.default_rng(n).normal(size=n)  # from beside the support to mid-span
    matrix = dense(n, alpha)
    expected = np.linalg.solve(matrix, np.concatenate([pulled, pulled[-2::-1]]))[:n]
    beam = make_beam(grid)
    beam.du[2 : grid.mid + 1] = pulled
    solve(beam.du, filter, grid)
    s = filter.first + filter.length
    advance(beam.w, 0, beam.u, beam.du, filter.by_s, filter.by_t, s, grid)
    # two good solvers differ by the condition number times round-off
    eigenvalues = 1 + alpha**2 * (4 * np.sin(np.pi * np.array([1, 2 * n - 1]) / (4 * n)) ** 2) ** 2
    close = 1e-15 * eigenvalues[1] / eigenvalues[0] * n + 1e-13
    assert beam.du[2 : grid.mid + 1] == pytest.approx(expected, rel=0, abs=close)
    assert np.array_equal(beam.u[2 : grid.mid + 1], beam.du[2 : grid.mid + 1])
    assert np.array_equal(beam.w[1], beam.u)
    residual = matrix @ np.concatenate([beam.du[2 : grid.mid + 1], beam.du[grid.mid - 1 : 1 : -1]])
    assert np.abs(residual[:n] - pulled).max() < 1e-15 * (1 + 16 * alpha**2) * n


@pytest.mark.parametrize("n", [8, 9])
def test_the_rows_are_those_of_the_half_beam(n):
    """Two chains of equal length, and two rows between them; the support may be one more."""
    grid = grid_with(n, 1.0)
    filter = make_filter(grid, EI)
    rows = 2 * filter.length + 2
    assert filter.first + rows == grid.mid + 1
    assert filter.first in (1, 2)
    assert rows == n + (filter.first == 1)


def test_no_filter_has_no_rows():
    assert no_filter().length == 0
    assert no_filter().alpha2 == 0


def fourth_difference(values):
    """Return that of w from the support to mid-span, at each node but the support."""
    return np.diff(np.concatenate([[-values[1]], values, values[-2:-4:-1]]), 4)


@pytest.mark.parametrize("now", [0, 1])
def test_the_pull_is_the_explicit_increment(now):
    n = 20
    grid = grid_with(n, 0.5)
    beam, mid = make_beam(grid), grid.mid
    values = 1e-6 * np.sin(np.arange(n + 1.0))
    beam.w[now] = np.concatenate([[-values[1]], values, values[-2:-4:-1]])
    beam.plastic[:] = 1e-7 * np.arange(n + 4)
    kappa = np.diff(beam.w[now], 2) * grid.per_dx2
    kappa = np.concatenate([[0], kappa, [0]])
    low, high = kappa - 1e-6, kappa + 1e-6
    low[[7, 9]], high[[8, mid]] = kappa[[7, 9]] + 1e-6, kappa[[8, mid]] - 1e-6
    assert pull(beam.w, now, beam.du, beam.plastic, low, high, grid) == 4
    expected = beam.plastic[2 : mid + 1] - grid.stiffness * fourth_difference(values)
    assert beam.du[2 : mid + 1] == pytest.approx(expected, rel=1e-9)
    assert not beam.u.any()


@pytest.mark.parametrize("mode", [1, 3, 7])
@pytest.mark.parametrize("alpha", [0.2, 3.0, 30.0])
@pytest.mark.parametrize("n", [20, 21])
def test_free_vibration_is_that_of_the_filtered_beam(make_case, mode, alpha, n):
    """sin(k pi x/L) cos(j theta): 4 sin^2(theta/2) = lambda/(1 + beta lambda).

    lambda = dt^2 EI/mu (4 sin^2(k pi/(4 n))/dx^2)^2. Far beyond leapfrog's limit of 4, too.
    """
    section = make_section(make_case(points=5))
    EI = section.stiffness
    grid = grid_with(n, alpha, EI)
    filter, beam, plastic_state = (
        make_filter(grid, EI),
        make_beam(grid),
        make_plastic_state(grid, section),
    )
    shape = np.sin(mode * np.pi * np.arange(n + 1) / (2 * n))
    eigenvalue = (4 * np.sin(mode * np.pi / (4 * n)) ** 2 / DX**2) ** 2
    stretch = grid.dt**2 * EI / MU * eigenvalue
    theta = 2 * np.arcsin(0.5 * np.sqrt(stretch / (1 + BETA * stretch)))
    amplitude, here = 1e-7, slice(1, grid.mid + 1)
    mirrored = np.concatenate([[-shape[1]], shape, shape[-2:-4:-1]])
    beam.w[0] = amplitude * mirrored
    # half a step back in time, so that the first whole kick ends half a step on
    beam.u[here] = amplitude * shape * (1.0 - np.cos(theta))
    totals = []
    for step in range(200):
        now = step % 2
        expected = amplitude * shape * np.cos(step * theta)
        assert beam.w[now, here] == pytest.approx(expected, abs=1e-10 * amplitude)
        filtered_step(beam, plastic_state, section, grid, filter, now, 0.0)
        stored = bending_energy(beam, plastic_state.M_0, section.stiffness, grid, now)
        assert plastic_energy(plastic_state, section, grid) == (0.0, 0.0)
        totals.append(stored + filtered_kinetic_energy(beam, grid, filter, now, 0.0))
    # EI/2 times the integral of kappa^2, and the cosine of the product of velocities
    bending = 0.25 * EI * amplitude**2 * eigenvalue * 2 * n * DX
    expected = bending * np.cos(theta / 2) ** 2
    assert totals == pytest.approx([expected] * len(totals), rel=1e-10)


def test_the_energy_counts_plastic_shares_and_the_force():
    """rho A dx/2 v_before^T (I + alpha^2 delta^4) v_after, over the whole beam."""
    n, force = 20, 700.0
    grid = grid_with(n, 1.5)
    filter, beam = make_filter(grid, EI), make_beam(grid)
    values = 1e-6 * np.sin(np.arange(n + 1.0))
    beam.w[0] = np.concatenate([[-values[1]], values, values[-2:-4:-1]])
    beam.u[1 : n + 2] = 1e-6 * np.cos(np.arange(n + 1.0))
    beam.u[1] = 0.0
    beam.plastic[2 : n + 2] = 1e-8 * np.arange(n)
    pulled = beam.plastic[2 : n + 2] - grid.stiffness * fourth_difference(values)
    pulled[-1] += force * grid.dt**2 / (MU * DX)
    before = whole(beam.u[2 : n + 2])
    after = before + np.linalg.solve(dense(n, 1.5), whole(pulled))
    expected = 0.5 * MU * DX / grid.dt**2 * before @ dense(n, 1.5) @ after
    beam.du[2 : n + 2] = (after - before)[:n]
    beam.u[:] += beam.du
    ours = filtered_kinetic_energy(beam, grid, filter, 0, force)
    assert ours == pytest.approx(expected, rel=1e-10)


def whole(half):
    """The inner nodes of the whole beam, from those up to mid-span."""
    return np.concatenate([half, half[-2::-1]])


SEMI_IMPLICIT = {"scheme": "semi_implicit"}


@pytest.mark.parametrize("courant", [0.05, 0.5, 1.0])
def test_time_steps_are_half_a_bar_wave_over_a_spacing(make_case, courant):
    case = make_case(duration=1e-3, courant=courant, nodes=101, **SEMI_IMPLICIT)
    grid, steps = discretise(case, make_pair(case), make_section(case))
    largest = 0.5 * (0.78 / 100) / np.sqrt(210e9 / 7800)
    assert steps == np.ceil(1e-3 / (courant * largest))
    assert steps * grid.dt == pytest.approx(1e-3, rel=1e-12)


STIFF = SEMI_IMPLICIT | {"contact": "hertz", "sphere_mass": 1e-3, "velocity": 30.0}
STIFF |= {"beam_depth": 0.002, "beam_width": 0.001, "nodes": 41}
"""A heavy contact between light bodies, which sets the time step."""


def largest_growth(case, k_c, dt):
    """Of beam and sphere, the contact a spring k_c: largest modulus of the step's eigenvalues."""
    nodes, m_s = case.nodes, case.sphere_mass
    dx = case.beam_span / (nodes - 1)
    lumped = case.beam_density * case.beam_width * case.beam_depth * dx
    bend = second_differences(nodes) / dx**2
    EI = make_section(case).stiffness
    stiffness, mass = np.zeros((nodes - 1, nodes - 1)), np.zeros((nodes - 1, nodes - 1))
    stiffness[:-1, :-1] = EI * dx * bend @ bend
    mass[:-1, :-1] = lumped * np.eye(nodes - 2) + BETA * dt**2 * stiffness[:-1, :-1]
    mass[-1, -1] = m_s
    ends = np.ix_([(nodes - 3) // 2, -1], [(nodes - 3) // 2, -1])
    stiffness[ends] += k_c * np.array([[1, -1], [-1, 1]])
    pull = dt**2 * np.linalg.solve(mass, stiffness)
    one = np.eye(nodes - 1)
    step = np.block([[2 * one - pull, -one], [one, np.zeros_like(one)]])
    return np.abs(np.linalg.eigvals(step)).max()


def time_step(case):
    """(largest time step, stiffness of the contact, half of a bar wave's time over a spacing)."""
    pair, dx = make_pair(case), case.beam_span / (case.nodes - 1)
    wave = 0.5 * dx * np.sqrt(case.beam_density / case.beam_youngs_modulus)
    EI = make_section(case).stiffness
    return largest_time_step(case, pair, EI, dx), stiffest_contact(case, pair), wave


@pytest.mark.parametrize("nodes", [17, 41])
@pytest.mark.parametrize("values", [SEMI_IMPLICIT, STIFF], ids=["wave", "contact"])
def test_stable_at_the_largest_time_step(make_case, values, nodes):
    """The eigenvalues of a step lie on the unit circle."""
    case = make_case(**(values | {"nodes": nodes}))
    dt, k_c, wave = time_step(case)
    assert (dt < 0.99 * wave) == (values is STIFF)
    assert largest_growth(case, k_c, dt) < 1 + 1e-6


@pytest.mark.parametrize("nodes", [17, 41])
def test_the_contact_limits_the_time_step_where_the_filter_adds_no_mass(make_case, nodes):
    case = make_case(**(STIFF | {"nodes": nodes, "beam_depth": 2e-4}))
    dt, k_c, _ = time_step(case)
    assert largest_growth(case, k_c, 1.02 * dt) > 1 + 1e-3


def run(values, nodes, courant):
    """The responses of an elastic run; the table takes a Courant number above 1, too."""
    changed = {"beam_yield_stress": 200e9, "nodes": nodes, "points": 3} | values
    impact, grid = with_values(il.paper_impact(), il.Discretisation(), changed)
    cases = case_table(impact, grid, duration=0.2e-3)
    cases["courant"] = courant
    return solve_cases(cases)


def test_bending_sets_no_limit_to_the_time_step():
    values = SEMI_IMPLICIT | {"contact": "hertz"}
    for courant in (1.0, 10.0):  # 2 and 20 times leapfrog's limit
        response = run(values, 201, courant)
        assert not response["status"] & STATUS_FLAGS["diverged"][0]
        assert response["energy_error"] < 1e-2


@pytest.mark.parametrize("nodes", [17, 41])
def test_light_bodies_under_a_stiff_contact_stay_in_balance(nodes):
    response = run(STIFF, nodes, 1.0)
    assert not response["status"] & STATUS_FLAGS["diverged"][0]
