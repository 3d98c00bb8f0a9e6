"""Limits of the elastic beam: infinitely long, and infinitely slender."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Beam, Impact, paper_impact
from impactlab.simulate import simulate
from impactlab.types import Floats
from impactlab.verification.cases import elastic, slimmer
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
)
from impactlab.verification.solutions import modal
from impactlab.verification.solutions.infinite_beam import (
    curvature_under_force,
    deflection_under_force,
    deflection_under_impulse,
    profile_under_impulse,
)

LONG_NODES = (801, 1601, 3201)
FINEST = LONG_NODES[-1]
IMPULSE_DURATION = 150e-6
"""In s, six times the contact. Only waves of frequencies above 60 over the contact's duration cross
3.12 m in this time, and the force contains almost none of these."""
NEAR = 0.3
"""Distance in m from mid-span within which shapes are compared; farther out are the waves for whose
frequencies the contact is not short."""


def long_impact() -> Impact:
    """Return a steel sphere of 5 mm radius at 5 m/s on the paper's beam, four times as long."""
    impact = elastic(paper_impact(5.0))
    return replace(
        impact,
        sphere=replace(impact.sphere, radius=0.005),
        beam=replace(impact.beam, span=4.0 * impact.beam.span),
        gravity=0.0,
    )


@dataclass(frozen=True)
class Struck:
    """A run, and the impulse of its force (N, shape (time,)).

    impulse: N s. centroid: of the force in time, in s.
    """

    run: xr.Dataset
    beam: Beam
    time: Floats
    force: Floats

    @property
    def impulse(self) -> float:
        """Return J in N s."""
        return float(np.trapezoid(self.force, self.time))

    @property
    def centroid(self) -> float:
        """Return the force's first moment over J, in s."""
        return float(np.trapezoid(self.force * self.time, self.time)) / self.impulse


def check_infinite_beam() -> Finding:
    """Compare histories under the solver's force, and deflections under one impulse.

    The convolution is exact, whatever the force. An impulse at the force's centroid leaves out the
    second moment of the force: 1/8 of its variance over the square of the time since.
    """
    impact = long_impact()
    runs = {nodes: _strike(impact, nodes) for nodes in LONG_NODES}
    found = [*_convolved(runs), *_at_once(runs[FINEST])]
    return Finding(
        found, [_long_histories(runs[FINEST]), _profiles(runs[FINEST]), _long_errors(runs)]
    )


INFINITE_BEAM = Check(
    "infinite_beam",
    "Infinite beam under an impulse",
    "Boussinesq 1885; closed forms in impactlab.verification.solutions.infinite_beam",
    check_infinite_beam,
)


def _strike(impact: Impact, nodes: int) -> Struck:
    grid = Discretisation(nodes=nodes, points=3)
    run = simulate(impact, grid, duration=IMPULSE_DURATION)
    return Struck(run, impact.beam, run.time.values, run.contact_force.values)


def _convolved(runs: Mapping[int, Struck]) -> list[Comparison]:
    """Compare histories at mid-span and the shape under the force itself, and the order."""
    struck = runs[FINEST]
    args = (struck.beam, struck.time, struck.force)
    w, kappa = struck.run.midspan_deflection.values, struck.run.midspan_curvature.values
    x, profile = _profile(struck)
    where, order = f"{FINEST} nodes, under the solver's own force", "order of convergence"
    errors = [_long_error(runs[nodes]) for nodes in LONG_NODES]
    return [
        curve("history of deflection", where, "m", w, deflection_under_force(*args), 1e-4),
        curve("history of curvature", where, "m-1", kappa, curvature_under_force(*args), 1e-3),
        curve("deflected shape", where, "m", profile, _profile_under_force(struck, x), 2e-4),
        absolute(
            f"{order} of the deflection",
            f"{LONG_NODES[-2]} to {FINEST} nodes",
            "1",
            float(np.log2(errors[-2] / errors[-1])),
            2.0,
            0.2,
        ),
    ]


