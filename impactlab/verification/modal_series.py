"""The elastic beam under Hertz contact against the modal series of its theory."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import xarray as xr
from scipy.interpolate import CubicSpline

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import run_dataset
from impactlab.types import Floats
from impactlab.verification.cases import Sweep, aluminium_impact, elastic, timoshenko_impact
from impactlab.verification.finding import (
    Comparisons,
    Curve,
    CurvePanel,
    Finding,
    Reference,
    check,
    rms_error,
    words,
)
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.beam_modes import odd_modes
from impactlab.verification.solutions.modal import ModalSolution, solve, solve_timoshenko

HISTORIES = {"contact_force": "N", "midspan_deflection": "m", "midspan_curvature": "m-1"}
"""The compared histories, and their units."""

GridKey = tuple[str, int]  # scheme and nodes


@dataclass(frozen=True)
class GridFamily:
    """Numbers of nodes that a scheme is tried with, from coarse to fine.

    tolerances: of each history at `middle` nodes; they fall with the square of the nodes up to the
    last. orders: in dx, of each history; between the numbers of `pair`.
    """

    scheme: str
    nodes: tuple[int, ...]
    middle: int
    tolerances: tuple[float, float, float]
    orders: tuple[float, float, float]
    pair: tuple[int, int]


LEAPFROG = GridFamily(
    "leapfrog", (51, 101, 201, 401, 801), 201, (1e-3, 1e-3, 1e-2), (2.0, 2.0, 2.0), (401, 801)
)
"""Under a point load curvature goes with the rate of deflection: it holds ten times as much of the
high frequencies, whose waves the nodes resolve worst."""
MODAL = GridFamily("modal", (9, 17, 33, 65, 129), 65, (2e-3, 1e-3, 1e-3), (2.0, 2.0, 1.0), (33, 65))
"""It must meet leapfrog's tolerances from a third of the nodes, but twice that of the force, which
its longer steps round off where the contact ends. What is left of its errors is of the second order
of the time step, which goes with dx. The n-th mode bends statically by 1/n^4 under the force: the n
modes solved lack 1/n of the curvature. The share in the curvature has a
closed form, and is added before histories are compared."""


def _finding(
    title: str,
    cases: Mapping[str, Sweep],
    solve: Callable[[Impact, float], ModalSolution],
    rivals: Mapping[str, ModalSolution],
    schemes: Sequence[GridFamily],
) -> Finding:
    """Compare histories on the middle and the finest grid, and the order in which errors fall.

    Each comparison is that of the worst velocity. The order is that of the root mean square
    over time. Leapfrog's largest error of the curvature falls as dx^2 log(1/dx): the kink that
    first touch leaves in it is spread by dispersion, and gathers in part at mid-span, at simple
    fractions of pi/(4 omega_1) (Talbot's effect); there the error has no smooth expansion in dx.

    The panels show the paper's beam at 0.99 m/s; rivals: more curves in them.
    """
    comparisons = Comparisons()
    panels: list[CurvePanel] = []
    for beam, case in cases.items():
        table = []
        for velocity in case.velocities:
            impact = replace(case.impact, velocity=velocity)
            keys = [(scheme.scheme, nodes) for scheme in schemes for nodes in scheme.nodes]
            runs = {key: _run(impact, key, case.duration) for key in keys}
            series, where = solve(impact, case.duration), f"{beam}, {velocity:g} m/s"
            row = (_compare(f"{grids.scheme}: {where}", grids, runs, series) for grids in schemes)
            table.append([*chain.from_iterable(row)])
            if (beam, velocity) == ("the paper's beam", 0.99):
                panels = _panels(title, schemes, runs, {"modal series": series, **rivals})
        comparisons.worst(table)
    return Finding(comparisons, panels)


def _run(impact: Impact, key: GridKey, duration: float) -> xr.Dataset:
    scheme, nodes = key
    # 3 points are exact while elastic
    grid = Discretisation(nodes=nodes, points=3, scheme=scheme)
    return run_dataset(impact, grid, duration=duration, samples=401)


def _compare(
    where: str, grids: GridFamily, runs: Mapping[GridKey, xr.Dataset], series: ModalSolution
) -> Comparisons:
    """Compare one impact: histories on two grids, responses on the middle one, and orders."""
    middle, finest = (runs[grids.scheme, nodes] for nodes in (grids.middle, grids.nodes[-1]))
    expected = {"peak_force": series.peak_force, "contact_duration": series.contact_duration}
    comparisons = _histories(where, grids, middle, series).responses(middle, expected, 1e-3)
    comparisons += _histories(where, grids, finest, series)
    comparisons.at(where)
    pair = [runs[grids.scheme, nodes] for nodes in grids.pair]
    for name, order in zip(HISTORIES, grids.orders, strict=True):
        coarse, fine = (error(name, series, run) for run in pair)
        label, observed = f"order of convergence of {words(name)}", float(np.log2(coarse / fine))
        comparisons.absolute(label, "1", observed, order, 0.2)
    return comparisons


def _histories(
    where: str, grids: GridFamily, run: xr.Dataset, series: ModalSolution
) -> Comparisons:
    nodes, time = run.nodes.item(), run.time.values
    comparisons = Comparisons(f"{where}, {nodes} nodes")
    finer = (grids.middle / nodes) ** 2.0
    for (name, units), limit in zip(HISTORIES.items(), grids.tolerances, strict=True):
        label, ours = f"history of {words(name)}", run[name].values
        if grids is MODAL and name == "midspan_curvature":
            label += ", the modes left out added"
            modes = odd_modes(series.modes.beam, nodes // 2)
            ours = ours + modes.residual_curvature * run.contact_force.values
        comparisons.curve(label, units, ours, series.at(name, time), limit * finer)
    return comparisons


def error(name: str, series: ModalSolution, run: xr.Dataset) -> float:
    """Return the root mean square of a history's error over its largest value."""
    return rms_error(run[name].values, series.at(name, run.time.values))


def _panels(
    title: str,
    schemes: Sequence[GridFamily],
    runs: Mapping[GridKey, xr.Dataset],
    solutions: Mapping[str, ModalSolution],
) -> list[CurvePanel]:
    """Draw the histories, and how their errors fall."""
    panels, errors, series = [], [], next(iter(solutions.values()))
    for name, units in HISTORIES.items():
        curves = []
        for grids in schemes:
            run = runs[grids.scheme, grids.middle]
            time = run.time.values
            curves.append(Curve(f"{grids.scheme}, {grids.middle} nodes", time, run[name].values))
            nodes = np.array(grids.nodes, dtype=np.float64)
            sizes = [error(name, series, runs[grids.scheme, n]) for n in grids.nodes]
            errors.append(Curve(f"{grids.scheme}: {words(name)}", nodes, np.array(sizes)))
        for label, other in solutions.items():
            curves.append(Curve(label, time, other.at(name, time), independent=True))
        panels.append(CurvePanel(title, ("time", "s"), (words(name), units), curves))
    first = errors[0]
    slope = Curve("second order", first.x, first.y[0] * (first.x[0] / first.x) ** 2.0, True)
    axes = ("nodes", "1"), ("error (root mean square over the largest value)", "1")
    return [*panels, CurvePanel(title, *axes, [*errors, slope], log=True)]


BERNOULLI_CASES = {
    "the paper's beam": Sweep(elastic(paper_impact(0.99)), (0.1, 0.99, 2.0, 5.0), 0.4e-3),
    "Timoshenko's beam": Sweep(elastic(timoshenko_impact()), (0.01, 0.1, 1.0, 5.0), 0.3e-3),
    "a beam of aluminium": Sweep(elastic(aluminium_impact()), (0.05, 0.1, 0.3, 0.8), 0.4e-3),
}


@check(
    "Elastic beam: modal series",
    "Timoshenko, Z. Math. Phys. 62 (1913) 198; Goldsmith, Impact (1960); series in "
    "impactlab.verification.solutions.modal",
    Reference("series", 4.5e-6, "what twice the modes and half the step change"),
)
def modal_series() -> Finding:
    """Compare the beam of Euler and Bernoulli, under both schemes."""
    title = "the paper's beam, 0.99 m/s"
    return _finding(title, BERNOULLI_CASES, solve, {}, (LEAPFROG, MODAL))


def _sheared(impact: Impact, span: float = 1.0) -> Impact:
    """Return `impact` on an elastic Timoshenko beam of that share of the span."""
    beam = replace(impact.beam, span=span * impact.beam.span)
    return replace(elastic(replace(impact, beam=beam)), beam_model="timoshenko")


TIMOSHENKO_CASES = {
    "the paper's beam": Sweep(_sheared(paper_impact(0.99)), (0.1, 0.99, 5.0), 0.4e-3),
    "Timoshenko's example": Sweep(_sheared(timoshenko_impact()), (0.01, 1.0, 5.0), 0.3e-3),
    "a beam of aluminium": Sweep(_sheared(aluminium_impact()), (0.05, 0.3), 0.4e-3),
    "a stubby beam": Sweep(_sheared(paper_impact(), 0.25), (0.1, 1.0, 5.0), 1.5e-3),
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
    Reference(
        "series", 1.3e-6, "what twice the modes and half the step change", {"curvature": 1.4e-5}
    ),
)
def timoshenko_beam() -> Finding:
    """Compare the beam with shear and rotary inertia, which the modal scheme does not know."""
    case = TIMOSHENKO_CASES["the paper's beam"]
    bare = {"modal series without shear": solve(case.impact, case.duration)}
    title = "the paper's beam with shear and rotary inertia, 0.99 m/s"
    return _finding(title, TIMOSHENKO_CASES, solve_sheared, bare, (LEAPFROG,))


@check(
    "Sub-impacts",
    "Timoshenko, Z. Math. Phys. 62 (1913) 198, his two spheres; series in "
    "impactlab.verification.solutions.modal",
    Reference(
        "series", 1.4e-6, "what twice the modes and half the step change", {"peak force": 5.5e-6}
    ),
)
def sub_impacts() -> Finding:
    """Compare number, times and peak force of the contacts, and the time in contact.

    Timoshenko's two spheres at 10 mm/s; the larger one touches three times. His numbers are at
    second hand: see timoshenko_impact.
    """
    small = elastic(timoshenko_impact())
    sphere, beam = replace(small.sphere, radius=0.02), replace(small.beam, span=0.307)
    large = replace(small, sphere=sphere, beam=beam)
    comparisons = Comparisons()
    panels: list[CurvePanel] = []
    for where, impact, duration in (
        ("sphere of 10 mm radius, span of 153.5 mm", small, 1e-3),
        ("sphere of 20 mm radius, span of 307 mm", large, 6e-3),
    ):
        series = solve(impact, duration)
        grid = Discretisation(nodes=801, points=3)
        run = run_dataset(impact, grid, duration=duration, samples=4001)
        _compare_contacts(comparisons.at(where), run, series)
        time = run.time.values
        curves = [
            Curve(f"{grid.nodes} nodes", time, run.contact_force.values),
            Curve("modal series", time, series.at("contact_force", time), independent=True),
        ]
        panels.append(CurvePanel(where, ("time", "s"), ("contact force", "N"), curves))
    return Finding(comparisons, panels)


def _compare_contacts(comparisons: Comparisons, run: xr.Dataset, series: ModalSolution) -> None:
    ours = _contacts(run.time.values, run.indentation.values, run.contact_force.values)
    theirs = _contacts(series.time, series.indentation, series.contact_force)
    count, total = run.number_of_contacts.item(), run.total_contact_time.item()
    in_contact, where = sum(end - begin for begin, end, _ in theirs), comparisons.where
    comparisons.absolute("number of contacts", "1", count, len(theirs), 0.5)
    comparisons.relative("total time in contact", "s", total, in_contact, 1e-4)
    for number, (contact, expected) in enumerate(zip(ours, theirs, strict=False), 1):
        comparisons.at(f"{where}, contact {number}")
        if number > 1:  # the first one begins at 0
            comparisons.relative("begin", "s", contact[0], expected[0], 1e-4)
        comparisons.relative("end", "s", contact[1], expected[1], 1e-4)
        comparisons.relative("peak force", "N", contact[2], expected[2], 1e-3)


def _contacts(time: Floats, indentation: Floats, force: Floats) -> list[tuple[float, float, float]]:
    """Return begin (s), end (s) and largest force (N) of each contact, between the samples."""
    delta, push = CubicSpline(time, indentation), CubicSpline(time, force)
    roots = delta.roots(extrapolate=False)
    ends = np.append(0.0, roots[roots > 0.5 * time[1]])  # first touch is at 0
    turns = push.derivative().roots(extrapolate=False)
    contacts = []
    for begin, end in ends.reshape(-1, 2):  # the last one has ended
        peaks = push(turns[(turns > begin) & (turns < end)])
        contacts.append((float(begin), float(end), float(np.max(peaks))))
    return contacts
