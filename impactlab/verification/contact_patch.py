"""The force spread over the circle of contact, on elastic beams, against modes under that force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicSpline
from scipy.special import j0

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import simulate
from impactlab.types import Floats
from impactlab.verification.cases import elastic
from impactlab.verification.finding import (
    Comparison,
    Curve,
    Finding,
    Panel,
    absolute,
    check,
    curve,
)
from impactlab.verification.solutions import hertz
from impactlab.verification.solutions.beam_modes import (
    BeamModes,
    odd_modes,
    timoshenko_odd_modes,
)

VELOCITY, DURATION, STEPS, MODES = 10.0, 0.2e-3, 1000, 150
GRIDS = {
    ("euler_bernoulli", "leapfrog"): (801, 0.15),
    ("euler_bernoulli", "modal"): (401, 0.01),
    ("timoshenko", "leapfrog"): (801, 0.15),
}
"""By beam model and scheme: nodes, and the tolerance of the mean ahead. Leapfrog's mean is that of
chords between the nodes, which errs in the order of (dx/a)^2."""


@check(
    "Load over the circle of contact",
    "modal series under Hertz's pressure, its share in each mode by a Hankel transform; integrals "
    "of motion and force",
)
def contact_patch() -> Finding:
    """Compare histories with those of modes under the solver's own force, spread by Hertz.

    The paper's beam, elastic, at 10 m/s, during the first contact. "Ahead": how much more the mean
    deflection under the pressure has moved than mid-span, which the indentation is measured
    against. Energy: the solver's own audit.
    """
    found: list[Comparison] = []
    panels: list[Panel] = []
    for (model, scheme), (nodes, chords) in GRIDS.items():
        impact = replace(elastic(paper_impact(VELOCITY)), beam_model=model, load="contact_patch")
        grid = Discretisation(nodes=nodes, points=3, scheme=scheme)
        run = simulate(impact, grid, duration=DURATION, samples=STEPS + 1)
        sheared = model == "timoshenko"
        modes = (timoshenko_odd_modes if sheared else odd_modes)(impact.beam, MODES)
        deflection, bent, ahead = _under_pressure(modes, impact, run)
        moved = run.sphere_displacement - run.indentation - run.midspan_deflection
        where = f"{model}, {scheme}, {nodes} nodes, {VELOCITY:g} m/s"
        kappa = run.midspan_curvature.values
        found += [
            curve("deflection", where, "m", run.midspan_deflection.values, deflection, 1e-3),
            curve("curvature", where, "m-1", kappa, bent, 2e-3),
            curve("mean deflection ahead of mid-span", where, "m", moved.values, ahead, chords),
            absolute("energy error", where, "1", run.energy_error.item(), 0.0, 2e-5),
        ]
        if not panels:
            point = simulate(
                replace(impact, load="point"), grid, duration=DURATION, samples=STEPS + 1
            )
            time = run.time.values
            lines = [
                Curve("contact patch", time, kappa),
                Curve("point load", time, point.midspan_curvature.values),
                Curve("modes under Hertz's pressure", time, bent, independent=True),
            ]
            panels = [Panel(where, ("time", "s"), ("mid-span curvature", "m-1"), lines)]
    return Finding(found, panels)


def _under_pressure(
    modes: BeamModes, impact: Impact, run: xr.Dataset
) -> tuple[Floats, Floats, Floats]:
    """Return mid-span deflection (m), curvature (1/m) and the mean deflection ahead of it (m).

    Under the run's contact force, as linear between its samples, each of shape (time,). The share
    of Hertz's pressure in a mode is the Hankel transform of sqrt(1 - r^2) over the circle.
    """
    force, time = run.contact_force.values, run.time.values
    # F = K delta^1.5, a = sqrt(R delta)
    stiffness, radius = hertz.contact_stiffness(impact), impact.sphere.radius
    a = np.sqrt(radius) * np.cbrt(force / stiffness)
    nodes, weights = np.polynomial.legendre.leggauss(64)
    angle = 0.25 * np.pi * (nodes + 1.0)
    profile = 0.25 * np.pi * weights * 3.0 * np.sin(angle) * np.cos(angle) ** 2
    z = np.linspace(0.0, a.max() * modes.wave_numbers.max(), 1000)
    hankel = CubicSpline(z, j0(np.outer(z, np.sin(angle))) @ profile)
    share = hankel(np.outer(a, modes.wave_numbers))
    y, rate = _driven(modes, force[:, np.newaxis] * share, float(time[1]))
    slower = cumulative_trapezoid(((share - 1.0) * rate).sum(axis=1), time, initial=0.0)
    return y.sum(axis=1), y @ modes.curvatures, slower


def _driven(modes: BeamModes, load: Floats, h: float) -> tuple[Floats, Floats]:
    """Return y (m) and its rate (m/s) of modes from rest, each exact for a load linear per step.

    load: in N, shape (time, modes), at steps of h (s).
    """
    omega = modes.frequencies
    cosine, sine = np.cos(omega * h), np.sin(omega * h)
    y, v = np.zeros_like(load), np.zeros_like(load)
    for i in range(len(load) - 1):
        # about the static answer, which is linear in the step
        static, slope = modes.flexibilities * load[i], modes.flexibilities * (load[i + 1] - load[i])
        offset, drift = y[i] - static, v[i] - slope / h
        y[i + 1] = static + slope + offset * cosine + drift * sine / omega
        v[i + 1] = slope / h - offset * omega * sine + drift * cosine
    return y, v
