"""Contact laws on a beam too heavy to move: Hertz's, Stronge's and all others."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.simulate import simulate
from impactlab.verification.cases import rigid_backed
from impactlab.verification.finding import (
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    check,
    relative,
    worst,
)
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.contact_laws import LAWS, LawOnHalfSpace, law_on_half_space
from impactlab.verification.solutions.stronge import StrongeImpact, stronge_impact

# With so small a Courant number the contact alone determines the time step.
_GRID = Discretisation(nodes=11, points=3, courant=0.005)
_VELOCITY, _RESTITUTION = ("velocity", "m s-1"), ("coefficient of restitution", "1")


@check(
    "Impact on a half-space",
    "Hertz 1881; closed forms in impactlab.verification.solutions.hertz",
)
def half_space() -> Finding:
    """Compare peak force, largest indentation, contact duration and restitution."""
    impact = rigid_backed(0.99, "hertz")
    args = hertz.arguments(impact)
    run = simulate(impact, _GRID, duration=0.4e-3)
    where = "the paper's sphere at 0.99 m/s"
    found = []
    for quantity, units, ours, expected in (
        ("peak force", "N", run.peak_force, hertz.peak_force(*args)),
        ("contact duration", "s", run.contact_duration, hertz.contact_duration(*args)),
        ("largest indentation", "m", run.maximum_indentation, hertz.maximum_indentation(*args)),
        ("restitution", "1", run.restitution, 1.0),
    ):
        found.append(relative(quantity, where, units, ours.item(), expected, 2e-5))
    return Finding(found)


def _compare(
    where: str,
    velocity: float,
    run: xr.Dataset,
    law: StrongeImpact | LawOnHalfSpace,
    mass: float,
    tolerance: float,
) -> list[Comparison]:
    """Compare restitution, peak force, dent and dissipation of a sphere of `mass` (kg)."""
    deepest, restitution = law.maximum_indentation(velocity, mass), law.restitution(velocity, mass)
    peak, force = run.peak_force.item(), law.loading_force(deepest)
    # The dent passes through zero, hence its error is relative to the largest indentation.
    dent = run.permanent_indentation.item() / deepest
    left = law.residual_indentation(deepest) / deepest
    lost = run.contact_dissipation.item() / (0.5 * mass * velocity**2)
    share = 1.0 - restitution**2
    return [
        absolute("restitution", where, "1", run.restitution.item(), restitution, tolerance),
        relative("peak force", where, "N", peak, force, tolerance),
        absolute("dent over indentation", where, "1", dent, left, tolerance),
        absolute("share of energy lost", where, "1", lost, share, tolerance),
    ]


DEPTHS = (0.9, 1.2, 1.4, 2.0, 2.673)
"""Largest indentation over that at first yield: elastic, restitution above 1 thrice, and 1."""
STRONGE_VELOCITIES = (0.3, 0.99, 3.0, 10.0, 20.0)
"""In m/s; fully plastic from 3 m/s on."""
STRONGE_TOLERANCE = 2e-5


@check(
    "Restitution of Stronge's law",
    "Stronge, Impact Mechanics (2000), section 6.4; unloading after Wang et al.; closed forms in "
    "impactlab.verification.solutions.stronge",
)
def stronge_restitution() -> Finding:
    """Compare peak force, indentation, restitution, dent and dissipation at ten velocities.

    The law itself creates energy while the largest indentation is 1 to 2.673 times that at first
    yield. A restitution above 1 is correct there, and the solver has to show it.
    """
    impact = rigid_backed(1.0, "stronge")
    law, mass = stronge_impact(impact), impact.sphere.total_mass
    works = [law.loading_work(depth * law.yield_indentation) for depth in DEPTHS]
    velocities = [float(np.sqrt(2.0 * work / mass)) for work in works] + list(STRONGE_VELOCITIES)
    table, ours = [], []
    for velocity in velocities:
        duration = 0.3e-3 * (0.99 / velocity) ** 0.2 + 0.1e-3  # until the sphere has left
        run = simulate(rigid_backed(velocity, "stronge"), _GRID, duration=duration, samples=2)
        ours.append(run.restitution.item())
        depth, expected = run.maximum_indentation.item(), law.maximum_indentation(velocity, mass)
        times = expected / law.yield_indentation
        where = f"{velocity:.3g} m/s, indentation of {times:.3g} delta_y"
        found = _compare(where, velocity, run, law, mass, STRONGE_TOLERANCE)
        indentation = relative(
            "largest indentation", where, "m", depth, expected, STRONGE_TOLERANCE
        )
        table.append([*found[:2], indentation, *found[2:]])
    restitutions, *others = zip(*table, strict=True)
    fine = np.geomspace(1e-3, 20.0, 301)
    closed = np.array([law.restitution(float(v), mass) for v in fine])
    curves = [
        Curve("solver", np.array(velocities), np.array(ours)),
        Curve("closed form", fine, closed, independent=True),
    ]
    title = "the paper's sphere on a half-space"
    panel = Panel(title, _VELOCITY, _RESTITUTION, curves, log=True)
    return Finding([*restitutions, *map(worst, others)], [panel])


VELOCITIES = (0.012, 0.03, 0.1, 0.3, 0.99, 3.0, 10.0)
"""In m/s, from just above the first yield of all laws but Hertz's."""
DRAWN = 0.99
"""Velocity in m/s of the curves of force against indentation."""
TOLERANCE = 1e-4
"""Larger than for smooth laws, because a jump of the force falls within a time step."""
_QUADRATURE = "quadrature of the law"


