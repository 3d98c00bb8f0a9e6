"""Second order in time alone and in space alone, elastic and while the beam yields."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import simulate
from impactlab.types import Floats
from impactlab.verification.cases import discretised, elastic, with_beam_material
from impactlab.verification.finding import (
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    check,
    rms_error,
)

NODES = (101, 201, 401, 801)
HALVINGS = (1, 2, 4, 8, 16, 32)
"""Divisors of the time step at a Courant number of 0.8. The order is that of the last four: before,
the grid's fastest modes, of omega = 2/dt at Courant number 1, are not yet in phase (their error is
omega^3 dt^2/24 times the duration)."""
_SAMPLES = 301

_SPLINE = "end of contact by spline"
ANSWERS = {
    "history of contact force": "contact_force",
    "history of mid-span deflection": "midspan_deflection",
    "history of indentation": "indentation",
    "peak force": "peak_force",
    _SPLINE: "indentation",
    "contact duration": "contact_duration",
    "plastic dissipation": "plastic_dissipation",
}
"""Variable of each answer. The time at which the indentation is zero again is that of a cubic
spline: contact_duration interpolates linearly within the step, which is of second order, too, but
with a factor that depends on where in the step the contact ends."""
_LOADING = tuple(ANSWERS)[:4]


@dataclass(frozen=True)
class Case:
    """An impact, its points over the depth, and duration (s); answers: those of ANSWERS tried."""

    impact: Impact
    points: int
    duration: float
    answers: Sequence[str]

    def run(self, grid: Discretisation, steps: int, samples: int) -> xr.Dataset:
        """Simulate in `steps` time steps, whatever the grid's Courant number."""
        # Half a step of margin, because the kernels round up.
        courant = self.duration / ((steps - 0.5) * self.critical_step(grid))
        chosen = replace(grid, courant=courant)
        return simulate(self.impact, chosen, duration=self.duration, samples=samples)

    def critical_step(self, grid: Discretisation) -> float:
        """Return the scheme's largest time step in s, from the number of steps in a second."""
        return 1.0 / discretised(self.impact, replace(grid, courant=1.0), 1.0)[1]


def _hardening(velocity: float) -> Impact:
    """Return the paper's case at `velocity` (m/s), on a beam that hardens with 20 GPa."""
    return with_beam_material(paper_impact(velocity), isotropic_hardening_modulus=20e9)


CASES_IN_TIME = {
    "elastic, Hertz, 0.99 m/s": Case(elastic(paper_impact(0.99)), 3, 0.4e-3, (*_LOADING, _SPLINE)),
    "yielding, Stronge, 20 m/s": Case(_hardening(20.0), 64, 0.12e-3, _LOADING),
}
"""At 101 nodes. The yielding case ends before sections unload and yield again, each at some point
within a step. Left out, because the grid's fastest modes weigh most in them: the mid-span curvature
and what follows from it, the plastic strain."""
CASES_IN_SPACE = {
    "elastic, Hertz, 0.99 m/s": Case(
        elastic(paper_impact(0.99)), 3, 0.4e-3, (*_LOADING, "contact duration")
    ),
    "yielding, Stronge, 12 m/s": Case(
        _hardening(12.0), 64, 0.2e-3, (*_LOADING, "contact duration", "plastic dissipation")
    ),
}
"""All with the same number of time steps. The points are many, because each fibre that yields bends
M(kappa). The peak plastic strain is left out here, too: it need not converge."""


@check(
    "Order of convergence in time and in space",
    "Theory: central differences in space and time are of second order (Hairer, Lubich, Wanner, "
    "Geometric Numerical Integration, 2006, section I.1.4)",
)
def observed_order() -> Finding:
    """Compare the orders in which the differences between successive runs fall with theory."""
    found: list[Comparison] = []
    panels: list[Panel] = []
    for name, case in CASES_IN_TIME.items():
        # Successively shorter steps, sampled at the longest ones.
        where, grid = f"time alone: {name}", Discretisation(nodes=101, points=case.points)
        least = math.ceil(case.duration / (0.8 * case.critical_step(grid)))
        runs = [case.run(grid, least * times, least + 1) for times in HALVINGS]
        found += _orders(where, case, runs[-4:], 2)
        axis = "steps over those at a Courant number of 0.8"
        panels.append(_panel(where, case, runs, axis, HALVINGS))
    for name, case in CASES_IN_SPACE.items():
        # All grids with the finest one's steps, so many that each sample falls on a step.
        where = f"space alone: {name}"
        grids = [Discretisation(nodes=nodes, points=case.points) for nodes in NODES]
        largest = grids[-1].courant * case.critical_step(grids[-1])
        steps = math.ceil(case.duration / largest / (_SAMPLES - 1)) * (_SAMPLES - 1)
        runs = [case.run(grid, steps, _SAMPLES) for grid in grids]
        found += _orders(where, case, runs[-3:], 1)
        panels.append(_panel(where, case, runs, "nodes", NODES))
    return Finding(found, panels)


def _orders(where: str, case: Case, runs: Sequence[xr.Dataset], doublings: int) -> list[Comparison]:
    """Compare the orders from the first to the last difference, over `doublings` doublings."""
    found = []
    for name in case.answers:
        apart = _apart(name, runs)
        observed = float(np.log2(apart[0] / apart[-1])) / doublings
        found.append(absolute(name, where, "1", observed, 2.0, 0.2))
    return found


def _apart(name: str, runs: Sequence[xr.Dataset]) -> Floats:
    """Return how far an answer of each run is from the next run's, relatively.

    Of histories the root mean square over the largest value.
    """
    if name.startswith("history"):
        histories = [run[ANSWERS[name]].values for run in runs]
        return np.array([rms_error(one, other) for one, other in pairwise(histories)])
    read = _end_of_contact if name == _SPLINE else lambda run: float(run[ANSWERS[name]])
    numbers = [read(run) for run in runs]
    return np.array([abs(one / other - 1.0) for one, other in pairwise(numbers)])


def _end_of_contact(run: xr.Dataset) -> float:
    roots = CubicSpline(run.time.values, run.indentation.values).roots(extrapolate=False)
    return float(roots[roots > 0.5 * run.time.values[1]][0])


def _panel(
    title: str, case: Case, runs: Sequence[xr.Dataset], x: str, values: Sequence[int]
) -> Panel:
    fineness = np.array(values[:-1], dtype=np.float64)
    curves = [Curve(name, fineness, _apart(name, runs)) for name in case.answers]
    slope = curves[0].y[0] * (fineness[0] / fineness) ** 2.0
    curves.append(Curve("second order", fineness, slope, independent=True))
    return Panel(title, (x, "1"), ("difference from the next finer run", "1"), curves, log=True)
