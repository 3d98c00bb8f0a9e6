"""Energy and momentum: sums over the dataset of an impact, and balances of random cases."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import Value, with_values
from impactlab.simulate import run_dataset
from impactlab.solver import RULES
from impactlab.types import Floats
from impactlab.variables import WARNINGS
from impactlab.verification.cases import discretised
from impactlab.verification.finding import Comparisons, Curve, CurvePanel, Finding, Reference, check
from impactlab.verification.solutions import bending
from impactlab.verification.solutions.beam_modes import modes_left_out, modes_on_nodes
from impactlab.verification.solutions.contact_laws import LAWS, stronge_impact


@dataclass(frozen=True)
class Audit:
    """Sums over one run.

    energy, momentum: what is in excess at the end, as a share of what the sphere brings and gravity
    adds; momentum: the sphere's alone. contact: integral of the force over the indentation,
    plastic: of the yield stress over the PEEQ, both in J. brought: the energy brought, in J.
    """

    impact: Impact
    run: xr.Dataset
    energy: float
    momentum: float
    contact: float
    plastic: float
    brought: float

    @property
    def ended(self) -> bool:
        """True if the contact has ended."""
        return not math.isnan(self.run.contact_dissipation.item())

    @property
    def marked(self) -> bool:
        """True if the run is marked: its contact law created energy."""
        return bool(self.run.remarks.item() & WARNINGS["contact_created_energy"][0])


def audit(impact: Impact, grid: Discretisation, duration: float) -> Audit:
    """Solve the impact three times, and sum. duration in s, made a whole number of time steps."""
    # The solver's time step, slightly reduced, in single precision, so that durations are exact
    # multiples of it: runs that end a step apart then take the very same steps, and their
    # difference is free of rounding.
    single = np.float32(discretised(impact, grid, 1.0)[0].dt)
    dt = float(np.nextafter(single, np.float32(0.0)))
    steps = round(duration / dt)
    duration = dt * steps
    run = run_dataset(impact, grid, duration=duration, samples=steps + 1)
    mass, gravity = impact.sphere.total_mass, impact.gravity
    force, time = run.contact_force.values, run.time.values
    impulse = float(np.trapezoid(force, time))
    contact = float(np.trapezoid(force, run.indentation.values))
    # The sphere's velocities half a step before the end and half a step after.
    fallen, last = run.sphere_displacement.values, float(time[-1] - time[-2])
    earlier = float((fallen[-1] - fallen[-2]) / last)
    later = earlier + last * (gravity - float(force[-1]) / mass)
    ends = [run_dataset(impact, grid, duration=duration + s, samples=2) for s in (-dt, dt)]
    before, now, after = (dataset.deflection.values for dataset in (ends[0], run, ends[1]))
    bend = _bend_modes if grid.scheme == "modal" else _bend_differences
    curvature, momentum = bend(impact, grid, dt, now, (now - before) / dt)
    moving = float(0.5 * momentum @ (after - now) / dt)
    plastic, stored = _strain_energies(impact, grid, run, curvature)
    if grid.scheme == "modal":
        stored += _left_out(impact, grid, dt, (ends[0], run, ends[1]))
    start = impact.velocity**2 - (0.5 * gravity * dt) ** 2  # a product, too
    brought = 0.5 * mass * start + mass * gravity * float(fallen.max())
    spent = mass * gravity * float(fallen.max() - fallen[-1])
    kinetic = 0.5 * mass * earlier * later + moving
    pushed = mass * (impact.velocity + gravity * duration)
    energy = (kinetic + spent + contact + stored + plastic) / brought - 1.0
    excess = (0.5 * mass * (earlier + later) + impulse) / pushed - 1.0
    return Audit(impact, run, energy, excess, contact, plastic, brought)


def _bend_differences(
    impact: Impact, grid: Discretisation, dt: float, w: Floats, v: Floats
) -> tuple[Floats, Floats]:
    """Return the nodes' (curvatures in 1/m, momenta in kg m/s) from w (m) and v (m/s), (nodes,)."""
    dx = impact.beam.span / (grid.nodes - 1)
    return np.pad(np.diff(w, 2), 1) / dx**2, impact.beam.mass_per_length * dx * v