def _at_once(struck: Struck) -> list[Comparison]:
    """Compare deflection and shape at the end, with the impulse at the force's centroid."""
    since = IMPULSE_DURATION - struck.centroid
    x, profile = _profile(struck)
    ours = struck.run.midspan_deflection[-1].item()
    expected = deflection_under_impulse(struck.beam, struck.impulse, since).item()
    shape = profile_under_impulse(struck.beam, struck.impulse, since, x)
    where = f"{IMPULSE_DURATION * 1e6:g} us after first touch, impulse at the force's centroid"
    return [
        relative("mid-span deflection", where, "m", ours, expected, 5e-4),
        curve("deflected shape", where, "m", profile, shape, 3e-3),
    ]


def _profile(struck: Struck) -> tuple[Floats, Floats]:
    """Return the distances from mid-span (m) and deflections (m) near mid-span at the end."""
    x = struck.run.x.values - 0.5 * struck.beam.span
    near = np.abs(x) < NEAR
    return x[near], struck.run.deflection.values[near]


def _profile_under_force(struck: Struck, x: Floats) -> Floats:
    """Convolve the response to an impulse with the force, by the trapezoidal rule."""
    pushed = struck.force > 0.0
    time, force = struck.time[pushed], struck.force[pushed, np.newaxis]
    since = IMPULSE_DURATION - time[:, np.newaxis]
    return np.asarray(
        np.trapezoid(force * profile_under_impulse(struck.beam, 1.0, since, x), time, axis=0)
    )


def _long_error(struck: Struck) -> float:
    """Return the root mean square of the deflection's error over its largest value."""
    expected = deflection_under_force(struck.beam, struck.time, struck.force)
    return rms_error(struck.run.midspan_deflection.values, expected)


def _long_histories(struck: Struck) -> Panel:
    time, beam = struck.time, struck.beam
    since = time[time > struck.centroid]
    at_once = deflection_under_impulse(beam, struck.impulse, since - struck.centroid)
    w = struck.run.midspan_deflection.values
    return Panel(
        "deflection where the sphere strikes",
        ("time", "s"),
        ("mid-span deflection", "m"),
        [
            Curve(f"{FINEST} nodes", time, w),
            Curve("force convolved", time, deflection_under_force(beam, time, struck.force), True),
            Curve("impulse at the force's centroid", since, at_once, independent=True),
        ],
    )


def _profiles(struck: Struck) -> Panel:
    x, profile = _profile(struck)
    return Panel(
        f"shape {IMPULSE_DURATION * 1e6:g} us after first touch",
        ("distance from mid-span", "m"),
        ("deflection", "m"),
        [
            Curve(f"{FINEST} nodes", x, profile),
            Curve("force convolved", x, _profile_under_force(struck, x), independent=True),
        ],
    )


def _long_errors(runs: Mapping[int, Struck]) -> Panel:
    nodes = np.array(LONG_NODES, dtype=np.float64)
    errors = np.array([_long_error(runs[n]) for n in LONG_NODES])
    return Panel(
        "deflection history",
        ("nodes", "1"),
        ("error (root mean square over the largest value)", "1"),
        [
            Curve("solver against convolved force", nodes, errors),
            Curve("second order", nodes, errors[0] * (nodes[0] / nodes) ** 2, independent=True),
        ],
        log=True,
    )


SHEAR_HISTORIES = {
    "contact_force": ("contact force", "N"),
    "midspan_deflection": ("mid-span deflection", "m"),
}
SLENDERNESS = (1, 2, 4, 8, 16)
"""Slenderness over that of the paper's beam."""
SHEAR_DURATION = 0.4e-3
"""In s."""
SHEAR_TOLERANCE = 5e-3
"""Relative to the largest change by shear, which is the difference of two errors of order dx^2."""
_GRID = Discretisation(nodes=401, points=3)
_SAMPLES = 401


