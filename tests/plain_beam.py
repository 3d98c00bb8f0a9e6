"""A plain solver to compare the kernels with: the same schemes, written plainly.

The whole beam, every fibre through its return mapping at every step, the contact laws with
unloading and reloading written out, the modal scheme's sums over modes as dense matrices of the
nodes, and the responses read off the full histories afterwards. From impactlab come only the case,
the number of steps and, from its independent solutions, the integration rules, the modes and the
contact laws beyond the paper's.
SI units; z and w point downwards.
"""

import math
from types import FunctionType
from typing import Any, NamedTuple

import numba
import numpy as np

import impactlab as il
from impactlab.verification.solutions import bending, contact_laws
from impactlab.verification.solutions.beam_modes import modes_left_out, modes_on_nodes

Array = np.ndarray[Any, Any]

HERTZ, STRONGE = 0, 1
FURTHER = ("stronge_original", "jackson_green", "kogut_etsion")
"""Laws that are written out in the independent solutions: with a jump, and another exponent."""
LAWS = {name: number for number, name in enumerate(("hertz", "stronge", *FURTHER))}
TH = 1.1
PLASTIC_ZONE = 1e-5


class Contact(NamedTuple):
    """law: its number above. E (Pa) and R (m): effective; S_y (Pa), nu: of the softer body."""

    law: int
    E: float
    R: float
    S_y: float
    nu: float


class Bar(NamedTuple):
    """The beam: mass per length mu (kg/m), moduli and yield stress (Pa), and its cuts.

    z (m) and area (m2): of the fibres, shape (points,); dx in m.
    """

    mu: float
    E: float
    S_y: float
    H_i: float
    H_k: float
    z: Array
    area: Array
    dx: float


class Matrices(NamedTuple):
    """Matrices of the modal scheme for the inner nodes, not differences; empty for leapfrog.

    curve: from deflections (m) to curvatures (1/m); pull, push: from
    moments (N m) and from forces per length (N/m) to accelerations (m/s2). flexibility (m/N), D: of
    the modes left out, which together are an oscillator of their own at mid-span.
    """

    curve: Array
    pull: Array
    push: Array
    flexibility: float
    D: float


class Run(NamedTuple):
    """Histories at every step, shape (steps + 1,), and the final state of the beam.

    contact_force (N), midspan_deflection (m), midspan_curvature (1/m), sphere_displacement and
    indentation (m); deepest (m): the largest indentation so far; dent (m): the indentation at which
    the contact would end. deflection (nodes,), plastic_strain and peeq (nodes, points).
    """

    dt: float
    contact_force: Array
    midspan_deflection: Array
    midspan_curvature: Array
    sphere_displacement: Array
    indentation: Array
    deepest: Array
    dent: Array
    deflection: Array
    plastic_strain: Array
    peeq: Array


def _further(which):
    """Return one function (0: loading, 1: unloading) for all laws of FURTHER, by number."""
    scope = dict(vars(contact_laws))  # so that they find each other compiled
    for name, function in vars(contact_laws).items():
        if isinstance(function, FunctionType):
            copy = FunctionType(function.__code__, scope, name, function.__defaults__)
            scope[name] = numba.njit(copy)

    def link(number, chosen, others):
        return numba.njit(lambda law, *args: chosen(*args) if law == number else others(law, *args))

    functions = {name: scope[contact_laws.LAWS[name][which].__name__] for name in FURTHER}
    last = functions[FURTHER[0]]
    chain = numba.njit(lambda law, *args: last(*args))
    for name, function in functions.items():
        chain = link(LAWS[name], function, chain)
    return chain


further_force, further_unloading = _further(0), _further(1)


