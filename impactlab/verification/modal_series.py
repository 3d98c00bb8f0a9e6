"""The elastic beam under Hertz contact against the modal series of its theory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import simulate
from impactlab.types import Floats
from impactlab.verification.cases import Case, aluminium_impact, elastic, timoshenko_impact
from impactlab.verification.finding import (
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    check,
    curve,
    relative,
    responses,
    rms_error,
    worst,
)
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.modal import ModalSolution, solve, solve_timoshenko

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


def _finding(
    title: str,
    cases: Mapping[str, Case],
    solve: Callable[[Impact, float], ModalSolution],
    rivals: Mapping[str, ModalSolution],
) -> Finding:
    """Compare histories at 201 nodes, at 801 nodes, and the order in which their errors fall.

    Each comparison is that of the worst velocity. The order is that of the root mean square
    over time. The largest error of the curvature falls as dx^2 log(1/dx): the kink that first touch
    leaves in it is spread by dispersion, and gathers in part at mid-span, at simple fractions
    of pi/(4 omega_1) (Talbot's effect); there the error has no smooth expansion in dx.

    The panels show the paper's beam at 0.99 m/s; rivals: more curves in them.
    """
    found: list[Comparison] = []
    panels: list[Panel] = []
    for beam, case in cases.items():
        table = []
        for velocity in case.velocities:
            impact = replace(case.impact, velocity=velocity)
            runs = {nodes: _run(impact, nodes, case.duration) for nodes in NODES}
            series = solve(impact, case.duration)
            table.append(_compare(f"{beam}, {velocity:g} m/s", runs, series))
            if (beam, velocity) == ("the paper's beam", 0.99):
                panels = _panels(title, runs, series, rivals)
        found += map(worst, zip(*table, strict=True))
    return Finding(found, panels)


def _run(impact: Impact, nodes: int, duration: float) -> xr.Dataset:
    grid = Discretisation(nodes=nodes, points=3)  # 3 points are exact while elastic
    return simulate(impact, grid, duration=duration, samples=401)


def _compare(where: str, runs: Mapping[int, xr.Dataset], series: ModalSolution) -> list[Comparison]:
    """Compare one impact: histories and responses at 201 nodes, histories at 801, orders."""
    expected = {"peak_force": series.peak_force, "contact_duration": series.contact_duration}
    found = [
        *histories(where, runs[MIDDLE], series),
        *responses(runs[MIDDLE], f"{where}, {MIDDLE} nodes", expected, 1e-3),
        *histories(where, runs[FINEST], series),
    ]
    for name, (quantity, _, _) in HISTORIES.items():
        coarse, fine = (error(name, series, runs[nodes]) for nodes in NODES[-2:])
        label, observed = f"order of convergence of {quantity}", float(np.log2(coarse / fine))
        found.append(absolute(label, where, "1", observed, 2.0, 0.2))
    return found


def histories(
    where: str, run: xr.Dataset, series: ModalSolution, like: int = 0
) -> list[Comparison]:
    """Compare the histories of a run; tolerances are for its number of nodes, or for `like`."""
    nodes, time = run.nodes.item(), run.time.values
    return [
        curve(
            f"history of {quantity}",
            f"{where}, {nodes} nodes",
            units,
            run[name].values,
            series.at(name, time),
            tolerance * (MIDDLE / (like or nodes)) ** 2.0,
        )
        for name, (quantity, units, tolerance) in HISTORIES.items()
    ]


def error(name: str, series: ModalSolution, run: xr.Dataset) -> float:
    """Return the root mean square of a history's error over its largest value."""
    return rms_error(run[name].values, series.at(name, run.time.values))


def _panels(
    title: str,
    runs: Mapping[int, xr.Dataset],
    series: ModalSolution,
    rivals: Mapping[str, ModalSolution],
) -> list[Panel]:
    """Draw the histories, and how their errors fall."""
    panels, time = [], runs[MIDDLE].time.values
    for name, (quantity, units, _) in HISTORIES.items():
        curves = [Curve(f"{MIDDLE} nodes", time, runs[MIDDLE][name].values)]
        for label, other in {"modal series": series, **rivals}.items():
            curves.append(Curve(label, time, other.at(name, time), independent=True))
        panels.append(Panel(title, ("time", "s"), (quantity, units), curves))
    nodes = np.array(NODES, dtype=np.float64)
    errors = [
        Curve(label, nodes, np.array([error(name, series, runs[n]) for n in NODES]))
        for name, (label, _, _) in HISTORIES.items()
    ]
    slope = Curve("second order", nodes, errors[0].y[0] * (nodes[0] / nodes) ** 2.0, True)
    axes = ("nodes", "1"), ("error (root mean square over the largest value)", "1")
    return [*panels, Panel(title, *axes, [*errors, slope], log=True)]


BERNOULLI_CASES = {
    "the paper's beam": Case(elastic(paper_impact(0.99)), (0.1, 0.99, 2.0, 5.0), 0.4e-3),
    "Timoshenko's beam": Case(elastic(timoshenko_impact()), (0.01, 0.1, 1.0, 5.0), 0.3e-3),
    "a beam of aluminium": Case(elastic(aluminium_impact()), (0.05, 0.1, 0.3, 0.8), 0.4e-3),
}


@check(
    "Elastic beam: modal series",
    "Timoshenko, Z. Math. Phys. 62 (1913) 198; Goldsmith, Impact (1960); series in "
    "impactlab.verification.solutions.modal",
)
def modal_series() -> Finding:
    """Compare the beam of Euler and Bernoulli."""
    return _finding("the paper's beam, 0.99 m/s", BERNOULLI_CASES, solve, {})


def _sheared(impact: Impact, span: float = 1.0) -> Impact:
    """Return `impact` on an elastic Timoshenko beam of that share of the span."""
    beam = replace(impact.beam, span=span * impact.beam.span)
    return replace(elastic(replace(impact, beam=beam)), beam_model="timoshenko")


TIMOSHENKO_CASES = {
    "the paper's beam": Case(_sheared(paper_impact(0.99)), (0.1, 0.99, 5.0), 0.4e-3),
    "Timoshenko's example": Case(_sheared(timoshenko_impact()), (0.01, 1.0, 5.0), 0.3e-3),
    "a beam of aluminium": Case(_sheared(aluminium_impact()), (0.05, 0.3), 0.4e-3),
    "a stubby beam": Case(_sheared(paper_impact(), 0.25), (0.1, 1.0, 5.0), 1.5e-3),
}
"""The stubby beam's shear is 6 % of its static deflection."""


def solve_sheared(impact: Impact, duration: float) -> ModalSolution:
    """Solve the series with half its default step: stubby beams converge fast."""
    step = hertz.contact_duration(*hertz.arguments(impact)) / 2000.0
    return solve_timoshenko(impact, duration, step=step)


@check(
    "Elastic Timoshenko beam: modal series",
    "Timoshenko, Phil. Mag. 43 (1922) 125; both spectra of each mode, series in "
    "impactlab.verification.solutions.modal",
)
def timoshenko_beam() -> Finding:
    """Compare the beam with shear and rotary inertia."""
    case = TIMOSHENKO_CASES["the paper's beam"]
    bare = {"modal series without shear": solve(case.impact, case.duration)}
    title = "the paper's beam with shear and rotary inertia, 0.99 m/s"
    return _finding(title, TIMOSHENKO_CASES, solve_sheared, bare)


@check(
    "Sub-impacts",
    "Timoshenko, Z. Math. Phys. 62 (1913) 198, his two spheres; series in "
    "impactlab.verification.solutions.modal",
)
def sub_impacts() -> Finding:
    """Compare number, times and peak force of the contacts, and the time in contact.

    Timoshenko's two spheres at 10 mm/s; the larger one touches three times. His numbers are at
    second hand: see timoshenko_impact.
    """
    small = elastic(timoshenko_impact())
    sphere, beam = replace(small.sphere, radius=0.02), replace(small.beam, span=0.307)
    large = replace(small, sphere=sphere, beam=beam)
    found: list[Comparison] = []
    panels: list[Panel] = []
    for where, impact, duration in (
        ("sphere of 10 mm radius, span of 153.5 mm", small, 1e-3),
        ("sphere of 20 mm radius, span of 307 mm", large, 6e-3),
    ):
        series = solve(impact, duration)
        grid = Discretisation(nodes=801, points=3)
        run = simulate(impact, grid, duration=duration, samples=4001)
        found += _compare_contacts(where, run, series)
        time = run.time.values
        curves = [
            Curve(f"{grid.nodes} nodes", time, run.contact_force.values),
            Curve("modal series", time, series.at("contact_force", time), independent=True),
        ]
        panels.append(Panel(where, ("time", "s"), ("contact force", "N"), curves))
    return Finding(found, panels)


def _compare_contacts(where: str, run: xr.Dataset, series: ModalSolution) -> list[Comparison]:
    ours = _contacts(run.time.values, run.indentation.values, run.contact_force.values)
    theirs = _contacts(series.time, series.indentation, series.contact_force)
    count, total = run.number_of_contacts.item(), run.total_contact_time.item()
    in_contact = sum(end - begin for begin, end, _ in theirs)
    found = [
        absolute("number of contacts", where, "1", count, len(theirs), 0.5),
        relative("total time in contact", where, "s", total, in_contact, 1e-4),
    ]
    for number, (one, other) in enumerate(zip(ours, theirs, strict=False), 1):
        place = f"{where}, contact {number}"
        if number > 1:  # the first one begins at 0
            found.append(relative("begin", place, "s", one[0], other[0], 1e-4))
        found.append(relative("end", place, "s", one[1], other[1], 1e-4))
        found.append(relative("peak force", place, "N", one[2], other[2], 1e-3))
    return found


def _contacts(time: Floats, indentation: Floats, force: Floats) -> list[tuple[float, float, float]]:
    """Return begin (s), end (s) and largest force (N) of each contact, between the samples."""
    delta, push = CubicSpline(time, indentation), CubicSpline(time, force)
    roots = delta.roots(extrapolate=False)
    ends = np.append(0.0, roots[roots > 0.5 * time[1]])  # first touch is at 0
    turns = push.derivative().roots(extrapolate=False)
    found = []
    for begin, end in ends.reshape(-1, 2):  # the last one has ended
        peaks = push(turns[(turns > begin) & (turns < end)])
        found.append((float(begin), float(end), float(np.max(peaks))))
    return found