@check(
    "All contact laws on a half-space",
    "each law from its formulas, integrated by adaptive quadrature: "
    "impactlab.verification.solutions.contact_laws, which names the papers",
)
def contact_laws() -> Finding:
    """Compare restitution, peak force, dent and dissipation of each law at its worst velocity.

    Laws that create energy do so here, too: a restitution above 1 must appear in both solutions.
    """
    found: list[Comparison] = []
    forces: list[Curve] = []
    against_velocity: dict[str, list[Curve]] = {"restitution": [], "permanent_indentation": []}
    fine = np.geomspace(VELOCITIES[0], VELOCITIES[-1], 61)
    for name in LAWS:
        impact = rigid_backed(DRAWN, name)
        law, mass = law_on_half_space(impact), impact.sphere.total_mass
        runs, table = {}, []
        for velocity in VELOCITIES:
            # Until the sphere has left: at most Hertz's contact time and that of full plasticity.
            duration = 0.5e-3 * (DRAWN / velocity) ** 0.2 + 0.2e-3
            impact = rigid_backed(velocity, name)
            run = runs[velocity] = simulate(impact, _GRID, duration=duration, samples=401)
            where = f"{name}, {velocity:.3g} m/s"
            table.append(_compare(where, velocity, run, law, mass, TOLERANCE))
        found += map(worst, zip(*table, strict=True))
        forces += _force_curves(runs[DRAWN], law, mass)
        deepest = [law.maximum_indentation(float(v), mass) for v in fine]
        expected = {
            "restitution": [law.restitution(float(v), mass) for v in fine],
            "permanent_indentation": [law.residual_indentation(depth) for depth in deepest],
        }
        for variable, curves in against_velocity.items():
            ours = np.array([run[variable].item() for run in runs.values()])
            curves.append(Curve(name, np.array(VELOCITIES), ours))
            curves.append(Curve(_QUADRATURE, fine, np.array(expected[variable]), independent=True))
    restitutions, dents = against_velocity.values()
    axes = ("indentation", "m"), ("contact force", "N")
    dent = ("permanent indentation", "m")
    panels = [
        Panel(f"force against indentation at {DRAWN} m/s", *axes, forces),
        Panel("restitution against velocity", _VELOCITY, _RESTITUTION, restitutions, log=True),
        Panel("permanent indentation against velocity", _VELOCITY, dent, dents, log=True),
    ]
    return Finding(found, panels)


def _force_curves(run: xr.Dataset, law: LawOnHalfSpace, mass: float) -> list[Curve]:
    touching = run.contact_force.values > 0
    ours = run.indentation.values[touching], run.contact_force.values[touching]
    depth = np.linspace(1e-3, 1.0, 101) * law.maximum_indentation(DRAWN, mass)
    force = np.array([law.loading_force(float(d)) for d in depth])
    return [Curve(law.law, *ours), Curve(_QUADRATURE, depth, force, independent=True)]
