"""Limits of the elastic beam: infinitely long, and infinitely slender."""

from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.bodies import Beam
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.simulate import run_dataset
from impactlab.verification.cases import elastic, slimmer
from impactlab.verification.finding import (
    Comparisons,
    Curve,
    CurvePanel,
    Finding,
    Reference,
    check,
    rms_error,
)
from impactlab.verification.solutions import bending as closed
from impactlab.verification.solutions import modal

LONG_NODES = (801, 1601, 3201)
FINEST = LONG_NODES[-1]
IMPULSE_DURATION = 150e-6
"""In s, six times the contact. Only waves of frequencies above 60 over the contact's duration cross
3.12 m in this time, and the force contains almost none of these."""
NEAR = 0.3
"""Distance in m from mid-span within which shapes are compared; farther out are the waves for whose
frequencies the contact is not short."""
_TIME, _DEFLECTION = ("time", "s"), ("mid-span deflection", "m")


@check(
    "Infinite beam under an impulse",
    "Boussinesq 1885; closed forms in impactlab.verification.solutions.bending",
    Reference(
        "closed form",
        3e-6,
        "what every second sample of the force changes; of the impulse, what taking the force for "
        "one changes",
        {
            "deflected shape.*impulse": 1.3e-3,
            "mid-span deflection": 2e-4,
            "history of curvature": 4e-5,
            "deflected shape": 2e-5,
        },
    ),
)
def infinite_beam() -> Finding:
    """Compare histories under the solver's force, and deflections under one impulse.

    A steel sphere of 5 mm radius at 5 m/s strikes the paper's beam, four times as long. The
    convolution is exact, whatever the force. An impulse at the force's centroid leaves out the
    second moment of the force: 1/8 of its variance over the square of the time since.
    """
    impact = elastic(paper_impact(5.0))
    beam = replace(impact.beam, span=4.0 * impact.beam.span)
    sphere = replace(impact.sphere, radius=0.005)
    impact = replace(impact, sphere=sphere, beam=beam, gravity=0.0)
    grids = [Discretisation(nodes=nodes, points=3) for nodes in LONG_NODES]
    runs = [run_dataset(impact, grid, duration=IMPULSE_DURATION) for grid in grids]
    errors = []
    for run in runs:
        expected = closed.deflection_under_force(beam, run.time.values, run.contact_force.values)
        errors.append(rms_error(run.midspan_deflection.values, expected))
    label, where = "order of convergence of the deflection", f"{LONG_NODES[-2]} to {FINEST} nodes"
    observed = float(np.log2(errors[-2] / errors[-1]))
    order = Comparisons(where).absolute(label, "1", observed, 2.0, 0.2)
    convolved, impulsive, panels = _against_closed_forms(runs[-1], beam)
    nodes = np.array(LONG_NODES, dtype=np.float64)
    slope = errors[0] * (nodes[0] / nodes) ** 2
    curves = [
        Curve("solver against convolved force", nodes, np.array(errors)),
        Curve("second order", nodes, slope, independent=True),
    ]
    axes = ("nodes", "1"), ("error (root mean square over the largest value)", "1")
    fall = CurvePanel("deflection history", *axes, curves, log=True)
    return Finding([*convolved, *order, *impulsive], [*panels, fall])


