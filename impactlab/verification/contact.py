"""Contact laws on a beam too heavy to move: Hertz's, Stronge's and all others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.simulate import simulate
from impactlab.types import Floats
from impactlab.verification.cases import rigid_backed
from impactlab.verification.finding import (
    Check,
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    relative,
    worst,
)
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.contact_laws import LAWS, LawOnHalfSpace, law_on_half_space
from impactlab.verification.solutions.stronge import StrongeImpact, stronge_impact

# With so small a Courant number the contact alone determines the time step.
_GRID = Discretisation(nodes=11, points=3, courant=0.005)


def check_half_space() -> Finding:
    """Compare peak force, largest indentation, contact duration and restitution."""
    velocity = 0.99
    impact = rigid_backed(velocity, "hertz")
    args = hertz.arguments(impact)
    run = simulate(impact, _GRID, duration=0.4e-3)
    where = f"the paper's sphere at {velocity} m/s"
    return Finding(
        [
            relative(quantity, where, units, run[name].item(), expected(*args), 2e-5)
            for quantity, name, units, expected in (
                ("peak force", "peak_force", "N", hertz.peak_force),
                ("contact duration", "contact_duration", "s", hertz.contact_duration),
                ("largest indentation", "maximum_indentation", "m", hertz.maximum_indentation),
            )
        ]
        + [relative("restitution", where, "1", run.restitution.item(), 1.0, 2e-5)]
    )


HALF_SPACE = Check(
    "half_space",
    "Impact on a half-space",
    "Hertz 1881; closed forms in impactlab.verification.solutions.hertz",
    check_half_space,
)

DEPTHS = (0.9, 1.2, 1.4, 2.0, 2.673)
"""Largest indentation over that at first yield: elastic, restitution above 1 thrice, and 1."""
STRONGE_VELOCITIES = (0.3, 0.99, 3.0, 10.0, 20.0)
"""In m/s; fully plastic from 3 m/s on."""
STRONGE_TOLERANCE = 2e-5


def check_stronge_restitution() -> Finding:
    """Compare peak force, indentation, restitution, dent and dissipation at ten velocities.

    The law itself creates energy while the largest indentation is 1 to 2.673 times that at first
    yield. A restitution above 1 is correct there, and the solver has to show it.
    """
    velocities = _speeds()
    runs = [_run_stronge(velocity) for velocity in velocities]
    table = [
        _compare_stronge(velocity, ours) for velocity, ours in zip(velocities, runs, strict=True)
    ]
    restitutions, *others = zip(*table, strict=True)
    return Finding([*restitutions, *map(worst, others)], [_stronge_panel(velocities, runs)])


STRONGE_RESTITUTION = Check(
    "stronge_restitution",
    "Restitution of Stronge's law",
    "Stronge, Impact Mechanics (2000), section 6.4; unloading after Wang et al.; closed forms in "
    "impactlab.verification.solutions.stronge",
    check_stronge_restitution,
)


def _speeds() -> list[float]:
    """Return the velocities in m/s that reach DEPTHS, and STRONGE_VELOCITIES."""
    law, mass = _law()
    works = [law.loading_work(depth * law.yield_indentation) for depth in DEPTHS]
    return [float(np.sqrt(2.0 * work / mass)) for work in works] + list(STRONGE_VELOCITIES)


def _run_stronge(velocity: float) -> xr.Dataset:
    """Solve the impact at `velocity` (m/s) until the sphere has left."""
    impact = rigid_backed(velocity, "stronge")
    duration = 0.3e-3 * (0.99 / velocity) ** 0.2 + 0.1e-3
    return simulate(impact, _GRID, duration=duration, samples=2)


def _law() -> tuple[StrongeImpact, float]:
    """Return the closed forms, and the mass of the sphere (kg)."""
    impact = rigid_backed(1.0, "stronge")
    return stronge_impact(impact), impact.sphere.total_mass


def _compare_stronge(velocity: float, ours: xr.Dataset) -> list[Comparison]:
    law, mass = _law()
    deepest, peak = law.maximum_indentation(velocity, mass), law.peak_force(velocity, mass)
    restitution, dent = law.restitution(velocity, mass), law.residual_indentation(deepest)
    where = f"{velocity:.3g} m/s, indentation of {deepest / law.yield_indentation:.3g} delta_y"
    depth, left = ours.maximum_indentation.item(), ours.permanent_indentation.item()
    lost = ours.contact_dissipation.item() / (0.5 * mass * velocity**2)
    # The dent passes through zero, hence its error is relative to the largest indentation.
    return [
        absolute(
            "restitution", where, "1", ours.restitution.item(), restitution, STRONGE_TOLERANCE
        ),
        relative("peak force", where, "N", ours.peak_force.item(), peak, STRONGE_TOLERANCE),
        relative("largest indentation", where, "m", depth, deepest, STRONGE_TOLERANCE),
        absolute(
            "dent over indentation", where, "1", left / deepest, dent / deepest, STRONGE_TOLERANCE
        ),
        absolute("share of energy lost", where, "1", lost, 1.0 - restitution**2, STRONGE_TOLERANCE),
    ]


def _stronge_panel(velocities: Sequence[float], runs: Sequence[xr.Dataset]) -> Panel:
    law, mass = _law()
    fine = np.geomspace(1e-3, 20.0, 301)
    return Panel(
        "the paper's sphere on a half-space",
        ("velocity", "m s-1"),
        ("coefficient of restitution", "1"),
        [
            Curve(
                "solver", np.array(velocities), np.array([run.restitution.item() for run in runs])
            ),
            Curve(
                "closed form",
                fine,
                np.array([law.restitution(float(v), mass) for v in fine]),
                independent=True,
            ),
        ],
        log=True,
    )


VELOCITIES = (0.012, 0.03, 0.1, 0.3, 0.99, 3.0, 10.0)
"""In m/s, from just above the first yield of all laws but Hertz's."""
DRAWN = 0.99
"""Velocity in m/s of the curves of force against indentation."""
TOLERANCE = 1e-4
"""Larger than for smooth laws, because a jump of the force falls within a time step."""
_QUADRATURE = "quadrature of the law"


