"""Ever more slender beams: Timoshenko's theory becomes Euler's and Bernoulli's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.paper import paper_impact
from impactlab.simulate import simulate
from impactlab.verification.cases import elastic, slimmer
from impactlab.verification.finding import Comparison, Curve, Finding, Panel, absolute, curve
from impactlab.verification.solutions import modal, timoshenko_modal

TITLE = "Slender limit of the Timoshenko beam"
SOURCE = (
    "shear and rotary inertia go with (depth/span)^2; difference of the two modal series, in "
    "impactlab.verification.solutions.modal and .timoshenko_modal"
)

HISTORIES = {
    "contact_force": ("contact force", "N"),
    "midspan_deflection": ("mid-span deflection", "m"),
}
TIMES = (1, 2, 4, 8, 16)
"""How many times as slender as the paper's beam."""
DURATION = 0.4e-3
"""In s."""
TOLERANCE = 5e-3
"""Of the largest difference that shear makes: it is the difference of two errors of dx^2."""
_GRID = Discretisation(nodes=401, points=3)
_SAMPLES = 401

Floats = NDArray[np.float64]


def check() -> Finding:
    """What shear and rotary inertia change: as in the series, and how it falls.

    All beams of the family are one to bending (see slimmer), so that the difference of the two
    models has no other cause.
    """
    impact = elastic(paper_impact())
    bare = run(impact, "elastic")
    runs = {times: run(slimmer(impact, times), "timoshenko") for times in TIMES}
    found = [
        *(_difference(name, impact, runs[1], bare) for name in HISTORIES),
        *(_order(name, runs, bare) for name in HISTORIES),
    ]
    return Finding(found, [_histories(impact, runs[1], bare), _fall(runs, bare)])


def run(impact: Impact, model: str) -> xr.Dataset:
    """The solver's histories with that model of the beam."""
    modelled = replace(impact, beam_model=model)
    return simulate(modelled, _GRID, duration=DURATION, samples=_SAMPLES)


def _difference(name: str, impact: Impact, ours: xr.Dataset, bare: xr.Dataset) -> Comparison:
    (quantity, units), time = HISTORIES[name], ours.time.values
    one, other = timoshenko_modal.solve(impact, DURATION), modal.solve(impact, DURATION)
    gap, expected = (ours[name] - bare[name]).values, one.at(name, time) - other.at(name, time)
    label = f"what shear and rotary inertia change in the {quantity}"
    return curve(label, "the paper's beam, 0.99 m/s", units, gap, expected, TOLERANCE)


def _order(name: str, runs: dict[int, xr.Dataset], bare: xr.Dataset) -> Comparison:
    coarse, fine = (_size(name, runs[times], bare) for times in TIMES[-2:])
    label = f"order in depth/span of the change in the {HISTORIES[name][0]}"
    where = f"{TIMES[-2]} and {TIMES[-1]} times as slender"
    return absolute(label, where, "1", float(np.log2(coarse / fine)), 2.0, 0.02)


def _size(name: str, ours: xr.Dataset, bare: xr.Dataset) -> float:
    """Root mean square of a history's change over its largest value."""
    gap: Floats = (ours[name] - bare[name]).values
    return float(np.sqrt(np.mean(gap**2)) / np.max(np.abs(bare[name].values)))


def _histories(impact: Impact, ours: xr.Dataset, bare: xr.Dataset) -> Panel:
    time = ours.time.values
    one, other = timoshenko_modal.solve(impact, DURATION), modal.solve(impact, DURATION)
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
    ratios = beam.depth / beam.span / np.array(TIMES, dtype=np.float64)
    changes = {
        quantity: np.array([_size(name, runs[times], bare) for times in TIMES])
        for name, (quantity, _) in HISTORIES.items()
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