def check_slender_limit() -> Finding:
    """Compare the change by shear and rotary inertia with the series, and its order.

    All beams of the family are one to bending (see slimmer), so that the difference of the two
    models has no other cause.
    """
    impact = elastic(paper_impact())
    bare = _run(impact, "elastic")
    runs = {times: _run(slimmer(impact, times), "timoshenko") for times in SLENDERNESS}
    found = [
        *(_difference(name, impact, runs[1], bare) for name in SHEAR_HISTORIES),
        *(_order(name, runs, bare) for name in SHEAR_HISTORIES),
    ]
    return Finding(found, [_shear_histories(impact, runs[1], bare), _fall(runs, bare)])


SLENDER_LIMIT = Check(
    "slender_limit",
    "Slender limit of the Timoshenko beam",
    "shear and rotary inertia go with (depth/span)^2; difference of the two modal series, in "
    "impactlab.verification.solutions.modal",
    check_slender_limit,
)


def _run(impact: Impact, model: str) -> xr.Dataset:
    """Solve the impact with that model of the beam."""
    modelled = replace(impact, beam_model=model)
    return simulate(modelled, _GRID, duration=SHEAR_DURATION, samples=_SAMPLES)


def _difference(name: str, impact: Impact, ours: xr.Dataset, bare: xr.Dataset) -> Comparison:
    (quantity, units), time = SHEAR_HISTORIES[name], ours.time.values
    one, other = modal.solve_timoshenko(impact, SHEAR_DURATION), modal.solve(impact, SHEAR_DURATION)
    gap, expected = (ours[name] - bare[name]).values, one.at(name, time) - other.at(name, time)
    label = f"what shear and rotary inertia change in the {quantity}"
    return curve(label, "the paper's beam, 0.99 m/s", units, gap, expected, SHEAR_TOLERANCE)


def _order(name: str, runs: dict[int, xr.Dataset], bare: xr.Dataset) -> Comparison:
    coarse, fine = (_size(name, runs[times], bare) for times in SLENDERNESS[-2:])
    label = f"order in depth/span of the change in the {SHEAR_HISTORIES[name][0]}"
    where = f"{SLENDERNESS[-2]} and {SLENDERNESS[-1]} times as slender"
    return absolute(label, where, "1", float(np.log2(coarse / fine)), 2.0, 0.02)


def _size(name: str, ours: xr.Dataset, bare: xr.Dataset) -> float:
    """Return the root mean square of a history's change over its largest value."""
    return rms_error(ours[name].values, bare[name].values)


def _shear_histories(impact: Impact, ours: xr.Dataset, bare: xr.Dataset) -> Panel:
    time = ours.time.values
    one, other = modal.solve_timoshenko(impact, SHEAR_DURATION), modal.solve(impact, SHEAR_DURATION)
    expected = one.at("contact_force", time) - other.at("contact_force", time)
    return Panel(
        "what shear and rotary inertia change: the paper's beam, 0.99 m/s",
        ("time", "s"),
        ("change of the contact force", "N"),
        [
            Curve("solver", time, (ours.contact_force - bare.contact_force).values),
            Curve("modal series", time, expected, independent=True),
        ],
    )


def _fall(runs: dict[int, xr.Dataset], bare: xr.Dataset) -> Panel:
    beam = elastic(paper_impact()).beam
    ratios = beam.depth / beam.span / np.array(SLENDERNESS, dtype=np.float64)
    changes = {
        quantity: np.array([_size(name, runs[times], bare) for times in SLENDERNESS])
        for name, (quantity, _) in SHEAR_HISTORIES.items()
    }
    lines = [Curve(label, ratios, values) for label, values in changes.items()]
    slope = lines[0].y[-1] * (ratios / ratios[-1]) ** 2
    return Panel(
        "change with shear and rotary inertia",
        ("depth over span", "1"),
        ("change (root mean square over the largest value)", "1"),
        [*lines, Curve("second order", ratios, slope, independent=True)],
        log=True,
    )
