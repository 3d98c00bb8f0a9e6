"""The Euler-Bernoulli beam by leapfrog with Rayleigh's damping, on Winkler's foundation.

rho A w_tt + alpha rho A w_t + beta (EI w_xxxx + k w)_t = M_xx - k w + p, with the elastic EI and
springs of ends where sections yield, too. With u = dt w_t at half steps, the grid's stiffness K and
masses m, a step is

    (1 + h) u_after = (1 - h) u - dt^2/m (K w - source - F) - beta dt/m K u,  h = alpha dt/2:

the mass's damping is central, the stiffness's lags by half a step, which is an error of beta dt K/4
over the mass, dt ~ dx^2. It makes the step shorter (stability.py). The damping takes the work of
its force f in the mean velocity of a step; the kinetic energy u u_before at a full step has half of
that step's work still to give:

    lost = sum of f (u + u_before)/2 of all steps before + f u_before/2

which closes the balance of energy to round-off. Source: Rayleigh, Theory of Sound, section 102.
"""

from typing import NamedTuple

import numpy as np

from impactlab.solver import euler_bernoulli
from impactlab.solver.beam import (
    BeamGrid,
    BeamState,
    bending_energy,
    copies,
    mirror,
    push_nodes,
)
from impactlab.solver.fibre_plasticity import plastic_energy
from impactlab.solver.jit import allocating, compiled, inlined, vectorised
from impactlab.solver.section import FibreSection
from impactlab.solver.settle import settle
from impactlab.solver.state import BeamModel, State
from impactlab.solver.types import ONE, TWO, Array, Record

_PLAIN_MAKE, _PLAIN_STEP, _PLAIN_CURVATURE = euler_bernoulli.MODEL[:3]
_PLAIN_ENERGY, _PLAIN_SPREAD = euler_bernoulli.MODEL.energy, euler_bernoulli.MODEL.spread


class Resistance(NamedTuple):
    """The state of a resisted beam besides BeamState.

    front: that of euler_bernoulli.py. before: u a step earlier (m); drag: what the stiffness's
    damping takes from it in a step (m), (last + 3,). lost: the work of damping before the last
    step, J, (1,). h: see above. lag = beta/dt; bed = dt^2 k/(rho A).
    acts: whether any of the three is above 0.
    """

    front: Array
    before: Array
    drag: Array
    lost: Array
    h: float
    lag: float
    bed: float
    acts: bool


@allocating
def _make(case: Record, section: FibreSection, grid: BeamGrid) -> Resistance:
    size = grid.last + 3
    return Resistance(
        _PLAIN_MAKE(case, section, grid),
        np.zeros(size),
        np.zeros(size),
        np.zeros(1),
        0.5 * case.mass_damping * grid.dt,
        case.stiffness_damping / grid.dt,
        grid.dt**2 * case.foundation_stiffness / grid.mu,
        case.mass_damping > 0.0 or case.stiffness_damping > 0.0 or case.foundation_stiffness > 0.0,
    )


@inlined
def _plain(state: State) -> State:
    """Return the state of the beam as euler_bernoulli.py has it."""
    pair, section, grid, beam, plastic, extra = state
    return State(pair, section, grid, beam, plastic, extra.front)


@vectorised
def _take_work(
    u: Array, before: Array, drag: Array, h: float, grid: BeamGrid, start: int, stop: int
) -> float:
    """Return the work of damping in the step before, over mu dx/dt^2, and begin another."""
    work = 0.0
    for i in range(np.uint64(start), np.uint64(stop)):
        twice = u[i] + before[i]
        work += 0.5 * copies(grid, i) * (drag[i] + h * twice) * twice
        before[i] = u[i]
    return work


@vectorised
def _drag(
    w: Array,
    now: int,
    drag: Array,
    lag: float,
    bed: float,
    grid: BeamGrid,
    start: int,
    stop: int,
) -> None:
    """Set what the stiffness's damping takes, from the last step of w."""
    last, share = 1 - now, lag * grid.stiffness
    for i in range(np.uint64(start), np.uint64(stop)):
        fourth = w[now, i - TWO] + w[now, i + TWO] - w[last, i - TWO] - w[last, i + TWO]
        fourth -= 4.0 * (w[now, i - ONE] + w[now, i + ONE] - w[last, i - ONE] - w[last, i + ONE])
        step = w[now, i] - w[last, i]
        drag[i] = share * (fourth + 6.0 * step) + lag * bed * step


