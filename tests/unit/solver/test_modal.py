"""The modal scheme: its step against closed forms, its list of sections, and balance."""

import numba
import numpy as np
import pytest

import impactlab as il
from impactlab.simulate import simulate_many
from impactlab.solve import fibre_section
from impactlab.solver.beam import make_grid
from impactlab.solver.contact.history import make_pair
from impactlab.solver.fibre_plasticity import make_plastic_state, plastic_energy
from impactlab.solver.modal import bend_sections
from impactlab.solver.modes import deflect, make_modes, modal_energy, mode_curvature, move_modes
from impactlab.solver.section import FAR
from impactlab.solver.stability import discretise
from impactlab.variables import STATUS_FLAGS
from impactlab.verification.schemes import drawn

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

MU, EI, SPAN, FORCE = 13.0, 2e4, 0.8, 700.0
JIT_ONLY = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="takes minutes without")


def modes_of(n, dt):
    """Modes of an elastic beam with n spacings in its half, and its grid."""
    grid = make_grid(2 * n + 1, 0.5 * SPAN / n, dt, MU, EI)
    return make_modes(grid, EI, FAR), grid


def move(modes, F):
    q, u, k2, D, push, source, _, seen, _, slack = modes[:10]
    return move_modes(q, u, D, push, source, k2, seen, slack, F)


def energy_of(modes, F):
    q, u, _, D, push, source = modes[:6]
    return modal_energy(q, u, D, push, source, F)


@pytest.mark.parametrize("turn", [1e-4, 0.1, 1.5])
def test_a_step_is_exact_under_a_constant_force(turn):
    """From rest q = F/K (1 - cos omega t) in every mode, none of which turns beyond pi/2.

    The modes left out go as one, at the frequency of the first of them.
    """
    n = 7
    k = np.arange(1, 2 * 20_000, 2) * np.pi / SPAN
    flexibilities = 2 / (EI * k**4 * SPAN)
    K = 1 / np.append(flexibilities[:n], flexibilities[n:].sum())
    omega, k = k[: n + 1] ** 2 * np.sqrt(EI / MU), k[:n]
    dt = turn / omega[-1]
    modes, grid = modes_of(n, dt)
    modes.u[:] = -0.5 * modes.push * FORCE  # q(-dt) = q(dt)
    energies = []
    for step in range(1, 400):
        w = move(modes, FORCE)
        expected = FORCE / K * (1 - np.cos(step * omega * dt))
        assert modes.q == pytest.approx(expected, rel=0, abs=1e-9 * FORCE / K[0])
        assert (modes.q - expected) * K == pytest.approx(np.zeros(n + 1), abs=1e-8 * FORCE)
        assert w == pytest.approx(expected.sum(), abs=1e-9 * FORCE / K[0])
        energies.append(energy_of(modes, FORCE) - FORCE * (modes.q - modes.u).sum())
    start = -(modes.push * FORCE**2 / 8).sum()  # of the half steps beside the rest
    assert energies == pytest.approx([start] * len(energies), rel=0, abs=1e-12 * FORCE**2 / K[0])
    deflection = np.zeros((2, n + 4))
    deflect(modes, deflection, 1, grid.mid)
    from_support = np.linspace(0, SPAN / 2, n + 1)[1:]
    expected = np.sin(np.outer(from_support, k)) @ (
        (-1.0) ** np.arange(n) * (FORCE / K * (1 - np.cos((step - 1) * omega * dt)))[:n]
    )
    assert deflection[1, 2 : n + 2] == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("n", [1, 4, 400])
def test_modes_far_beyond_the_time_step_follow_the_static_limit(n):
    """In the mean of two steps: F/K, together F L^3/(48 EI) and, at mid-span, F L/(4 EI).

    The moment's share that n modes lack is 4/(pi^2 n) of it nearly.
    """
    modes, grid = modes_of(n, 1.0)
    np.testing.assert_allclose(modes.D, 2.0, rtol=1e-15)
    w, kappa = [], []
    for _ in range(20):
        w.append(move(modes, FORCE))
        kappa.append(mode_curvature(modes.q, modes.bent, grid.mid))
    means = 0.5 * (np.array([w, kappa])[:, 2:] + np.array([w, kappa])[:, :-2])
    assert means[0] == pytest.approx(FORCE * SPAN**3 / (48 * EI), rel=1e-12)
    assert means[1] == pytest.approx(-FORCE * SPAN / (4 * EI) * (1 - 2 / np.pi**2 / n), rel=0.02)