@dataclass(frozen=True)
class SolvedLaw:
    """A law by quadrature, and the solver's runs at VELOCITIES; mass: of the sphere, in kg."""

    law: LawOnHalfSpace
    mass: float
    runs: list[xr.Dataset]


def check_contact_laws() -> Finding:
    """Compare restitution, peak force, dent and dissipation of each law at its worst velocity.

    Laws that create energy do so here, too: a restitution above 1 must appear in both solutions.
    """
    laws = {name: _solve_law(name) for name in LAWS}
    found = [
        worst(
            [
                make(velocity, run, entry)
                for velocity, run in zip(VELOCITIES, entry.runs, strict=True)
            ]
        )
        for entry in laws.values()
        for make in (_compare_restitution, _peak_force, _dent, _lost)
    ]
    return Finding(found, [_forces(laws), _restitutions(laws), _dents(laws)])


CONTACT_LAWS = Check(
    "contact_laws",
    "All contact laws on a half-space",
    "each law from its formulas, integrated by adaptive quadrature: "
    "impactlab.verification.solutions.contact_laws, which names the papers",
    check_contact_laws,
)


def _solve_law(name: str) -> SolvedLaw:
    impact = rigid_backed(DRAWN, name)
    runs = [_run_law(name, velocity) for velocity in VELOCITIES]
    return SolvedLaw(law_on_half_space(impact), impact.sphere.total_mass, runs)


def _run_law(name: str, velocity: float) -> xr.Dataset:
    """Solve until the sphere has left: at most Hertz's contact time and that of full plasticity."""
    duration = 0.5e-3 * (DRAWN / velocity) ** 0.2 + 0.2e-3
    return simulate(rigid_backed(velocity, name), _GRID, duration=duration, samples=401)


