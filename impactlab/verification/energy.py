"""Energy and momentum: sums over the dataset of an impact, and balances of random cases."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import Value, with_values
from impactlab.simulate import case_table, simulate
from impactlab.solver import RULES
from impactlab.solver.contact.history import make_pair
from impactlab.solver.section import make_section
from impactlab.solver.stability import discretise
from impactlab.types import Floats
from impactlab.variables import WARNINGS
from impactlab.verification.finding import (
    Check,
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
)
from impactlab.verification.solutions import quadrature
from impactlab.verification.solutions.contact_laws import LAWS
from impactlab.verification.solutions.stronge import stronge_impact


@dataclass(frozen=True)
class Audit:
    """Sums over one run.

    energy, momentum: what is in excess at the end, as a share of what the sphere brings and gravity
    adds; momentum: the sphere's alone. contact: integral of the force over the indentation,
    plastic: of the yield stress over the PEEQ, both in J. brought: the energy brought, in J.
    """

    run: xr.Dataset
    energy: float
    momentum: float
    contact: float
    plastic: float
    brought: float


def audit(impact: Impact, grid: Discretisation, duration: float) -> Audit:
    """Solve the impact three times, and sum. duration in s, made a whole number of time steps."""
    dt = _time_step(impact, grid)
    steps = round(duration / dt)
    duration = dt * steps
    run = simulate(impact, grid, duration=duration, samples=steps + 1)
    mass, gravity = impact.sphere.total_mass, impact.gravity
    earlier, later = _final_velocities(run)
    force = run["contact_force"].values
    impulse = float(np.trapezoid(force, run["time"].values))
    contact = float(np.trapezoid(force, run["indentation"].values))
    plastic, stored = _strain_energies(impact, grid, run)
    fallen = run["sphere_displacement"].values
    start = impact.velocity**2 - (0.5 * gravity * dt) ** 2  # a product, too
    brought = 0.5 * mass * start + mass * gravity * float(fallen.max())
    spent = mass * gravity * float(fallen.max() - fallen[-1])
    kinetic = 0.5 * mass * earlier * later + _kinetic_energy(impact, grid, run, dt)
    pushed = mass * (impact.velocity + gravity * duration)
    return Audit(
        run=run,
        energy=(kinetic + spent + contact + stored + plastic) / brought - 1.0,
        momentum=(0.5 * mass * (earlier + later) + impulse) / pushed - 1.0,
        contact=contact,
        plastic=plastic,
        brought=brought,
    )


def _final_velocities(run: xr.Dataset) -> tuple[float, float]:
    """Return the sphere's velocity in m/s half a step before the end and half a step after."""
    fallen, time = run["sphere_displacement"].values, run["time"].values
    dt = time[-1] - time[-2]
    earlier = float((fallen[-1] - fallen[-2]) / dt)
    force, mass = float(run["contact_force"][-1]), run["sphere_mass"].item()
    return earlier, earlier + float(dt) * (run["gravity"].item() - force / mass)


def _time_step(impact: Impact, grid: Discretisation) -> float:
    """Return the solver's time step in s for durations of many steps, slightly reduced.

    In single precision, so that durations are exact multiples of it: runs that end a step apart
    then take the very same steps, and their difference is free of rounding.
    """
    case = case_table(impact, grid, duration=1.0)[0]
    dt = np.float32(discretise(case, make_pair(case), make_section(case))[0].dt)
    return float(np.nextafter(dt, np.float32(0.0)))


def _kinetic_energy(impact: Impact, grid: Discretisation, run: xr.Dataset, dt: float) -> float:
    """Return the kinetic energy of the beam at the end, in J."""
    end, here = run["duration"].item(), run["deflection"].values
    before, after = (
        simulate(impact, grid, duration=end + shift, samples=2)["deflection"].values
        for shift in (-dt, dt)
    )
    product = (here - before) * (after - here) / dt**2
    return float(0.5 * impact.beam.mass_per_length * np.trapezoid(product, run["x"].values))


def _strain_energies(impact: Impact, grid: Discretisation, run: xr.Dataset) -> tuple[float, float]:
    """Return the (dissipated, stored) energy in J, fibre by fibre."""
    beam, material = impact.beam, impact.beam.material
    _, weights = quadrature.rule(grid.rule, grid.points)
    area = 0.5 * beam.depth * beam.width * weights
    strain, peeq = run["plastic_strain"].values, run["equivalent_plastic_strain"].values
    curvature = _curvature(run["deflection"].values, run["x"].values)
    elastic = -np.multiply.outer(curvature, run["z"].values) - strain
    kept = 0.5 * material.youngs_modulus * elastic**2
    kept += 0.5 * material.kinematic_hardening_modulus * strain**2
    lost = (material.yield_stress + 0.5 * material.isotropic_hardening_modulus * peeq) * peeq
    return _along(lost @ area, run), _along(kept @ area, run)


def _curvature(deflection: Floats, x: Floats) -> Floats:
    curvature = np.zeros_like(deflection)
    curvature[1:-1] = np.diff(deflection, 2) / (x[1] - x[0]) ** 2
    return curvature


def _along(density: Floats, run: xr.Dataset) -> float:
    return float(np.trapezoid(density, run["x"].values))


_CASES = 80
_SEED = 20240607
_ROUNDING = 1e-9
"""Share of the energy brought below which a dissipation counts as zero."""
Case = tuple[Impact, Audit]


