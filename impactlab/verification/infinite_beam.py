"""A long elastic beam struck by a small sphere: the infinite beam, before the supports answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.model.beam import Beam
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact
from impactlab.simulate import simulate
from impactlab.verification.cases import elastic
from impactlab.verification.finding import (
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    curve,
    relative,
)
from impactlab.verification.solutions.infinite_beam import (
    curvature_under_force,
    deflection_under_force,
    deflection_under_impulse,
    profile_under_impulse,
)

TITLE = "Infinite beam under an impulse"
SOURCE = "Boussinesq 1885; closed forms in impactlab.verification.solutions.infinite_beam"

Floats = NDArray[np.float64]

NODES = (801, 1601, 3201)
FINEST = NODES[-1]
DURATION = 150e-6
"""In s: six times the contact. Waves that cross 3.12 m in this time are those of frequencies above
60 over the contact's duration, of which the force holds next to nothing."""
NEAR = 0.3
"""In m from mid-span: shapes are compared within. Farther out run the waves of frequencies to which
the contact is not short."""


def long_impact() -> Impact:
    """A steel sphere of 5 mm radius at 5 m/s on the paper's beam, four times as long."""
    impact = elastic(paper_impact(5.0))
    return replace(
        impact,
        sphere=replace(impact.sphere, radius=0.005),
        beam=replace(impact.beam, span=4.0 * impact.beam.span),
        gravity=0.0,
    )


@dataclass(frozen=True)
class Struck:
    """A run, and what its force (N, shape (time,)) amounts to.

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


def check() -> Finding:
    """The histories under the solver's own force; deflections as if all of it struck at once.

    The convolution is exact, whatever the force. An impulse at the force's centroid leaves out the
    second moment of the force: 1/8 of its variance over the square of the time since.
    """
    impact = long_impact()
    runs = {nodes: _strike(impact, nodes) for nodes in NODES}
    found = [*_convolved(runs), *_at_once(runs[FINEST])]
    return Finding(found, [_histories(runs[FINEST]), _profiles(runs[FINEST]), _errors(runs)])


def _strike(impact: Impact, nodes: int) -> Struck:
    grid = Discretisation(nodes=nodes, points=3)
    run = simulate(impact, grid, duration=DURATION)
    return Struck(run, impact.beam, run.time.values, run.contact_force.values)


def _convolved(runs: Mapping[int, Struck]) -> list[Comparison]:
    """Histories at mid-span and the profile, under the force as it was; and the order."""
    struck = runs[FINEST]
    args = (struck.beam, struck.time, struck.force)
    w, kappa = struck.run.midspan_deflection.values, struck.run.midspan_curvature.values
    x, profile = _profile(struck)
    where, order = f"{FINEST} nodes, under the solver's own force", "order of convergence"
    errors = [_error(runs[nodes]) for nodes in NODES]
    return [
        curve("history of deflection", where, "m", w, deflection_under_force(*args), 1e-4),
        curve("history of curvature", where, "m-1", kappa, curvature_under_force(*args), 1e-3),
        curve("deflected shape", where, "m", profile, _profile_under_force(struck, x), 2e-4),
        absolute(
            f"{order} of the deflection",
            f"{NODES[-2]} to {FINEST} nodes",
            "1",
            float(np.log2(errors[-2] / errors[-1])),
            2.0,
            0.2,
        ),
    ]


def _at_once(struck: Struck) -> list[Comparison]:
    """Deflection and deflected shape at the end, as if the impulse struck at the centroid."""
    since = DURATION - struck.centroid
    x, profile = _profile(struck)
    ours = struck.run.midspan_deflection[-1].item()
    expected = deflection_under_impulse(struck.beam, struck.impulse, since).item()
    shape = profile_under_impulse(struck.beam, struck.impulse, since, x)
    where = f"{DURATION * 1e6:g} us after first touch, impulse at the force's centroid"
    return [
        relative("mid-span deflection", where, "m", ours, expected, 5e-4),
        curve("deflected shape", where, "m", profile, shape, 3e-3),
    ]


def _profile(struck: Struck) -> tuple[Floats, Floats]:
    """Distances from mid-span (m) and deflections (m) near mid-span at the end."""
    x = struck.run.x.values - 0.5 * struck.beam.span
    near = np.abs(x) < NEAR
    return x[near], struck.run.deflection.values[near]


def _profile_under_force(struck: Struck, x: Floats) -> Floats:
    """Response to an impulse at each time, times the force then, by the trapezoidal rule."""
    pushed = struck.force > 0.0
    time, force = struck.time[pushed], struck.force[pushed, np.newaxis]
    since = DURATION - time[:, np.newaxis]
    return np.asarray(
        np.trapezoid(force * profile_under_impulse(struck.beam, 1.0, since, x), time, axis=0)
    )


def _error(struck: Struck) -> float:
    """Root mean square of the deflection's error over its largest value."""
    expected = deflection_under_force(struck.beam, struck.time, struck.force)
    gap: Floats = struck.run.midspan_deflection.values - expected
    return float(np.sqrt(np.mean(gap**2)) / np.max(expected))


def _histories(struck: Struck) -> Panel:
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
        f"shape {DURATION * 1e6:g} us after first touch",
        ("distance from mid-span", "m"),
        ("deflection", "m"),
        [
            Curve(f"{FINEST} nodes", x, profile),
            Curve("force convolved", x, _profile_under_force(struck, x), independent=True),
        ],
    )


def _errors(runs: Mapping[int, Struck]) -> Panel:
    nodes = np.array(NODES, dtype=np.float64)
    errors = np.array([_error(runs[n]) for n in NODES])
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
