"""The time loop: leapfrog (central differences), velocities at half steps.

m_s w_s'' = -F + m_s g, w_s(0) = 0, w_s'(0) = v0; indentation delta = w_s - w(L/2).
"""

from __future__ import annotations

import math

import numpy as np

from impactlab.kernels import responses
from impactlab.kernels import track as watch
from impactlab.kernels.beam import (
    Beam,
    Grid,
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
from impactlab.kernels.contact import history as contact_history
from impactlab.kernels.contact.history import CONTACT, Pair, make_pair
from impactlab.kernels.jit import compiled
from impactlab.kernels.section import Section, make_section
from impactlab.kernels.stability import critical_time_step
from impactlab.kernels.status import DIVERGED, ENERGY_OUT_OF_BALANCE
from impactlab.kernels.track import TRACK
from impactlab.kernels.types import Array, Record

_AUDITS = 500
_LEAST_STRIDE, _LARGEST_STRIDE = 8, 64
"""Energy is audited 500 times a run, but no more often than every 8 steps nor less than 64."""

WORST_ENERGY_ERROR = 0.05
"""Imbalance over the initial kinetic energy beyond which a run gives no other answer."""


@compiled
def discretise(case: Record, pair: Pair, section: Section) -> tuple[Grid, int]:
    """Nodes and time steps of a case: (grid, number of steps)."""
    dx = case.beam_span / (case.nodes - 1)
    dt = case.courant * critical_time_step(case, pair, section.stiffness, dx)
    steps = math.ceil(case.duration / dt)
    mu = case.beam_density * case.beam_width * case.beam_depth
    return make_grid(case.nodes // 2, dx, case.duration / steps, mu), steps


@compiled
def _sample(
    out: Array,
    t: float,
    dt: float,
    interval: float,
    before: tuple[float, float, float, float, float],
    here: tuple[float, float, float, float, float],
) -> None:
    """Fill the samples of `out`, shape (5, samples), that fall into the step that ends at t."""
    if out.shape[1] == 0:
        return
    k = math.ceil((t - dt) / interval - 1e-9)
    while k < out.shape[1] and k * interval <= t * (1.0 + 1e-12):
        share = 1.0 - (t - k * interval) / dt
        for row in range(5):
            out[row, k] = before[row] + share * (here[row] - before[row])
        k += 1


@compiled
def _imbalance(
    case: Record,
    pair: Pair,
    section: Section,
    grid: Grid,
    beam: Beam,
    contact: Record,
    first: int,
    delta: float,
    F: float,
    w_s: float,
    v_s: float,
) -> float:
    """Energy missing or in excess, over the initial kinetic energy."""
    start = 0.5 * case.sphere_mass * case.velocity**2
    v_next = v_s + grid.dt * (case.gravity - F / case.sphere_mass)
    sphere = 0.5 * case.sphere_mass * v_s * v_next - case.sphere_mass * case.gravity * w_s
    stored, dissipated = strain_energies(beam, section, grid, first)
    held, lost = contact_history.energies(contact, pair, delta)
    total = sphere + kinetic_energy(beam, grid, first, F) + stored + dissipated + held + lost
    return abs(total - start) / start


@compiled
def _contact_force(
    contact: Record, track: Record, pair: Pair, delta: float, t: float, dt: float
) -> float:
    """Contact force (N) at the step of time t; a peak just passed is taken between the steps."""
    if watch.passed_peak(track, delta, contact.delta_m):
        offset, peak = watch.vertex(track.delta_before, track.delta, delta)
        contact_history.load(contact, pair, peak)
        track.t_peak = t + (offset - 1.0) * dt
    return contact_history.force(contact, pair, delta)


@compiled
def _answer(
    answer: Record,
    case: Record,
    pair: Pair,
    section: Section,
    grid: Grid,
    beam: Beam,
    contact: Record,
    track: Record,
    first: int,
    v_s: float,
) -> None:
    """All responses, or none and why, at the end of a run that has not diverged."""
    _, dissipated = strain_energies(beam, section, grid, first)
    responses.clear(answer, 0)
    responses.read_contact(answer, track, contact, pair)
    responses.read_rebound(answer, case, track, v_s, beam.u[grid.n] / grid.dt)
    responses.read_beam(answer, case, track, beam, grid, dissipated)
    if track.energy_error > WORST_ENERGY_ERROR:
        responses.clear(answer, ENERGY_OUT_OF_BALANCE)
    answer.energy_error = track.energy_error


@compiled
def run(
    case: Record,
    answer: Record,
    samples: Array,
    deflection: Array,
    plastic_strain: Array,
    peeq: Array,
) -> None:
    """Solve one case.

    case: a CASE record. answer: a RESPONSE record, filled. samples: shape (4, S), filled with
    force, mid-span deflection, sphere displacement and indentation at S equal intervals from 0
    to the duration; S = 0 for none. deflection (n + 1,), plastic_strain and peeq
    (n + 1, P // 2): filled with the half beam's final state; length 0 for none. A run that
    diverges leaves NaN and its status.
    """
    pair, section = make_pair(case), make_section(case)
    grid, steps = discretise(case, pair, section)
    beam, n, dt, per_dx2 = make_beam(grid.n, section), grid.n, grid.dt, grid.per_dx2
    w, u, M, EI, kappa_y = beam.w, beam.u, beam.M, section.stiffness, section.yield_curvature
    M_0, kappa_min, kappa_max = beam.M_0, beam.kappa_min, beam.kappa_max
    strain, peeq_, z, lever = beam.plastic_strain, beam.peeq, section.z, section.lever
    constants = (section.E, section.S_y, section.H_i, section.H_k, EI)
    contact, track = np.zeros(1, CONTACT)[0], np.zeros(1, TRACK)[0]
    contact.n = 1.5
    watch.start(track)
    stride = min(max(_LEAST_STRIDE, steps // _AUDITS), _LARGEST_STRIDE)
    interval = case.duration / max(samples.shape[1] - 1, 1)
    w_s, v_s, first, yielded = 0.0, case.velocity, n, False

    for step in range(steps + 1):
        t, w_mid = step * dt, w[n]
        delta = w_s - w_mid
        F = _contact_force(contact, track, pair, delta, t, dt)
        if yielded:
            outside = elastic_moments(w, M, M_0, kappa_min, kappa_max, first, EI, per_dx2)
        else:
            outside = virgin_moments(w, M, first, EI, kappa_y, per_dx2)
        if outside > 0.0:
            yielded = True
            bend_yielding(
                w,
                M,
                M_0,
                kappa_min,
                kappa_max,
                strain,
                peeq_,
                z,
                lever,
                constants,
                outside,
                per_dx2,
            )
        watch.watch_contact(track, delta, contact.delta_r, v_s, t, dt)
        watch.watch_deflection(track, w_mid)
        kappa = 2.0 * (w[n - 1] - w_mid) * per_dx2
        before = (track.F, track.w, track.kappa, w_s - v_s * dt, track.delta)
        _sample(samples, t, dt, interval, before, (F, w_mid, kappa, w_s, delta))
        watch.shift(track, delta, w_mid, kappa, F, dt)
        if (step + 1) % stride == 0 or step == steps:
            error = _imbalance(case, pair, section, grid, beam, contact, first, delta, F, w_s, v_s)
            track.energy_error = max(track.energy_error, error)
            if not error < 1.0:
                responses.clear(answer, DIVERGED)
                samples[:] = np.nan
                return
        if step < steps:
            v_s += (0.5 if step == 0 else 1.0) * dt * (case.gravity - F / case.sphere_mass)
            move(w, u, M, first, grid.factor, grid.push * F)
            w_s += dt * v_s
            first = reach(w, first)

    _answer(answer, case, pair, section, grid, beam, contact, track, first, v_s)
    if deflection.size > 0:
        deflection[:] = w[: n + 1]
        plastic_strain[:] = beam.plastic_strain
        peeq[:] = beam.peeq


@compiled
def run_all(
    cases: Array,
    answers: Array,
    samples: Array,
    deflection: Array,
    plastic_strain: Array,
    peeq: Array,
) -> None:
    """Solve every case; the arrays of `run` with one more dimension in front, the run."""
    for r in range(cases.size):
        run(cases[r], answers[r], samples[r], deflection[r], plastic_strain[r], peeq[r])
