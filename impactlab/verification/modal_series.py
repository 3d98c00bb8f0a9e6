"""The elastic beam under Hertz contact against the modal series of its theory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import simulate
from impactlab.verification.cases import Case, aluminium_impact, elastic, timoshenko_impact
from impactlab.verification.finding import (
    Check,
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    curve,
    relative,
    rms_error,
    worst,
)
from impactlab.verification.solutions import hertz, modal
from impactlab.verification.solutions.modal import ModalSolution, solve

Solve = Callable[[Impact, float], ModalSolution]
"""Function from an impact and a duration (s) to its modal series."""

HISTORIES = {
    "contact_force": ("contact force", "N", 1e-3),
    "midspan_deflection": ("mid-span deflection", "m", 1e-3),
    "midspan_curvature": ("mid-span curvature", "m-1", 1e-2),
}
"""The compared histories: (name, units, tolerance at 201 nodes).

Under a point load curvature goes with the rate of deflection: it holds ten times as much of the
high frequencies, whose waves the nodes resolve worst.
"""
NODES = (51, 101, 201, 401, 801)
MIDDLE, FINEST = 201, 801
ORDER, ORDER_TOLERANCE = 2.0, 0.2
_SAMPLES = 401


def compare(cases: Mapping[str, Case], solve: Solve) -> list[Comparison]:
    """Compare histories at 201 nodes, at 801 nodes, and the order in which their errors fall.

    Each comparison is that of the worst velocity. The order is that of the root mean square
    over time. The largest error of the curvature falls as dx^2 log(1/dx): the kink that first touch
    leaves in it is spread by dispersion, and gathers in part at mid-span, at simple fractions
    of pi/(4 omega_1) (Talbot's effect); there the error has no smooth expansion in dx.
    """
    found: list[Comparison] = []
    for beam, case in cases.items():
        table = [_compare(beam, case, velocity, solve) for velocity in case.velocities]
        found += map(worst, zip(*table, strict=True))
    return found


def _compare(beam: str, case: Case, velocity: float, solve: Solve) -> list[Comparison]:
    """Compare one impact: histories and responses at 201 nodes, histories at 801, orders."""
    impact = replace(case.impact, velocity=velocity)
    series = solve(impact, case.duration)
    runs = {nodes: run(impact, nodes, case.duration) for nodes in NODES}
    where = f"{beam}, {velocity:g} m/s"
    return [
        *(_history(name, where, series, runs[MIDDLE], MIDDLE) for name in HISTORIES),
        *_responses(where, series, runs[MIDDLE]),
        *(_history(name, where, series, runs[FINEST], FINEST) for name in HISTORIES),
        *(_order(name, where, series, runs) for name in HISTORIES),
    ]


def run(impact: Impact, nodes: int, duration: float) -> xr.Dataset:
    """Solve the impact on `nodes` nodes."""
    grid = Discretisation(nodes=nodes, points=3)  # 3 points are exact while elastic
    return simulate(impact, grid, duration=duration, samples=_SAMPLES)


def _history(
    name: str, where: str, series: ModalSolution, ours: xr.Dataset, nodes: int
) -> Comparison:
    quantity, units, tolerance = HISTORIES[name]
    tolerance *= (MIDDLE / nodes) ** ORDER
    expected = series.at(name, ours.time.values)
    place = f"{where}, {nodes} nodes"
    return curve(f"history of {quantity}", place, units, ours[name].values, expected, tolerance)


def _responses(where: str, series: ModalSolution, ours: xr.Dataset) -> list[Comparison]:
    place = f"{where}, {MIDDLE} nodes"
    return [
        relative(name.replace("_", " "), place, units, ours[name].item(), expected, 1e-3)
        for name, units, expected in (
            ("peak_force", "N", series.peak_force),
            ("contact_duration", "s", series.contact_duration),
        )
    ]


def _order(
    name: str, where: str, series: ModalSolution, runs: Mapping[int, xr.Dataset]
) -> Comparison:
    coarse, fine = (error(name, series, runs[nodes]) for nodes in NODES[-2:])
    observed = float(np.log2(coarse / fine))
    quantity = f"order of convergence of {HISTORIES[name][0]}"
    return absolute(quantity, where, "1", observed, ORDER, ORDER_TOLERANCE)


def error(name: str, series: ModalSolution, ours: xr.Dataset) -> float:
    """Return the root mean square of a history's error over its largest value."""
    return rms_error(ours[name].values, series.at(name, ours.time.values))


def panels(
    title: str,
    impact: Impact,
    duration: float,
    solve: Solve,
    rivals: Mapping[str, ModalSolution] | None = None,
) -> list[Panel]:
    """Draw histories over `duration` (s), and how their errors fall; rivals: more curves."""
    series = solve(impact, duration)
    runs = {nodes: run(impact, nodes, duration) for nodes in NODES}
    both = [
        _both(name, title, runs[MIDDLE], {"modal series": series, **(rivals or {})})
        for name in HISTORIES
    ]
    nodes = np.array(NODES, dtype=np.float64)
    errors = [
        Curve(label, nodes, np.array([error(name, series, runs[n]) for n in NODES]))
        for name, (label, _, _) in HISTORIES.items()
    ]
    slope = Curve("second order", nodes, errors[0].y[0] * (nodes[0] / nodes) ** ORDER, True)
    axes = ("nodes", "1"), ("error (root mean square over the largest value)", "1")
    return [*both, Panel(title, *axes, [*errors, slope], log=True)]


def _both(
    name: str, title: str, ours: xr.Dataset, independent: Mapping[str, ModalSolution]
) -> Panel:
    quantity, units, _ = HISTORIES[name]
    time = ours.time.values
    others = [
        Curve(label, time, series.at(name, time), independent=True)
        for label, series in independent.items()
    ]
    return Panel(
        title,
        ("time", "s"),
        (quantity, units),
        [Curve(f"{MIDDLE} nodes", time, ours[name].values), *others],
    )


BERNOULLI_CASES = {
    "the paper's beam": Case(elastic(paper_impact()), (0.1, 0.99, 2.0, 5.0), 0.4e-3),
    "Timoshenko's beam": Case(elastic(timoshenko_impact()), (0.01, 0.1, 1.0, 5.0), 0.3e-3),
    "a beam of aluminium": Case(elastic(aluminium_impact()), (0.05, 0.1, 0.3, 0.8), 0.4e-3),
}


def check_modal_series() -> Finding:
    """Compare histories at 201 nodes, at 801 nodes, and the order in which their errors fall."""
    case, velocity = BERNOULLI_CASES["the paper's beam"], 0.99
    impact = replace(case.impact, velocity=velocity)
    title = f"the paper's beam, {velocity:g} m/s"
    return Finding(compare(BERNOULLI_CASES, solve), panels(title, impact, case.duration, solve))


MODAL_SERIES = Check(
    "modal_series",
    "Elastic beam: modal series",
    "Timoshenko, Z. Math. Phys. 62 (1913) 198; Goldsmith, Impact (1960); series in "
    "impactlab.verification.solutions.modal",
    check_modal_series,
)


def _sheared(impact: Impact) -> Impact:
    return replace(elastic(impact), beam_model="timoshenko")


def _stubby() -> Impact:
    """Return the paper's sphere on a fourth of its span: shear is 6 % of the static deflection."""
    impact = paper_impact()
    return replace(impact, beam=replace(impact.beam, span=0.25 * impact.beam.span))


TIMOSHENKO_CASES = {
    "the paper's beam": Case(_sheared(paper_impact()), (0.1, 0.99, 5.0), 0.4e-3),
    "Timoshenko's example": Case(_sheared(timoshenko_impact()), (0.01, 1.0, 5.0), 0.3e-3),
    "a beam of aluminium": Case(_sheared(aluminium_impact()), (0.05, 0.3), 0.4e-3),
    "a stubby beam": Case(_sheared(_stubby()), (0.1, 1.0, 5.0), 1.5e-3),
}


def solve_sheared(impact: Impact, duration: float) -> ModalSolution:
    """Solve the series with half its default step: stubby beams converge fast."""
    step = hertz.contact_duration(*hertz.arguments(impact)) / 2000.0
    return modal.solve_timoshenko(impact, duration, step=step)


def check_timoshenko_beam() -> Finding:
    """Compare histories at 201 nodes, at 801 nodes, and the order in which their errors fall."""
    case, velocity = TIMOSHENKO_CASES["the paper's beam"], 0.99
    impact = replace(case.impact, velocity=velocity)
    title = f"the paper's beam with shear and rotary inertia, {velocity:g} m/s"
    bare = {"modal series without shear": modal.solve(impact, case.duration)}
    return Finding(
        compare(TIMOSHENKO_CASES, solve_sheared),
        panels(title, impact, case.duration, solve_sheared, bare),
    )


TIMOSHENKO_BEAM = Check(
    "timoshenko_beam",
    "Elastic Timoshenko beam: modal series",
    "Timoshenko, Phil. Mag. 43 (1922) 125; both spectra of each mode, series in "
    "impactlab.verification.solutions.modal",
    check_timoshenko_beam,
)