def _where(velocity: float, entry: SolvedLaw) -> str:
    return f"{entry.law.law}, {velocity:.3g} m/s"


def _compare_restitution(velocity: float, run: xr.Dataset, entry: SolvedLaw) -> Comparison:
    expected = entry.law.restitution(velocity, entry.mass)
    ours = run.restitution.item()
    return absolute("restitution", _where(velocity, entry), "1", ours, expected, TOLERANCE)


def _peak_force(velocity: float, run: xr.Dataset, entry: SolvedLaw) -> Comparison:
    expected = entry.law.loading_force(entry.law.maximum_indentation(velocity, entry.mass))
    ours = run.peak_force.item()
    return relative("peak force", _where(velocity, entry), "N", ours, expected, TOLERANCE)


def _dent(velocity: float, run: xr.Dataset, entry: SolvedLaw) -> Comparison:
    """Compare the dent over the largest indentation, because it passes through zero."""
    deepest = entry.law.maximum_indentation(velocity, entry.mass)
    expected = entry.law.residual_indentation(deepest) / deepest
    ours = run.permanent_indentation.item() / deepest
    where = _where(velocity, entry)
    return absolute("dent over indentation", where, "1", ours, expected, TOLERANCE)


def _lost(velocity: float, run: xr.Dataset, entry: SolvedLaw) -> Comparison:
    ours = run.contact_dissipation.item() / (0.5 * entry.mass * velocity**2)
    expected = 1.0 - entry.law.restitution(velocity, entry.mass) ** 2
    where = _where(velocity, entry)
    return absolute("share of energy lost", where, "1", ours, expected, TOLERANCE)


def _forces(laws: dict[str, SolvedLaw]) -> Panel:
    curves = []
    for name, entry in laws.items():
        run = entry.runs[VELOCITIES.index(DRAWN)]
        touching = run.contact_force.values > 0
        depth, force = run.indentation.values[touching], run.contact_force.values[touching]
        curves += [Curve(name, depth, force), _loading(entry)]
    title = f"force against indentation at {DRAWN} m/s"
    return Panel(title, ("indentation", "m"), ("contact force", "N"), curves)


def _loading(entry: SolvedLaw) -> Curve:
    deepest = entry.law.maximum_indentation(DRAWN, entry.mass)
    depth = np.linspace(1e-3, 1.0, 101) * deepest
    force = np.array([entry.law.loading_force(float(d)) for d in depth])
    return Curve(_QUADRATURE, depth, force, independent=True)


def _restitutions(laws: dict[str, SolvedLaw]) -> Panel:
    y = ("coefficient of restitution", "1")
    curves = []
    for name, entry in laws.items():
        fine = _fine()
        expected = np.array([entry.law.restitution(float(v), entry.mass) for v in fine])
        ours = np.array([run.restitution.item() for run in entry.runs])
        curves += [_ours(name, ours), Curve(_QUADRATURE, fine, expected, independent=True)]
    return Panel("restitution against velocity", ("velocity", "m s-1"), y, curves, log=True)


def _dents(laws: dict[str, SolvedLaw]) -> Panel:
    y = ("permanent indentation", "m")
    curves = []
    for name, entry in laws.items():
        fine = _fine()
        expected = np.array([_dent_after(float(v), entry) for v in fine])
        ours = np.array([run.permanent_indentation.item() for run in entry.runs])
        curves += [_ours(name, ours), Curve(_QUADRATURE, fine, expected, independent=True)]
    title = "permanent indentation against velocity"
    return Panel(title, ("velocity", "m s-1"), y, curves, log=True)


def _ours(name: str, values: Floats) -> Curve:
    return Curve(name, np.array(VELOCITIES), values)


def _dent_after(velocity: float, entry: SolvedLaw) -> float:
    return entry.law.residual_indentation(entry.law.maximum_indentation(velocity, entry.mass))


def _fine() -> Floats:
    """Return the velocities of the independent curves, in m/s."""
    return np.geomspace(VELOCITIES[0], VELOCITIES[-1], 61)