@numba.njit
def loading_force(contact, d):
    """Return the force at an indentation d that is the largest so far."""
    hertz = 4.0 / 3.0 * contact.E * contact.R**0.5
    if d <= 0.0:
        return 0.0
    if contact.law > STRONGE:
        return further_force(contact.law, d, contact.E, contact.R, contact.S_y, contact.nu)
    if contact.law == HERTZ:
        return hertz * d**1.5
    d_y = (3.0 * math.pi * TH * contact.S_y / (4.0 * contact.E)) ** 2 * contact.R
    F_y = hertz * d_y**1.5
    x = d / d_y
    u = 2.0 * x - 1.0
    if x <= 1.0:
        return F_y * x**1.5
    if math.log(u) <= 3.0 * (2.8 - TH):
        return F_y * u * (1.0 + math.log(u) / (3.0 * TH))
    return 2.8 * F_y * u / TH


@numba.njit
def unloading(contact, deepest):
    """Return (force at its start, dent, exponent) of the unloading curve."""
    F_m = loading_force(contact, deepest)
    if contact.law > STRONGE:
        bodies = contact.E, contact.R, contact.S_y, contact.nu
        return further_unloading(contact.law, deepest, F_m, *bodies)
    d_y = (3.0 * math.pi * TH * contact.S_y / (4.0 * contact.E)) ** 2 * contact.R
    if contact.law == HERTZ or deepest <= d_y:
        return F_m, 0.0, 1.5
    R_e = math.sqrt(3.0 * F_m / (4.0 * contact.E)) * (contact.R / d_y) ** 0.75
    return F_m, deepest - d_y * R_e / contact.R, 1.5


@numba.njit
def contact_force(contact, d, deepest):
    """Return the force at d after a largest indentation `deepest`, reloading as unloading."""
    if d >= deepest:
        return loading_force(contact, d)
    start, dent, exponent = unloading(contact, deepest)
    return start * (max(d - dent, 0.0) / (deepest - dent)) ** exponent


@numba.njit
def top_of_parabola(before, here, after):
    """Return the largest value of the parabola through three equally spaced points."""
    slope, bend = 0.5 * (after - before), after - 2.0 * here + before
    return here - 0.5 * slope**2 / bend


@numba.njit
def moment(bar, kappa, plastic_strain, peeq):
    """Return M of one section at curvature kappa, and update its fibres (points,)."""
    M = 0.0
    for j in range(bar.z.size):
        strain = -bar.z[j] * kappa
        trial = bar.E * (strain - plastic_strain[j])
        distance = trial - bar.H_k * plastic_strain[j]
        beyond = abs(distance) - (bar.S_y + bar.H_i * peeq[j])
        if beyond > 0.0:
            slip = beyond / (bar.E + bar.H_i + bar.H_k)
            plastic_strain[j] += slip if distance > 0.0 else -slip
            peeq[j] += slip
        M += bar.area[j] * bar.z[j] * bar.E * (strain - plastic_strain[j])
    return M


@numba.njit
def march(bar, contact, v_0, g, m_s, dt, steps, scheme, histories, w, plastic_strain, peeq):
    """March by central differences from first touch; fill histories, (7, steps + 1) as in Run.

    scheme: see Matrices; w (nodes,), plastic_strain and peeq (nodes, points): at rest, filled.
    """
    last = w.size - 1
    middle = last // 2
    v, M, p, a = np.zeros(w.size), np.zeros(w.size), np.zeros(w.size), np.zeros(w.size)
    kappa = np.zeros(w.size)
    w_s, v_s, deepest, before, here = 0.0, v_0, 0.0, 0.0, 0.0
    beyond, gain = 0.0, 0.0  # of the modes left out
    for step in range(steps + 1):
        d = w_s - w[middle] - beyond
        if here == deepest and before <= here and d < here:
            deepest = top_of_parabola(before, here, d)
        deepest = max(deepest, d)
        F = contact_force(contact, d, deepest)
        if scheme.curve.size > 0:
            kappa[1:last] = scheme.curve @ w[1:last]
        else:
            kappa[1:last] = (w[:-2] - 2.0 * w[1:last] + w[2:]) / bar.dx**2
        for i in range(1, last):
            M[i] = moment(bar, kappa[i], plastic_strain[i], peeq[i])
        row = histories[:, step]
        row[0], row[1], row[2], row[3], row[4] = F, w[middle] + beyond, kappa[middle], w_s, d
        row[5], row[6] = deepest, unloading(contact, deepest)[1]
        if step == steps:
            break
        kick = 0.5 * dt if step == 0 else dt
        v_s += kick * (g - F / m_s)
        w_s += dt * v_s
        p[middle] = F / bar.dx
        if scheme.pull.size > 0:
            a[1:last] = scheme.pull @ M[1:last] + scheme.push @ p[1:last]
        else:
            a[1:last] = ((M[:-2] - 2.0 * M[1:last] + M[2:]) / bar.dx**2 + p[1:last]) / bar.mu
        gain += kick / dt * scheme.D * (scheme.flexibility * F - beyond)
        beyond += gain
        v += kick * a
        w += dt * v
        before, here = here, d