@vectorised
def _resist(
    w: Array,
    now: int,
    u: Array,
    before: Array,
    drag: Array,
    h: float,
    bed: float,
    start: int,
    stop: int,
) -> None:
    """Mend a step that was made without resistance."""
    after, per = 1 - now, 1.0 / (1.0 + h)
    for i in range(np.uint64(start), np.uint64(stop)):
        change = per * (u[i] - drag[i] - h * before[i] - bed * w[now, i]) - u[i]
        u[i] += change
        w[after, i] += change


@inlined
def _step(state: State, now: int, F: float) -> None:
    _, _, grid, beam, _, extra = state
    front, before, drag, lost, h, lag, bed, acts = extra
    w, u = beam.w, beam.u
    start, stop = front[2], front[2]
    if acts:
        start, stop = front[0], front[2] + 1
        work = _take_work(u, before, drag, h, grid, start, stop)
        lost[0] += grid.mu * grid.dx / grid.dt**2 * work
        if lag > 0.0:
            _drag(w, now, drag, lag, bed, grid, start, stop)
    _PLAIN_STEP(_plain(state), now, F)
    if acts:
        _resist(w, now, u, before, drag, h, bed, start, stop)
        mirror(w, now, u, grid)


@compiled
def _curvature(state: State, now: int) -> float:
    return _PLAIN_CURVATURE(_plain(state), now)


@compiled
def _resisted_energy(beam: BeamState, now: int, extra: Resistance, grid: BeamGrid) -> float:
    """Return the kinetic energy, that of the foundation, and the work of damping, in J."""
    w, u, before, total = beam.w[now], beam.u, extra.before, 0.0
    for i in range(2, grid.last + 1):
        force = extra.drag[i] + extra.h * (u[i] + before[i])
        twice = before[i] * (u[i] + force) + extra.bed * w[i] * w[i]
        total += 0.5 * copies(grid, i) * twice
    return grid.mu * grid.dx / grid.dt**2 * total + extra.lost[0]


@compiled
def _energy(state: State, now: int, F: float, u_mid: float) -> float:
    if not state.extra.acts:
        return _PLAIN_ENERGY(_plain(state), now, F, u_mid)
    stored, dissipated = plastic_energy(state.plastic, state.section, state.grid)
    EI = state.section.stiffness
    elastic = bending_energy(state.beam, state.plastic.M_0, EI, state.grid, now)
    return (
        stored + dissipated + elastic + _resisted_energy(state.beam, now, state.extra, state.grid)
    )


@compiled
def _spread(state: State, now: int, F: float, a: float) -> tuple[float, float]:
    ahead, missing = _PLAIN_SPREAD(_plain(state), now, F / (1.0 + state.extra.h), a)
    return ahead, 0.0 if state.extra.acts else missing  # `before` knows of the force's place


@compiled
def _settle(state: State) -> None:
    _, section, grid, beam, plastic, extra = state
    for i in range(extra.before.size):
        extra.before[i] = extra.drag[i] = 0.0
    extra.lost[0] = 0.0
    settle(beam, plastic, section, grid, extra.bed * grid.mu / grid.dt**2)


@compiled
def _push(state: State, now: int, nodes: Array, forces: Array) -> float:
    grid, u, extra, work = state.grid, state.beam.u, state.extra, 0.0
    push_nodes(state.beam, grid, now, nodes, forces, 1.0 / (1.0 + extra.h))
    front = extra.front
    for k in range(nodes.size):
        if forces[k] != 0.0:
            front[0] = min(front[0], max(nodes[k] - 2, 2))
            front[2] = max(front[2], min(nodes[k] + 2, grid.last))
            work += forces[k] * u[nodes[k]]
    return 0.0 if extra.acts else 0.5 * work  # `before` knows of all forces


MODEL = BeamModel(
    _make,
    _step,
    _curvature,
    _energy,
    euler_bernoulli.deflected,
    _spread,
    _settle,
    push=_push,
)
