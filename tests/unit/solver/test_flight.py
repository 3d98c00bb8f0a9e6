"""The leaps of the modal scheme against its steps: state, energy, bounds, largest deflection."""

import numpy as np
import pytest

from impactlab.solver.beam import make_grid
from impactlab.solver.flight import (
    LEAST,
    MOST,
    bound_swing,
    largest_deflection,
    leap_modes,
    lowest,
    make_tables,
    note_leap,
    section_swing,
)
from impactlab.solver.modes import make_modes, modal_energy, mode_curvature, move_modes
from impactlab.solver.section import FAR

MU, EI, SPAN = 13.0, 2e4, 0.8


def swinging(n, turn, seed, slope=3.0):
    """Modes in free motion about a rest of their own; the fastest turns by `turn` per step."""
    random = np.random.default_rng(seed)
    grid = make_grid(2 * n + 1, 0.5 * SPAN / n, 1e-6, MU, EI)
    k = (2 * n - 1) * np.pi / SPAN
    grid = grid._replace(dt=turn / (k**2 * np.sqrt(EI / MU)))
    modes = make_modes(grid, EI, FAR)
    size = 1e-3 / np.arange(1, 2 * n + 2, 2) ** slope
    modes.q[:], modes.u[:] = random.normal(0, size), random.normal(0, size * np.sqrt(modes.D))
    modes.source[:n] = (random.normal(0, size) * modes.D / modes.push)[:n]
    modes.source[n] = 0.0
    leaps = modes.leaps
    bound_swing(
        *(modes.q, modes.u, modes.k2, modes.D, modes.push, modes.source),
        *(leaps.rest, leaps.A, leaps.swing, leaps.bounds),
    )
    make_tables(leaps, modes.D, MOST)
    return modes, grid


def move(modes):
    q, u, k2, D, push, source, _, seen, _, slack = modes[:10]
    return move_modes(q, u, D, push, source, k2, seen, slack, 0.0)


def energy_of(modes):
    q, u, _, D, push, source = modes[:6]
    return modal_energy(q, u, D, push, source, 0.0)


def leap(modes, level):
    leaps = modes.leaps
    state = modes.q, modes.u, modes.D, leaps.rest, leaps.D, leaps.S
    return leap_modes(*state, level, modes.q, modes.u)


@pytest.mark.parametrize("turn", [0.01, 0.3, 4.0])
@pytest.mark.parametrize("level", [0, LEAST, 6, MOST])
def test_a_leap_is_as_many_steps(level, turn):
    stepped, leapt = (swinging(9, turn, seed=level)[0] for _ in range(2))
    before, size = energy_of(leapt), np.abs(leapt.leaps.A).max()
    for _ in range(1 << level):
        w = move(stepped)
    assert leap(leapt, level) == pytest.approx((w, stepped.u.sum()), rel=0, abs=1e-11 * size)
    assert leapt.q == pytest.approx(stepped.q, rel=0, abs=1e-11 * size)
    assert leapt.u == pytest.approx(stepped.u, rel=0, abs=1e-11 * size)
    assert energy_of(leapt) == pytest.approx(before, rel=1e-11)


@pytest.mark.parametrize("turn", [0.05, 0.6, 4.0])
def test_no_step_of_a_leap_lies_below_its_bound(turn):
    """Neither of mid-span's deflection nor of any curvature; often it comes near."""
    shares = []
    for seed in range(20):
        modes, grid = swinging(7, turn, seed, slope=2.0)
        swings = [section_swing(modes.leaps.A, modes.D, modes.bent, i) for i in (2, grid.mid)]
        rows = []
        for _ in range(65):
            curvatures = [mode_curvature(modes.q, modes.bent, i) for i in (2, grid.mid)]
            rows.append([modes.q.sum(), *curvatures])
            move(modes)
        bounds = [modes.leaps.bounds.T, *(np.full((MOST, 2), swing[1:]) for swing in swings)]
        for values, by_level in zip(np.array(rows).T, bounds, strict=True):
            for level in range(LEAST, 7):
                steps, (slow, fast) = 1 << level, by_level[level]
                least = lowest(values[0], values[steps], steps, slow) - fast
                ends, least_of_steps = min(values[0], values[steps]), values[: steps + 1].min()
                assert least_of_steps >= least - 1e-12 * np.abs(values).max()
                shares.append((ends - least_of_steps) / max(ends - least, 1e-300))
    assert max(shares) > 0.3


@pytest.mark.parametrize("turn", [0.05, 0.6, 4.0])
def test_leaps_find_the_largest_deflection_of_the_steps(turn):
    """The largest vertex of a parabola through three steps, whatever the leaps are."""
    hidden = 0
    for seed in range(40):
        modes = swinging(7, turn, seed, slope=2.0)[0]
        other = swinging(7, turn, seed, slope=2.0)[0]
        random, w = np.random.default_rng(seed), modes.q.sum()
        largest, ends = 0.0, [w]
        for level in random.integers(LEAST, 8, 6):
            q, u = modes.q.copy(), modes.u.copy()
            w_after, _ = leap(modes, level)
            note_leap(modes.leaps, q, u, modes.D, w, w_after, level, 0.0)
            w = w_after
            ends.append(w)
            history = [other.q.sum() - other.u.sum(), other.q.sum()]
            history += [move(other) for _ in range(1 << level)]
            before, here, after = np.array(history[:-2]), np.array(history[1:-1]), history[2:]
            turns = (here > before) & (after <= here)
            bend = before - 2 * here + after
            vertices = here - 0.125 * (before - after) ** 2 / np.where(turns, bend, 1.0)
            largest = max(largest, vertices[turns].max(initial=0.0))
        found = largest_deflection(modes.leaps, modes.D, 0.0)
        if largest > max(ends[0], ends[-1]):  # neither beginning nor end is the largest
            assert found == pytest.approx(largest, rel=1e-9)
            hidden += largest > max(ends)
    assert hidden > 10