def _bend_modes(
    impact: Impact, grid: Discretisation, dt: float, w: Floats, v: Floats
) -> tuple[Floats, Floats]:
    """Return the same where modes are moved, by steps of dt (s)."""
    beam, stiffness = impact.beam, _stiffness(impact, grid)
    k, shapes, inertia = modes_on_nodes(beam, grid.nodes, stiffness, dt)
    share = 2.0 / (grid.nodes - 1)
    q, q_rate = share * (w @ shapes), share * (v @ shapes)
    return -shapes @ (k**2 * q), share * 0.5 * beam.span * (shapes @ (inertia * q_rate))


def _left_out(impact: Impact, grid: Discretisation, dt: float, runs: Sequence[xr.Dataset]) -> float:
    """Return the energy in J of the modes left out at the end of the second of three runs."""
    flexibility, turn = modes_left_out(impact.beam, grid.nodes, _stiffness(impact, grid), dt)
    middle = grid.nodes // 2  # deflects by the modes left out beyond the nodes' modes
    q = [float(run.midspan_deflection[-1] - run.deflection[middle]) for run in runs]
    return (0.5 * q[1] ** 2 + 0.5 * (q[1] - q[0]) * (q[2] - q[1]) / turn) / flexibility


def _stiffness(impact: Impact, grid: Discretisation) -> float:
    """Return EI in N m2, as the fibres have it."""
    positions, weights = bending.rule(grid.rule, grid.points)
    return 1.5 * float(weights @ positions**2) * impact.beam.bending_stiffness


def _strain_energies(
    impact: Impact, grid: Discretisation, run: xr.Dataset, curvature: Floats
) -> tuple[float, float]:
    """Return the (dissipated, stored) energy in J, fibre by fibre; curvature in 1/m, (nodes,)."""
    beam, material, x = impact.beam, impact.beam.material, run.x.values
    _, area = beam.section.fibres(*bending.rule(grid.rule, grid.points))
    strain, peeq = run.plastic_strain.values, run.equivalent_plastic_strain.values
    elastic = -np.multiply.outer(curvature, run.z.values) - strain
    stored = 0.5 * material.youngs_modulus * elastic**2
    stored += 0.5 * material.kinematic_hardening_modulus * strain**2
    lost = (material.yield_stress + 0.5 * material.isotropic_hardening_modulus * peeq) * peeq
    return float(np.trapezoid(lost @ area, x)), float(np.trapezoid(stored @ area, x))


_DRAWN = {"leapfrog": 80, "modal": 40}  # numbers of drawn cases


@check(
    "Balances of energy and momentum",
    "Sums over the dataset in impactlab.verification.energy; loops of Stronge's law",
    Reference("identity", 0.0, "exact"),
)
def balances() -> Finding:
    """Compare each quantity at the worst of the drawn cases of each scheme.

    Dissipations are never negative but for rounding, unless the contact law itself creates energy.
    """
    comparisons = Comparisons()
    curves: list[Curve] = []
    every: list[Audit] = []
    for scheme, number in _DRAWN.items():
        random, audits = np.random.default_rng(20240607), []
        for _ in range(number):
            values = _drawn(random, scheme)
            impact, grid = with_values(paper_impact(), Discretisation(), values)
            audits.append(audit(impact, grid, float(random.uniform(1e-3, 5e-3))))
        _compare(comparisons, scheme, audits)
        rank = np.arange(1.0, number + 1.0)
        for label, errors in (
            ("energy", [case.energy for case in audits]),
            ("sphere's momentum", [case.momentum for case in audits]),
        ):
            sizes = np.maximum(np.sort(np.abs(errors)), 1e-12)
            curves.append(Curve(f"{scheme}: {label}", rank, sizes))
        every += audits
    axes = ("cases, the best first", "1"), ("share of what is brought", "1")
    excess = CurvePanel("In excess at the end, case by case", *axes, curves, log=True)
    _compare_created(comparisons, every)
    return Finding(comparisons, [excess, _loop_panel(every)])


