"""The sphere on a beam too heavy to move, under Stronge's law: restitution and dent."""

from __future__ import annotations

from collections.abc import Sequence

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
    relative,
    worst,
)
from impactlab.verification.solutions.stronge import StrongeImpact, stronge_impact

TITLE = "Restitution of Stronge's law"
SOURCE = (
    "Stronge, Impact Mechanics (2000), section 6.4; unloading after Wang et al.; closed forms in "
    "impactlab.verification.solutions.stronge"
)

DEPTHS = (0.9, 1.2, 1.4, 2.0, 2.673)
"""Deepest indentations over that at first yield: elastic, above 1, at most, above 1, 1 again."""
VELOCITIES = (0.3, 0.99, 3.0, 10.0, 20.0)
"""In m/s; fully plastic from 3 m/s on."""
# a small Courant number: here the contact alone sets the time step
_GRID = Discretisation(nodes=11, points=3, courant=0.005)
TOLERANCE = 2e-5


def check() -> Finding:
    """Peak force, deepest indentation, restitution, dent and dissipation at ten velocities.

    The law itself creates energy while the deepest indentation is 1 to 2.673 times that at first
    yield: restitution above 1 is right there, and the solver has to show it.
    """
    tried = speeds()
    runs = [run(velocity) for velocity in tried]
    table = [_compare(velocity, ours) for velocity, ours in zip(tried, runs, strict=True)]
    restitutions, *others = zip(*table, strict=True)
    return Finding([*restitutions, *map(worst, others)], [_panel(tried, runs)])


def speeds() -> list[float]:
    """Those that reach DEPTHS, and VELOCITIES, in m/s."""
    law, mass = _law()
    works = [law.loading_work(depth * law.yield_indentation) for depth in DEPTHS]
    return [float(np.sqrt(2.0 * work / mass)) for work in works] + list(VELOCITIES)


def run(velocity: float) -> xr.Dataset:
    """The solver at this velocity (m/s), until the sphere has left."""
    impact = rigid_backed(velocity, "stronge")
    duration = 0.3e-3 * (0.99 / velocity) ** 0.2 + 0.1e-3
    return simulate(impact, _GRID, duration=duration, samples=2)


def _law() -> tuple[StrongeImpact, float]:
    """The closed forms, and the sphere's mass (kg)."""
    impact = rigid_backed(1.0, "stronge")
    return stronge_impact(impact), impact.sphere.total_mass


def _compare(velocity: float, ours: xr.Dataset) -> list[Comparison]:
    law, mass = _law()
    deepest, peak = law.maximum_indentation(velocity, mass), law.peak_force(velocity, mass)
    restitution, dent = law.restitution(velocity, mass), law.residual_indentation(deepest)
    where = f"{velocity:.3g} m/s, indentation of {deepest / law.yield_indentation:.3g} delta_y"
    depth, left = ours.maximum_indentation.item(), ours.permanent_indentation.item()
    lost = ours.contact_dissipation.item() / (0.5 * mass * velocity**2)
    # the dent in units of the deepest indentation, because it passes through zero
    return [
        absolute("restitution", where, "1", ours.restitution.item(), restitution, TOLERANCE),
        relative("peak force", where, "N", ours.peak_force.item(), peak, TOLERANCE),
        relative("largest indentation", where, "m", depth, deepest, TOLERANCE),
        absolute("dent over indentation", where, "1", left / deepest, dent / deepest, TOLERANCE),
        absolute("share of energy lost", where, "1", lost, 1.0 - restitution**2, TOLERANCE),
    ]


def _panel(velocities: Sequence[float], runs: Sequence[xr.Dataset]) -> Panel:
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
