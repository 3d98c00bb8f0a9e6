"""The local compliance of beam and sphere in the contact, against modal series."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from impactlab.model.contact_compliance import contact_compliance as local
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.simulate import simulate
from impactlab.verification.cases import elastic
from impactlab.verification.finding import (
    Curve,
    Finding,
    Panel,
    absolute,
    check,
    curve,
    responses,
)
from impactlab.verification.solutions.beam_modes import timoshenko_odd_modes
from impactlab.verification.solutions.modal import solve_with

DURATION, SAMPLES, NODES, MODES = 0.3e-3, 601, 201, 100
TOLERANCE = 2e-3


@check(
    "Contact compliance of beam and sphere",
    "modal series of Timoshenko's beam, the contact an implicit relation at the end of each step",
)
def contact_compliance() -> Finding:
    """Compare force, duration and histories of an elastic impact, and the audit of its energy.

    Under Hertz's law, at 0.99 and 5 m/s. The panel shows the half-spaces, too.
    """
    found, panels = [], []
    for velocity in (0.99, 5.0):
        impact = elastic(paper_impact(velocity, "hertz"))
        beam = replace(impact, beam_model="timoshenko", contact_compliance="beam")
        grid = Discretisation(nodes=NODES, points=3)
        run = simulate(beam, grid, duration=DURATION, samples=SAMPLES)
        compliance, bending = (float(value) for value in local(beam))
        modes = timoshenko_odd_modes(beam.beam, MODES)
        exact = solve_with(modes, beam, DURATION, None, compliance, bending)
        where, time = f"{velocity:g} m/s, {NODES} nodes", run.time.values
        force, indentation = (exact.at(n, time) for n in ("contact_force", "indentation"))
        expected = {
            "peak_force": exact.peak_force,
            "contact_duration": exact.contact_duration,
            "maximum_indentation": float(exact.indentation.max()),
        }
        found += [
            curve(
                "history of contact force", where, "N", run.contact_force.values, force, TOLERANCE
            ),
            curve(
                "history of indentation", where, "m", run.indentation.values, indentation, TOLERANCE
            ),
            *responses(run, where, expected, TOLERANCE),
            absolute("energy error", where, "1", run.energy_error.item(), 0.0, 5e-5),
        ]
        half_space = solve_with(modes, beam, DURATION, None)
        curves = [
            Curve("solver", time, run.contact_force.values),
            Curve("modal series", time, force, independent=True),
            Curve(
                "modal series, half-spaces",
                time,
                np.asarray(half_space.at("contact_force", time)),
                independent=True,
            ),
        ]
        panels.append(Panel(where, ("time", "s"), ("contact force", "N"), curves))
    return Finding(found, panels)
