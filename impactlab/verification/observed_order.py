"""Second order in time alone and in space alone, elastic and while the beam yields."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.verification.cases import (
    critical_time_step,
    elastic,
    simulate_in_steps,
    with_beam_material,
)
from impactlab.verification.finding import (
    Check,
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    rms_error,
)

ORDER, TOLERANCE = 2.0, 0.2
NODES = (101, 201, 401, 801)
HALVINGS = (1, 2, 4, 8, 16, 32)
"""Divisors of the time step at a Courant number of 0.8. The order is that of the last four: before,
the grid's fastest modes, of omega = 2/dt at Courant number 1, are not yet in phase (their error is
omega^3 dt^2/24 times the duration)."""
IN_STEPS = "steps over those at a Courant number of 0.8"
_SAMPLES = 301


@dataclass(frozen=True)
class Case:
    """An impact, its points over the depth, and duration (s); answers: those of ANSWERS tried."""

    impact: Impact
    points: int
    duration: float
    answers: Sequence[str]


def end_of_hertz_contact(run: xr.Dataset) -> float:
    """Return the time in s at which the indentation is zero again, by a cubic spline.

    The response contact_duration interpolates linearly within the step: of second order, too, but
    with a factor that depends on where in the step the contact ends.
    """
    roots = CubicSpline(run.time.values, run.indentation.values).roots(extrapolate=False)
    return float(roots[roots > 0.5 * run.time.values[1]][0])


def _distance(name: str) -> Callable[[xr.Dataset, xr.Dataset], float]:
    def distance(one: xr.Dataset, other: xr.Dataset) -> float:
        return rms_error(one[name].values, other[name].values)

    return distance


def _difference(
    answer: Callable[[xr.Dataset], float],
) -> Callable[[xr.Dataset, xr.Dataset], float]:
    return lambda one, other: abs(answer(one) / answer(other) - 1.0)


ANSWERS: dict[str, Callable[[xr.Dataset, xr.Dataset], float]] = {
    "history of contact force": _distance("contact_force"),
    "history of mid-span deflection": _distance("midspan_deflection"),
    "history of indentation": _distance("indentation"),
    "peak force": _difference(lambda run: float(run.peak_force)),
    "end of contact by spline": _difference(end_of_hertz_contact),
    "contact duration": _difference(lambda run: float(run.contact_duration)),
    "plastic dissipation": _difference(lambda run: float(run.plastic_dissipation)),
}
"""Difference of two runs by answer; histories by the root mean square over the largest value."""
_LOADING = tuple(ANSWERS)[:4]


def hardening(velocity: float) -> Impact:
    """Return the paper's case at `velocity` (m/s), on a beam that hardens with 20 GPa."""
    return with_beam_material(paper_impact(velocity), isotropic_hardening_modulus=20e9)


CASES_IN_TIME = {
    "elastic, Hertz, 0.99 m/s": Case(
        elastic(paper_impact(0.99)), 3, 0.4e-3, (*_LOADING, "end of contact by spline")
    ),
    "yielding, Stronge, 20 m/s": Case(hardening(20.0), 64, 0.12e-3, _LOADING),
}
"""At 101 nodes. The yielding case ends before sections unload and yield again, each at some point
within a step. Left out, because the grid's fastest modes weigh most in them: the mid-span curvature
and what follows from it, the plastic strain."""
CASES_IN_SPACE = {
    "elastic, Hertz, 0.99 m/s": Case(
        elastic(paper_impact(0.99)), 3, 0.4e-3, (*_LOADING, "contact duration")
    ),
    "yielding, Stronge, 12 m/s": Case(
        hardening(12.0), 64, 0.2e-3, (*_LOADING, "contact duration", "plastic dissipation")
    ),
}
"""All with the same number of time steps. The points are many, because each fibre that yields bends
M(kappa)."""


def check_observed_order() -> Finding:
    """Compare the orders in which the differences between successive runs fall with theory.

    The peak plastic strain is left out in space, too: it need not converge.
    """
    found: list[Comparison] = []
    panels: list[Panel] = []
    for where, case in CASES_IN_TIME.items():
        runs = in_time(case)
        found += [_order(name, f"time alone: {where}", runs[-4:], 2) for name in case.answers]
        panels.append(_panel(f"time alone: {where}", case, runs, IN_STEPS, HALVINGS))
    for where, case in CASES_IN_SPACE.items():
        runs = in_space(case)
        found += [_order(name, f"space alone: {where}", runs[-3:], 1) for name in case.answers]
        panels.append(_panel(f"space alone: {where}", case, runs, "nodes", NODES))
    return Finding(found, panels)


OBSERVED_ORDER = Check(
    "observed_order",
    "Order of convergence in time and in space",
    "Theory: central differences in space and time are of second order (Hairer, Lubich, Wanner, "
    "Geometric Numerical Integration, 2006, section I.1.4)",
    check_observed_order,
)


def in_time(case: Case) -> list[xr.Dataset]:
    """Solve with 101 nodes and successively shorter steps, sampled at the longest ones."""
    grid = Discretisation(nodes=101, points=case.points)
    longest = 0.8 * critical_time_step(case.impact, grid)
    least = math.ceil(case.duration / longest)
    return [
        simulate_in_steps(
            case.impact, grid, duration=case.duration, steps=least * times, samples=least + 1
        )
        for times in HALVINGS
    ]


def in_space(case: Case) -> list[xr.Dataset]:
    """Solve with successively more nodes, all with the time steps of the finest grid."""
    grids = [Discretisation(nodes=nodes, points=case.points) for nodes in NODES]
    largest = grids[-1].courant * critical_time_step(case.impact, grids[-1])
    # A multiple of the number of samples less one, so that each sample falls on a step.
    steps = math.ceil(case.duration / largest / (_SAMPLES - 1)) * (_SAMPLES - 1)
    return [
        simulate_in_steps(case.impact, grid, duration=case.duration, steps=steps, samples=_SAMPLES)
        for grid in grids
    ]


def _order(name: str, where: str, runs: Sequence[xr.Dataset], doublings: int) -> Comparison:
    """Compare the order from the first to the last difference, over `doublings` doublings."""
    apart = _apart(name, runs)
    observed = float(np.log2(apart[0] / apart[-1])) / doublings
    return absolute(name, where, "1", observed, ORDER, TOLERANCE)


def _apart(name: str, runs: Sequence[xr.Dataset]) -> list[float]:
    return [ANSWERS[name](one, other) for one, other in pairwise(runs)]


def _panel(
    title: str, case: Case, runs: Sequence[xr.Dataset], x: str, values: Sequence[int]
) -> Panel:
    fineness = np.array(values[:-1], dtype=np.float64)
    curves = [Curve(name, fineness, np.array(_apart(name, runs))) for name in case.answers]
    slope = curves[0].y[0] * (fineness[0] / fineness) ** ORDER
    return Panel(
        title,
        (x, "1"),
        ("difference from the next finer run", "1"),
        [*curves, Curve("second order", fineness, slope, independent=True)],
        log=True,
    )