def make_contact(impact: il.Impact) -> Contact:
    sphere, beam = impact.sphere.material, impact.beam.material
    compliance = (1.0 - sphere.poissons_ratio**2) / sphere.youngs_modulus
    compliance += (1.0 - beam.poissons_ratio**2) / beam.youngs_modulus
    softer = beam if beam.yield_stress <= sphere.yield_stress else sphere
    return Contact(
        LAWS[impact.contact],
        1.0 / compliance,
        float(impact.sphere.radius),
        float(softer.yield_stress),
        float(softer.poissons_ratio),
    )


def make_bar(impact: il.Impact, grid: il.Discretisation) -> Bar:
    beam, material = impact.beam, impact.beam.material
    positions, weights = bending.rule(grid.rule, grid.points)
    return Bar(
        material.density * beam.width * beam.depth,
        material.youngs_modulus,
        material.yield_stress,
        float(material.isotropic_hardening_modulus),
        float(material.kinematic_hardening_modulus),
        positions * beam.depth / 2.0,
        weights * beam.width * beam.depth / 2.0,
        beam.span / (grid.nodes - 1),
    )


def make_matrices(impact: il.Impact, bar: Bar, grid: il.Discretisation, dt: float) -> Matrices:
    """Return what the scheme of the grid does to the inner nodes."""
    if grid.scheme == "leapfrog":
        return Matrices(*np.zeros((3, 0, 0)), 0.0, 0.0)
    stiffness = bar.E * (bar.area @ bar.z**2)
    k, shapes, inertias = modes_on_nodes(impact.beam, grid.nodes, stiffness, dt)
    shapes = shapes[1:-1]
    to_modes = np.linalg.pinv(shapes)
    back = shapes / inertias
    left_out = modes_left_out(impact.beam, grid.nodes, stiffness, dt)
    pull = back * -(k**2) @ to_modes
    return Matrices(shapes * -(k**2) @ to_modes, pull, back @ to_modes, *left_out)


def solve(impact: il.Impact, grid: il.Discretisation, dt: float, steps: int) -> Run:
    """Solve over `steps` steps of dt seconds."""
    histories = np.zeros((7, steps + 1))
    bar = make_bar(impact, grid)
    w = np.zeros(grid.nodes)
    plastic_strain = np.zeros((grid.nodes, grid.points))
    peeq = np.zeros((grid.nodes, grid.points))
    march(
        bar,
        make_contact(impact),
        float(impact.velocity),
        float(impact.gravity),
        impact.sphere.total_mass,
        dt,
        steps,
        make_matrices(impact, bar, grid, dt),
        histories,
        w,
        plastic_strain,
        peeq,
    )
    return Run(dt, *histories, w, plastic_strain, peeq)


def responses(impact: il.Impact, grid: il.Discretisation, run: Run) -> dict[str, float]:
    """Return the responses of impactlab.variables but for the energies; NaN where missing."""
    return _peaks(impact, run) | _contacts(impact, run) | _strains(impact, grid, run)