def _against_closed_forms(
    run: xr.Dataset, beam: Beam
) -> tuple[Comparisons, Comparisons, list[CurvePanel]]:
    """Compare a run under the force itself, and under one impulse at the force's centroid.

    Histories are those at mid-span. The shape is that near mid-span at the end: under the force,
    the response to an impulse convolved with it, by the trapezoidal rule.
    """
    time, force = run.time.values, run.contact_force.values
    w, kappa = run.midspan_deflection.values, run.midspan_curvature.values
    x = run.x.values - 0.5 * beam.span
    near = np.abs(x) < NEAR
    x, profile = x[near], run.deflection.values[near]

    history = closed.deflection_under_force(beam, time, force)
    curvature = closed.curvature_under_force(beam, time, force)
    pushed = force > 0.0
    since = IMPULSE_DURATION - time[pushed, np.newaxis]
    responses = force[pushed, np.newaxis] * closed.profile_under_impulse(beam, 1.0, since, x)
    shape = np.trapezoid(responses, time[pushed], axis=0)
    convolved = Comparisons(f"{FINEST} nodes, under the solver's own force")
    convolved.curve("history of deflection", "m", w, history, 1e-4)
    convolved.curve("history of curvature", "m-1", kappa, curvature, 1e-3)
    convolved.curve("deflected shape", "m", profile, shape, 2e-4)

    impulse = float(np.trapezoid(force, time))
    centroid = float(np.trapezoid(force * time, time)) / impulse
    rest = IMPULSE_DURATION - centroid
    expected = closed.deflection_under_impulse(beam, impulse, rest).item()
    struck = closed.profile_under_impulse(beam, impulse, rest, x)
    end = f"{IMPULSE_DURATION * 1e6:g} µs after first touch"
    impulsive = Comparisons(f"{end}, impulse at the force's centroid")
    impulsive.relative("mid-span deflection", "m", w[-1].item(), expected, 5e-4)
    impulsive.curve("deflected shape", "m", profile, struck, 3e-3)

    later = time[time > centroid]
    at_once = closed.deflection_under_impulse(beam, impulse, later - centroid)
    histories = [
        Curve(f"{FINEST} nodes", time, w),
        Curve("force convolved", time, history, independent=True),
        Curve("impulse at the force's centroid", later, at_once, independent=True),
    ]
    shapes = [Curve(f"{FINEST} nodes", x, profile), Curve("force convolved", x, shape, True)]
    axes = ("distance from mid-span", "m"), ("deflection", "m")
    panels = [
        CurvePanel("deflection where the sphere strikes", _TIME, _DEFLECTION, histories),
        CurvePanel(f"shape {end}", *axes, shapes),
    ]
    return convolved, impulsive, panels


@check(
    "Slender limit of the Timoshenko beam",
    "shear and rotary inertia go with (depth/span)^2; difference of the two modal series, in "
    "impactlab.verification.solutions.modal",
    Reference(
        "series",
        1.4e-4,
        "what twice the modes and half the step change, of a difference of two series",
        {"deflection": 8e-6},
    ),
)
def slender_limit() -> Finding:
    """Compare the change by shear and rotary inertia with the series, and its order.

    All beams of the family are one to bending (see slimmer), so that the difference of the two
    models has no other cause. Sizes of a change are root mean squares over the history's largest
    value.
    """
    impact, grid = elastic(paper_impact(0.99)), Discretisation(nodes=401, points=3)
    duration, slenderness = 0.4e-3, (1, 2, 4, 8, 16)  # over that of the paper's beam
    family = [replace(slimmer(impact, times), beam_model="timoshenko") for times in slenderness]
    bare, *runs = (
        run_dataset(variant, grid, duration=duration, samples=401)
        for variant in (replace(impact, beam_model="elastic"), *family)
    )
    sheared, slender = modal.solve_timoshenko(impact, duration), modal.solve(impact, duration)
    time, changes = bare.time.values, Comparisons("the paper's beam, 0.99 m/s")
    orders = Comparisons(f"{slenderness[-2]} and {slenderness[-1]} times as slender")
    ratios = impact.beam.depth / impact.beam.span / np.array(slenderness, dtype=np.float64)
    histories, fall = {}, []
    for name, quantity, units in (
        ("contact_force", "contact force", "N"),
        ("midspan_deflection", "mid-span deflection", "m"),
    ):
        ours = (runs[0][name] - bare[name]).values
        expected = sheared.at(name, time) - slender.at(name, time)
        label = f"what shear and rotary inertia change in the {quantity}"
        # Relative to a change which is itself the difference of two errors of order dx^2.
        changes.curve(label, units, ours, expected, 5e-3)
        histories[name] = [Curve("solver", time, ours), Curve("modal series", time, expected, True)]
        sizes = np.array([rms_error(run[name].values, bare[name].values) for run in runs])
        fall.append(Curve(quantity, ratios, sizes))
        observed = float(np.log2(sizes[-2] / sizes[-1]))
        label = f"order in depth/span of the change in the {quantity}"
        orders.absolute(label, "1", observed, 2.0, 0.02)
    slope = fall[0].y[-1] * (ratios / ratios[-1]) ** 2
    fall.append(Curve("second order", ratios, slope, independent=True))
    title = f"what shear and rotary inertia change: {changes.where}"
    force = "change of the contact force"
    axes = ("depth over span", "1"), ("change (root mean square over the largest value)", "1")
    panels = [
        CurvePanel(title, _TIME, (force, "N"), histories["contact_force"]),
        CurvePanel("change with shear and rotary inertia", *axes, fall, log=True),
    ]
    return Finding([*changes, *orders], panels)