def _compare(comparisons: Comparisons, scheme: str, audits: list[Audit]) -> None:
    """Add the worst error of each balance, and the least dissipations."""
    contact, plastic = [], []
    for case in audits:
        lost = case.run.contact_dissipation.item() if case.ended else case.contact
        contact.append((lost - case.contact) / case.brought)
        plastic.append((case.run.plastic_dissipation.item() - case.plastic) / case.brought)
    for quantity, errors, tolerance in (
        ("energy in excess, the beam elastic", [a.energy for a in audits if not a.plastic], 1e-9),
        ("energy in excess, the beam yielding", [a.energy for a in audits if a.plastic], 2e-3),
        ("sphere's momentum in excess", [a.momentum for a in audits], 1e-9),
        ("contact dissipation", contact, 2e-3),
        ("plastic dissipation", plastic, 1e-12),
    ):
        where = f"{scheme}: worst of {len(errors)} drawn cases, over what is brought"
        worst = float(np.max(np.abs(errors)))
        comparisons.at(where).absolute(quantity, "1", worst, 0.0, tolerance)
    for name, cases in (
        ("plastic_dissipation", audits),
        ("contact_dissipation", [case for case in audits if not case.marked]),
    ):
        least = float(np.nanmin([case.run[name].item() / case.brought for case in cases]))
        where = f"{scheme}: least of {len(cases)} cases, over what is brought"
        label = name.replace("_", " ")
        comparisons.at(where).absolute(label, "1", min(least, 0.0), 0.0, 1e-9)


def _drawn(random: np.random.Generator, scheme: str) -> dict[str, Value]:
    """Draw a case, of the modal scheme the same with half as many spacings."""
    soft = bool(random.random() < 0.5)  # the beam yields

    def modulus() -> float:
        return float(random.choice([0.0, random.uniform(0.0, 20e9)]))

    exponent = random.uniform(0.0, 1.4) if soft else random.uniform(-2.3, -0.7)
    return {
        "velocity": float(10.0**exponent),
        "gravity": float(random.choice([0.0, 9.81, 50.0])),
        "contact": str(random.choice(list(LAWS))),
        "sphere_radius": float(random.uniform(0.01, 0.05)),
        "sphere_yield_stress": float(random.uniform(300e6, 3e9)),
        "beam_span": float(random.uniform(0.4, 1.0)),
        "beam_width": float(random.uniform(0.02, 0.1)),
        "beam_depth": float(random.uniform(0.01, 0.04)),
        "beam_yield_stress": float(random.uniform(50e6, 200e6) if soft else 600e6),
        "beam_isotropic_hardening_modulus": modulus(),
        "beam_kinematic_hardening_modulus": modulus(),
        "scheme": scheme,
        "nodes": 2 * int(random.integers(20, 51) // (2 if scheme == "modal" else 1)) + 1,
        "points": int(random.integers(2, 16)),
        "rule": str(random.choice(RULES)),
        "courant": float(random.uniform(0.3, 0.9)),
    }


def _compare_created(comparisons: Comparisons, audits: list[Audit]) -> None:
    """Compare the marked runs with those in which Stronge's loop gives back more than it took."""
    marked, expected = [], []
    for case in audits:
        if case.impact.contact in ("hertz", "stronge") and case.ended:
            law, deepest = stronge_impact(case.impact), case.run.maximum_indentation.item()
            yields = case.impact.contact == "stronge" and deepest > law.yield_indentation
            marked.append(case.marked)
            expected.append(yields and law.released_work(deepest) > law.loading_work(deepest))
    where = "runs marked; runs whose largest indentation says so by the law's closed form"
    wrong = float(np.sum(np.array(marked) != np.array(expected)))
    label = "contact law created energy"
    comparisons.at(where).absolute(label, "1", sum(marked), sum(expected), 0.0)
    comparisons.at("runs marked wrongly").absolute(label, "1", wrong, 0.0, 0.0)


def _loop_panel(audits: list[Audit]) -> CurvePanel:
    """Draw the dissipation over the work of loading, where the law creates energy and beyond."""
    points = []
    for case in audits:
        law, lost = stronge_impact(case.impact), case.run.contact_dissipation.item()
        times = case.run.maximum_indentation.item() / law.yield_indentation
        if case.impact.contact == "stronge" and 0.2 < times < 8.0 and case.ended:
            points.append((times, lost / law.loading_work(times * law.yield_indentation)))
    solver = np.array(sorted(points)).reshape(-1, 2)
    law = stronge_impact(paper_impact())
    x = np.linspace(1.001, 8.0, 200)
    share = [1.0 - law.released_work(d) / law.loading_work(d) for d in x * law.yield_indentation]
    curves = [
        Curve("solver", solver[:, 0], solver[:, 1]),
        Curve("the law's loop", x, np.array(share), independent=True),
    ]
    title = "Stronge's law creates energy below 2.673 times the yield indentation"
    x_axis = ("largest indentation over that of first yield", "1")
    return CurvePanel(title, x_axis, ("contact dissipation over the work of loading", "1"), curves)