def _peaks(impact: il.Impact, run: Run) -> dict[str, float]:
    w, d, deepest = run.midspan_deflection, run.indentation, run.deepest[-1]
    inner = w[1:-1]
    highs = np.flatnonzero((inner > w[:-2]) & (w[2:] <= inner)) + 1
    w_max = max((top_of_parabola(*w[k - 1 : k + 2]) for k in highs), default=0.0)
    found = {"maximum_deflection": w_max if w[-1] <= w_max else np.nan}
    if d[-1] == deepest:
        return found | dict.fromkeys(
            ("peak_force", "time_of_peak_force", "maximum_indentation"), np.nan
        )
    k = np.flatnonzero(run.deepest == deepest)[0] - 1  # the step before it began to fall
    slope, bend = 0.5 * (d[k + 1] - d[k - 1]), d[k + 1] - 2.0 * d[k] + d[k - 1]
    return found | {
        "peak_force": loading_force(make_contact(impact), deepest),
        "time_of_peak_force": (k - slope / bend) * run.dt,
        "maximum_indentation": deepest,
    }


def _contacts(impact: il.Impact, run: Run) -> dict[str, float]:
    d, dent, F = run.indentation, run.dent, run.contact_force
    gap_before, gap = dent[1:] - d[:-1], dent[1:] - d[1:]
    touching = np.concatenate([[True], gap < 0.0])
    crossing = (np.arange(1, d.size) - gap / (gap - gap_before)) * run.dt
    changes = np.flatnonzero(np.diff(touching))
    ends, begins = changes[::2], changes[1::2]
    v_s = np.diff(run.sphere_displacement) / run.dt
    v_beam = (run.midspan_deflection[-1] - run.midspan_deflection[-2]) / run.dt
    apart = not touching[-1]
    leaving = apart and v_s[-1] < 0.0 and v_s[-1] < v_beam
    exit_velocity = -v_s[ends[-1]] if leaving else np.nan
    time_in_contact = crossing[ends].sum() - crossing[begins].sum()
    pauses = np.append(crossing[begins], np.inf)[: ends.size] / crossing[ends] - 1.0
    lasting = ends[pauses >= 0.05]  # shorter ones are parts of the contact
    return {
        "contact_duration": crossing[lasting[0]] if lasting.size else np.nan,
        "number_of_contacts": 1.0 + begins.size,
        "total_contact_time": time_in_contact if apart else np.nan,
        "permanent_indentation": dent[-1] if apart else np.nan,
        "impulse": run.dt * (F.sum() - 0.5 * F[-1]) if apart else np.nan,
        "rebound_velocity": exit_velocity,
        "restitution": exit_velocity / impact.velocity,
    }


def _strains(impact: il.Impact, grid: il.Discretisation, run: Run) -> dict[str, float]:
    bar, beam = make_bar(impact, grid), impact.beam
    largest = run.peeq.max(axis=1)
    away = np.abs(np.arange(grid.nodes) - grid.nodes // 2) * bar.dx
    work = (bar.S_y + 0.5 * bar.H_i * run.peeq) * run.peeq
    return {
        "peak_plastic_strain": largest.max(),
        "remote_plastic_strain": largest[away > beam.depth].max(initial=0.0),
        "plastic_zone_length": bar.dx * sum(map(_share_plastic, largest[:-1], largest[1:])),
        "plastic_dissipation": bar.dx * float((work @ bar.area).sum()),
    }


def _share_plastic(left: float, right: float) -> float:
    """Return the share of a cell in which the line from left to right lies above PLASTIC_ZONE."""
    ends = sorted([left, right])
    if left == right:
        return float(left >= PLASTIC_ZONE)
    return float(np.clip((ends[1] - PLASTIC_ZONE) / (ends[1] - ends[0]), 0.0, 1.0))