def check_balances() -> Finding:
    """Compare each quantity at the worst of all cases."""
    random = np.random.default_rng(_SEED)
    cases = [_solved(random) for _ in range(_CASES)]
    audits = [found for _, found in cases]
    comparisons = [
        _worst(
            "energy in excess, the beam elastic", [a.energy for a in audits if not a.plastic], 1e-7
        ),
        _worst(
            "energy in excess, the beam yielding", [a.energy for a in audits if a.plastic], 2e-3
        ),
        _worst("sphere's momentum in excess", [found.momentum for found in audits], 1e-9),
        _worst("contact dissipation", [_contact(found) for found in audits], 2e-3),
        _worst("plastic dissipation", [_plastic(found) for found in audits], 1e-12),
        _never_negative("plastic_dissipation", audits),
        _never_negative("contact_dissipation", [a for a in audits if not _marked(a)]),
        *_created(cases),
    ]
    return Finding(comparisons, [_excess_panel(audits), _loop_panel(cases)])


BALANCES = Check(
    "balances",
    "Balances of energy and momentum",
    "Sums over the dataset in impactlab.verification.energy; loops of Stronge's law",
    check_balances,
)


def drawn(random: np.random.Generator) -> dict[str, Value]:
    """Draw the values of a case: half of them soft, so that the beam yields."""
    soft = bool(random.random() < 0.5)

    def modulus() -> float:
        return float(random.choice([0.0, random.uniform(0.0, 20e9)]))

    return {
        "velocity": float(
            10.0 ** (random.uniform(0.0, 1.4) if soft else random.uniform(-2.3, -0.7))
        ),
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
        "nodes": int(2 * random.integers(20, 51) + 1),
        "points": int(random.integers(2, 16)),
        "rule": str(random.choice(RULES)),
        "courant": float(random.uniform(0.3, 0.9)),
    }


def _solved(random: np.random.Generator) -> Case:
    impact, grid = with_values(paper_impact(), Discretisation(), drawn(random))
    return impact, audit(impact, grid, float(random.uniform(1e-3, 5e-3)))


def _worst(quantity: str, errors: list[float], tolerance: float) -> Comparison:
    worst = float(np.max(np.abs(errors)))
    return absolute(
        quantity,
        f"worst of {len(errors)} drawn cases, over what is brought",
        "1",
        worst,
        0,
        tolerance,
    )


def _contact(found: Audit) -> float:
    """Return the stored dissipation less the loop's area; zero if the contact has not ended."""
    lost = found.run["contact_dissipation"].item()
    return 0.0 if math.isnan(lost) else float(lost - found.contact) / found.brought


def _plastic(found: Audit) -> float:
    return float(found.run["plastic_dissipation"].item() - found.plastic) / found.brought


def _marked(found: Audit) -> bool:
    """Return whether the run is marked: its contact law created energy."""
    return bool(found.run["remarks"].item() & WARNINGS["contact_created_energy"][0])


def _never_negative(name: str, audits: list[Audit]) -> Comparison:
    least = float(np.nanmin([found.run[name].item() / found.brought for found in audits]))
    where = f"least of {len(audits)} cases, over what is brought"
    return absolute(name.replace("_", " "), where, "1", min(least, 0.0), 0.0, _ROUNDING)


_IN_CLOSED_FORM = ("hertz", "stronge")
"""Laws whose creation of energy is known in closed form; for others see contact_laws."""


def _created(cases: list[Case]) -> list[Comparison]:
    """Compare the marked runs with those in which Stronge's loop gives back more than it took."""
    ended = [
        case
        for case in cases
        if case[0].contact in _IN_CLOSED_FORM
        and not math.isnan(case[1].run["contact_dissipation"].item())
    ]
    marked = np.array([_marked(found) for _, found in ended])
    known = np.array([_creates(impact, found) for impact, found in ended])
    where = "runs marked; runs whose largest indentation says so by the law's closed form"
    wrong = float(np.sum(marked != known))
    return [
        absolute("contact law created energy", where, "1", marked.sum(), known.sum(), 0.0),
        absolute("contact law created energy", "runs marked wrongly", "1", wrong, 0.0, 0.0),
    ]


def _creates(impact: Impact, found: Audit) -> bool:
    law, deepest = stronge_impact(impact), found.run["maximum_indentation"].item()
    if impact.contact != "stronge" or deepest <= law.yield_indentation:
        return False
    return law.released_work(deepest) > law.loading_work(deepest)


def _excess_panel(audits: list[Audit]) -> Panel:
    def sort(errors: list[float]) -> Floats:
        return np.asarray(np.maximum(np.sort(np.abs(errors)), 1e-12))

    rank = np.arange(1.0, _CASES + 1.0)
    return Panel(
        "In excess at the end, case by case",
        ("cases, the best first", "1"),
        ("share of what is brought", "1"),
        [
            Curve("energy", rank, sort([found.energy for found in audits])),
            Curve("sphere's momentum", rank, sort([found.momentum for found in audits])),
        ],
        log=True,
    )


def _loop_panel(cases: list[Case]) -> Panel:
    """Draw the dissipation over the work of loading, where the law creates energy and beyond."""
    points = []
    for impact, found in cases:
        law, lost = stronge_impact(impact), found.run["contact_dissipation"].item()
        times = found.run["maximum_indentation"].item() / law.yield_indentation
        if impact.contact == "stronge" and 0.2 < times < 8.0 and not math.isnan(lost):
            points.append((times, lost / law.loading_work(times * law.yield_indentation)))
    solver = np.array(sorted(points)).reshape(-1, 2)
    law = stronge_impact(paper_impact())
    x = np.linspace(1.001, 8.0, 200)
    share = [1.0 - law.released_work(d) / law.loading_work(d) for d in x * law.yield_indentation]
    return Panel(
        "Stronge's law creates energy below 2.673 times the yield indentation",
        ("largest indentation over that of first yield", "1"),
        ("contact dissipation over the work of loading", "1"),
        [
            Curve("solver", solver[:, 0], solver[:, 1]),
            Curve("the law's loop", x, np.array(share), independent=True),
        ],
    )
