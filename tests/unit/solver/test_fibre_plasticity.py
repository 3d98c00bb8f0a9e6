"""Sections on and off their tangents against bending every section at every step."""

import numpy as np
import pytest

from impactlab.simulate import fibre_section
from impactlab.solver.beam import make_beam, make_grid, move, move_virgin, strike
from impactlab.solver.fibre_plasticity import (
    begin_tangents,
    catch_up,
    follow_tangents,
    leave_tangents,
    make_plastic_state,
)
from impactlab.solver.section import bend

N = 12
GRID = make_grid(N, 0.02, 1e-6, 13.0, 2e4)
MID = GRID.mid
INNER = slice(2, MID + 1)


@pytest.fixture(params=[(0.0, 0.0), (5e9, 0.0), (1e9, 4e9)], ids=["perfect", "isotropic", "both"])
def section(request, make_case):
    isotropic, kinematic = request.param
    return fibre_section(
        make_case(
            points=9,
            beam_isotropic_hardening_modulus=isotropic,
            beam_kinematic_hardening_modulus=kinematic,
        )
    )


class EverySection:
    """All sections bent at every step."""

    def __init__(self, section):
        fibres = (MID + 3, section.z.size)
        self.section, self.plastic, self.peeq = section, np.zeros(fibres), np.zeros(fibres)

    def moments(self, kappa):
        M_0 = np.zeros(MID + 3)
        for i in range(2, MID + 1):
            M_0[i], _, _ = bend(self.section, kappa[i], self.plastic, self.peeq, i)
        M_0[MID + 1] = M_0[MID - 1]
        return M_0


def bent(kappa):
    """w of a beam with these curvatures, from a straight support."""
    w = np.zeros(MID + 3)
    for i in range(1, MID + 2):
        w[i + 1] = 2 * w[i] - w[i - 1] + kappa[i] / GRID.per_dx2
    return w


def step(beam, plastic_state, section, now):
    """Do as the time loop does."""
    if follow_tangents(
        beam.w,
        now,
        None,
        beam.plastic,
        plastic_state.M_0,
        plastic_state.on_tangent,
        plastic_state.tangent,
        GRID,
    ):
        leave_tangents(beam, now, None, plastic_state, section, GRID)
    intervals = (plastic_state.kappa_min, plastic_state.kappa_max)
    outside = move(beam.w, now, beam.u, beam.plastic, *intervals, 2, GRID)
    if outside:
        begin_tangents(
            beam, now, None, outside, plastic_state, section, GRID, beam.u, beam.w[1 - now]
        )
    return outside


def path(section, steps=400):
    """Curvatures (steps, MID + 3) that rise and fall at every node, each in its own way."""
    random = np.random.default_rng(5)
    time = np.linspace(0, 1, steps)[:, np.newaxis]
    waves = [
        random.uniform(0, 4, MID + 3) * np.sin(2 * np.pi * k * time + random.uniform(0, 6, MID + 3))
        for k in (1, 2, 5)
    ]
    return time * sum(waves) * section.yield_curvature


def test_moments_and_fibres_are_those_of_bending_at_every_step(section):
    beam, plastic_state, every = (
        make_beam(GRID),
        make_plastic_state(GRID, section),
        EverySection(section),
    )
    seen = set()
    for count, kappa in enumerate(path(section)):
        now = count % 2
        beam.w[now] = bent(kappa)
        # the time loop's own differences, with their rounding
        kappa = np.concatenate([[0], np.diff(beam.w[now], 2), [0]]) * GRID.per_dx2
        seen.add(int(plastic_state.on_tangent[0]))
        step(beam, plastic_state, section, now)
        M_0 = every.moments(kappa)
        scale = section.stiffness * section.yield_curvature
        assert plastic_state.M_0[INNER] == pytest.approx(M_0[INNER], rel=1e-9, abs=1e-9 * scale)
        share = GRID.factor * np.diff(M_0, 2)[1:MID]
        assert beam.plastic[INNER] == pytest.approx(share, rel=1e-9, abs=1e-9 * GRID.factor * scale)
    assert len(seen) > 5  # sections come and go
    catch_up(plastic_state, section)
    limit = section.moduli.S_y / section.moduli.E
    assert plastic_state.peeq == pytest.approx(every.peeq, rel=1e-9, abs=1e-9 * limit)
    assert plastic_state.plastic_strain == pytest.approx(every.plastic, rel=1e-9, abs=1e-9 * limit)
    assert np.all(every.peeq[INNER, 0] > 0)


def test_the_step_is_that_of_the_moments_after_bending(section):
    """u and w take the new moments, also of sections that left their interval in this step."""
    beam, plastic_state, every = (
        make_beam(GRID),
        make_plastic_state(GRID, section),
        EverySection(section),
    )
    for now, share in ((0, 2.0), (1, 2.5), (0, 1.0), (1, -3.0)):
        kappa = share * section.yield_curvature * np.cos(np.arange(MID + 3.0))
        beam.w[now] = bent(kappa)
        beam.w[now, MID + 1 :] = beam.w[now, [MID - 1, MID - 2]]
        beam.w[now, 0] = -beam.w[now, 2]
        kappa = np.concatenate([[0], np.diff(beam.w[now], 2), [0]]) * GRID.per_dx2
        before = beam.u.copy()
        step(beam, plastic_state, section, now)
        M = every.moments(kappa) - GRID.stiffness / GRID.factor / GRID.per_dx2 * kappa
        M[1] = 0.0
        expected = before[INNER] + GRID.factor * np.diff(M, 2)[1:MID]
        assert beam.u[INNER] == pytest.approx(expected, rel=1e-9, abs=1e-12 * abs(expected).max())
        assert beam.w[1 - now, INNER] == pytest.approx(
            beam.w[now, INNER] + beam.u[INNER], rel=1e-9, abs=1e-15
        )
        assert beam.w[1 - now, 1] == 0.0  # the support


def test_a_section_on_its_tangent_leaves_its_fibres_until_asked(section):
    beam, plastic_state = make_beam(GRID), make_plastic_state(GRID, section)
    kappa = np.zeros(MID + 3)
    for count, share in enumerate((1.02, 1.04, 1.06)):
        kappa[MID] = share * section.yield_curvature
        beam.w[count % 2] = bent(kappa)
        step(beam, plastic_state, section, count % 2)
        if count == 0:
            first = plastic_state.peeq[MID].copy()
    assert plastic_state.on_tangent[0] == 1
    assert plastic_state.on_tangent[1] == MID
    assert np.array_equal(plastic_state.peeq[MID], first)
    catch_up(plastic_state, section)
    assert plastic_state.peeq[MID, 0] > first[0]


def test_virgin_and_yielded_steps_agree_where_nothing_yields(section):
    values = 1e-9 * np.sin(np.arange(MID + 3.0))
    one, other, plastic_state = make_beam(GRID), make_beam(GRID), make_plastic_state(GRID, section)
    for beam in (one, other):
        beam.w[0] = values
    assert move_virgin(one.w, 0, one.u, 2, MID + 1, GRID, section.yield_curvature) == 0
    assert step(other, plastic_state, section, 0) == 0
    for beam in (one, other):
        strike(beam.w, 0, beam.u, 3.0, GRID)
    assert one.w == pytest.approx(other.w, rel=1e-14)