@pytest.mark.parametrize("n", [1, 2, 9])
def test_moments_come_to_the_modes_as_the_modes_bend(n):
    """The sum over the sections is exact: M_0 = EI kappa makes the source K q."""
    modes, grid = modes_of(n, 1e-5)
    modes.q[:n] = 1e-3 * np.cos(np.arange(n))
    lengths = np.full(n, 2 * grid.dx)
    lengths[-1] = grid.dx
    kappa = np.array([mode_curvature(modes.q, modes.bent, i) for i in range(2, grid.mid + 1)])
    source = modes.bent[2 : grid.mid + 1].T @ (lengths * EI * kappa)
    assert source[:n] == pytest.approx((modes.D / modes.push * modes.q)[:n], rel=1e-9)
    assert source[n] == 0.0


YIELDING = {"velocity": 30.0, "beam_depth": 0.01, "nodes": 41, "points": 6, "scheme": "modal"}
HARDENING = {name: 2e9 for name in ("beam_isotropic_hardening_modulus",)}
HARDENING["beam_kinematic_hardening_modulus"] = 3e9


def yielding_beam(make_case, **values):
    """The modes, sections' state, section and grid of a beam at rest."""
    case = make_case(duration=1e-3, **YIELDING, **values)
    section = fibre_section(case)
    grid, _ = discretise(case, make_pair(case), section)
    modes = make_modes(grid, section.stiffness, section.yield_curvature)
    return modes, make_plastic_state(grid, section), section, grid


@pytest.mark.parametrize("hardening", [{}, HARDENING], ids=["perfectly plastic", "hardening"])
def test_sections_left_alone_change_no_bit(make_case, hardening):
    """Against a beam all of whose sections are looked at in every step; struck from both sides."""
    step = np.arange(900.0)
    blow = 30e3 * (np.exp(-((step / 80 - 1) ** 2)) - np.exp(-((step / 80 - 5) ** 2)))
    beams = []
    for everywhere in (False, True):
        modes, plastic, section, grid = yielding_beam(make_case, **hardening)
        near, slack, left_alone, w = modes.near, modes.slack, [], []
        if everywhere:
            near[:], slack[0] = [grid.mid - 1, *range(2, grid.mid + 1)], FAR
        for step in range(blow.size):
            if near[0] > 0 or slack[1] >= slack[0]:
                bend_sections(modes, plastic, section, grid)
            w.append(move(modes, blow[step]))
            left_alone.append(grid.mid - 1 - near[0])
        state = modes.q, modes.source, plastic.plastic_strain, plastic.peeq, plastic.M_0
        beams.append([np.array(w), *state])
        yielded = plastic.peeq[2 : grid.mid + 1, 0]
        assert 3 < np.count_nonzero(yielded) < grid.mid - 3
        assert (yielded > 1.1 * np.abs(plastic.plastic_strain[2 : grid.mid + 1, 0])).any()
        assert np.mean(left_alone) == 0 if everywhere else np.mean(left_alone) > 3
    for one, other in zip(*beams, strict=True):
        assert one.tobytes() == other.tobytes()


def test_any_bending_however_sudden_is_found(make_case):
    modes, plastic, section, grid = yielding_beam(make_case)
    for mode, size in ((0, 0.9), (3, 0.9), (1, 5.0), (0, -7.0)):
        modes.q[mode] = size * section.yield_curvature / modes.k2[mode]
        modes.slack[1] = (modes.k2 * np.abs(modes.q - modes.seen)).sum()
        bend_sections(modes, plastic, section, grid)
        for i in range(2, grid.mid + 1):
            kappa = mode_curvature(modes.q, modes.bent, i)
            close = 1e-12 * abs(kappa)
            assert plastic.kappa_min[i] - close <= kappa <= plastic.kappa_max[i] + close
    assert plastic_energy(plastic, section, grid)[1] > 0


@JIT_ONLY
@pytest.mark.filterwarnings("ignore::impactlab.ImplausibleWarning")
def test_random_cases_stay_in_balance_at_the_largest_time_step():
    varied = drawn(60, seed=4)
    varied["nodes"] = np.random.default_rng(5).choice([5, 11, 31, 101], 60)
    varied["courant"] = np.full(60, 1.0)
    grid = il.Discretisation(scheme="modal")
    runs = simulate_many(il.paper_impact(), grid, duration=4e-3, varied=varied)
    assert not (runs.status.values & STATUS_FLAGS["diverged"][0]).any()
    assert np.nanmax(runs.energy_error.where(runs.nodes > 20)) < 1e-2
    assert runs.energy_error.max() < 0.1
