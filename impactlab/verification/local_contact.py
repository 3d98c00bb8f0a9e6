"""Local compliance, strips and circle of contact against modal series; a prestressed contact."""

from dataclasses import replace

import numpy as np
import xarray as xr
from scipy.integrate import cumulative_trapezoid
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.special import j0

from impactlab.model.contact_compliance import axis_compliance, bending_across, contact_stress
from impactlab.model.contact_compliance import contact_compliance as local
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import run_dataset
from impactlab.types import Floats
from impactlab.verification.cases import elastic
from impactlab.verification.finding import (
    ROUNDING,
    Comparisons,
    Curve,
    CurvePanel,
    Finding,
    Reference,
    check,
)
from impactlab.verification.solutions import beam_modes, hertz
from impactlab.verification.solutions.contact_laws import LAWS
from impactlab.verification.solutions.modal import ModalSolution, solve_with

LONGER, SAMPLES, TOLERANCE = 0.3e-3, 601, 2e-3  # of the checks of the compliance; modes as below
VELOCITY, DURATION, STEPS, MODES = 10.0, 0.2e-3, 1000, 150
GRIDS = {
    ("euler_bernoulli", "leapfrog", "half_space"): (801, 0.15),
    ("euler_bernoulli", "modal", "half_space"): (401, 0.01),
    ("timoshenko", "leapfrog", "half_space"): (801, 0.15),
    ("timoshenko", "leapfrog", "beam"): (801, 0.15),
}
"""By beam model, scheme and compliance: nodes, and the tolerance of the mean ahead. Leapfrog's mean
is that of chords between the nodes, which errs in the order of (dx/a)^2."""


@check(
    "Contact compliance of beam and sphere",
    "modal series of Timoshenko's beam, the contact an implicit relation at the end of each step",
    Reference("series", 1.5e-6, "what twice the modes and half the step change"),
)
def contact_compliance() -> Finding:
    """Compare force, duration and histories of an elastic impact, and the audit of its energy.

    Under Hertz's law, at 0.99 and 5 m/s.
    """
    return _compared("beam", paper_impact().beam.depth, 201, ("half_space", "half-spaces"))


@check(
    "Beam that bends across its width",
    "modal series of Timoshenko's beam and a strip of Kirchhoff's plate in three spectra, the "
    "contact an implicit relation at the end of each step",
    Reference("series", 2e-5, "what twice the modes and half the step change"),
)
def strip() -> Finding:
    """Compare force, duration and histories of an elastic impact, and the audit of its energy.

    Under Hertz's law, at 0.99 and 5 m/s, on a beam of a quarter of its width.
    """
    return _compared("strip", 0.015, 401, ("beam", "at once"))


def _compared(option: str, depth: float, nodes: int, other: tuple[str, str]) -> Finding:
    """Compare impacts with this `contact_compliance` with series; show another (its label)."""
    comparisons = Comparisons()
    panels = []
    for velocity in (0.99, 5.0):
        impact = elastic(paper_impact(velocity, "hertz"))
        ours = replace(
            impact,
            beam=replace(impact.beam, depth=depth),
            beam_model="timoshenko",
            contact_compliance=option,
        )
        grid = Discretisation(nodes=nodes, points=3)
        run = run_dataset(ours, grid, duration=LONGER, samples=SAMPLES)
        exact, beside = (_series(replace(ours, contact_compliance=o)) for o in (option, other[0]))
        time = run.time.values
        c, gamma = (float(value) for value in axis_compliance(ours))
        beneath = c * exact.contact_force - gamma * exact.midspan_curvature
        if option == "strip":
            beneath -= _lift_by_pressure(ours, exact.contact_force)
        exact = replace(exact, indentation=exact.indentation - beneath)
        expected = {
            "peak_force": exact.peak_force,
            "contact_duration": exact.contact_duration,
            "maximum_indentation": float(exact.indentation.max()),
        }
        histories = {name: exact.at(name, time) for name in ("contact_force", "indentation")}
        comparisons.at(f"{velocity:g} m/s, {nodes} nodes").histories(run, histories, TOLERANCE)
        comparisons.responses(run, expected, TOLERANCE)
        comparisons.absolute("energy error", "1", run.energy_error.item(), 0.0, 5e-5)
        curves = [
            Curve("solver", time, run.contact_force.values),
            Curve("modal series", time, histories["contact_force"], independent=True),
            Curve(f"modal series, {other[1]}", time, beside.at("contact_force", time), True),
        ]
        panels.append(CurvePanel(comparisons.where, ("time", "s"), ("contact force", "N"), curves))
    return Finding(comparisons, panels)


def _lift_by_pressure(impact: Impact, force: Floats) -> Floats:
    """Return how much higher the axis lies under Hertz's circle than under a point, in m.

    Of an even pressure p: u = (1 + nu) p/E (2 (1 - nu) (s - z) + z - z^2/s), s^2 = a^2 + z^2
    (Johnson, Contact Mechanics (1985), section 3.4).
    """
    steel, z = impact.beam.material, 0.5 * impact.beam.depth
    nu, reach = steel.poissons_ratio, 3.0 * force * impact.sphere.radius
    a = np.maximum(np.cbrt(reach / (4.0 * hertz.effective_modulus(impact))), 1e-9)
    s = np.hypot(a, z)
    per_force = (1.0 + nu) / (np.pi * a * a * steel.youngs_modulus)
    point = per_force * (1.5 - nu) * a * a / z
    lift: Floats = force * (point - per_force * (2.0 * (1.0 - nu) * (s - z) + z - z * z / s))
    return lift


def _series(impact: Impact) -> ModalSolution:
    """Return the modal series of an impact with any contact compliance."""
    across = [float(value) for value in bending_across(impact)[:4]]
    modes = (
        beam_modes.strip_odd_modes(impact.beam, MODES, across)
        if any(across)
        else beam_modes.timoshenko_odd_modes(impact.beam, MODES)
    )
    return solve_with(modes, impact, LONGER, None, *(float(value) for value in local(impact)))


@check(
    "Contact under the stress of bending",
    "the law and its unloading in closed form, solved by bisection along the run's own histories",
    Reference("closed form", 4e-8, "tolerance of the bisection"),
)
def contact_prestress() -> Finding:
    """Compare the contact force with that of indentation and curvature, sample by sample.

    The paper's sphere and beam at 5 m/s, until the force has fallen to zero, where no fibre of the
    beam yields. The panel shows the force with `contact_prestress: ignored`, too.
    """
    impact = paper_impact(5.0, "finite_element")
    impact = replace(impact, beam_model="timoshenko", contact_prestress="bending")
    grid, table = Discretisation(nodes=201), Comparisons("5 m/s, 201 nodes")
    run, plain = (
        run_dataset(case, grid, duration=0.2e-3, samples=2001)
        for case in (impact, replace(impact, contact_prestress="ignored"))
    )
    expected = _prestressed(impact, run)
    force, time = run.contact_force.values, run.time.values
    table.histories(run, {"contact_force": expected}, 1e-3)
    table.absolute("equivalent plastic strain", "1", run.peak_plastic_strain.item(), 0.0, 0.0)
    table.absolute("energy error", "1", run.energy_error.item(), 0.0, 1e-4)
    curves = [
        Curve("solver", time, force),
        Curve("law along its histories", time, expected, independent=True),
        Curve("stress ignored", time, plain.contact_force.values),
    ]
    return Finding(table, [CurvePanel(table.where, ("time", "s"), ("contact force", "N"), curves)])


def _prestressed(impact: Impact, run: xr.Dataset) -> Floats:
    """Return the force (N) of the contact under a run's indentation and bending, (time,)."""
    beam, loading, unloading = impact.beam, *LAWS["finite_element"]
    strength = beam.material.yield_stress
    of = (
        hertz.effective_modulus(impact),
        impact.sphere.radius,
        strength,
        beam.material.poissons_ratio,
    )
    first_yield = of[1] * (0.825 * np.pi * strength / of[0]) ** 2
    along, across = (float(stress) for stress in contact_stress(impact))
    outermost = 0.5 * beam.depth * beam.material.youngs_modulus * run.midspan_curvature.values

    def yields(d: float, bending: float) -> tuple[float, float]:
        """Return indentation and force at which a contact once loaded to d yields on."""
        law, (start, residual, n) = loading(d, *of), unloading(d, loading(d, *of), *of)
        x = max(d / first_yield, 1.0)
        a = np.sqrt(of[1] * d * (1.0 + 0.04 * np.log(x) ** 2))
        s = (bending * (1.0 - a / beam.depth) + along * law) / strength, across * law / strength
        k = 3.0 / x + (1.0 - 1.0 / x) * (0.39 - 0.0008 * x)
        total, difference = s[0] + s[1], s[0] - s[1]
        g = (1.0 - k / 3.0 * (0.5 * total + 0.085 * total**2 + 0.23 * difference**2)) ** 3
        return residual + (d - residual) * (g * law / start) ** (1.0 / n), g * law

    forces, d = [], 1e-9
    for delta, bending in zip(run.indentation.values, outermost, strict=True):
        if delta > yields(d, bending)[0]:
            d = brentq(lambda d: yields(d, bending)[0] - delta, d, 1.5 * delta)  # noqa: B023
            forces.append(yields(d, bending)[1])
        else:
            start, residual, n = unloading(d, loading(d, *of), *of)
            over = max(delta - residual, 0.0) / (d - residual)
            forces.append(start * over**n)
    return np.array(forces)


@check(
    "Load over the circle of contact",
    "modal series under Hertz's pressure, its share in each mode by a Hankel transform; integrals "
    "of motion and force",
    Reference(
        "series",
        1.4e-5,
        "what twice the modes and samples change",
        {"ahead.*Timoshenko": 5e-2, "ahead": 3e-4, "curvature": 4e-4, "law's own": ROUNDING},
    ),
)
def contact_patch() -> Finding:
    """Compare histories with those of modes under the solver's own force, spread by Hertz.

    The paper's beam, elastic, at 10 m/s, during the first contact. "Ahead": how much more the mean
    deflection under the pressure has moved than mid-span, from which the approach is measured.
    The approach less the local compliance, the law's own indentation: Hertz's under that force.
    Energy: the solver's own audit.
    """
    comparisons = Comparisons()
    panels: list[CurvePanel] = []
    for (model, scheme, compliance), (nodes, chords) in GRIDS.items():
        impact = replace(elastic(paper_impact(VELOCITY)), beam_model=model, load="contact_patch")
        impact = replace(impact, contact_compliance=compliance)
        grid = Discretisation(nodes=nodes, points=3, scheme=scheme)
        run = run_dataset(impact, grid, duration=DURATION, samples=STEPS + 1)
        theory = beam_modes.timoshenko_odd_modes if model == "timoshenko" else beam_modes.odd_modes
        modes = theory(impact.beam, MODES)
        deflection, bent, ahead = _under_pressure(modes, impact, run)
        c, gamma = local(impact) if compliance == "beam" else (0.0, 0.0)
        lower = axis_compliance(impact) if compliance == "beam" else (0.0, 0.0)
        approach = run.indentation + float(lower[0]) * run.contact_force - float(lower[1]) * bent
        law = np.maximum(approach - c * run.contact_force + gamma * bent, 0.0)
        hertzian = np.cbrt(run.contact_force.values / hertz.contact_stiffness(impact)) ** 2
        moved = run.sphere_displacement - approach - run.midspan_deflection
        where = f"{model}, {compliance}, {scheme}, {nodes} nodes, {VELOCITY:g} m/s"
        kappa = run.midspan_curvature.values
        comparisons.at(where)
        comparisons.curve("deflection", "m", run.midspan_deflection.values, deflection, 1e-3)
        comparisons.curve("curvature", "m-1", kappa, bent, 2e-3)
        comparisons.curve("mean deflection ahead of mid-span", "m", moved.values, ahead, chords)
        comparisons.curve("the law's own indentation", "m", law.values, hertzian, 2e-3)
        comparisons.absolute("energy error", "1", run.energy_error.item(), 0.0, 2e-5)
        if not panels:
            point = run_dataset(
                replace(impact, load="point"), grid, duration=DURATION, samples=STEPS + 1
            )
            time = run.time.values
            lines = [
                Curve("contact patch", time, kappa),
                Curve("point load", time, point.midspan_curvature.values),
                Curve("modes under Hertz's pressure", time, bent, independent=True),
            ]
            panels = [CurvePanel(where, ("time", "s"), ("mid-span curvature", "m-1"), lines)]
    return Finding(comparisons, panels)


def _under_pressure(
    modes: beam_modes.BeamModes, impact: Impact, run: xr.Dataset
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


def _driven(modes: beam_modes.BeamModes, load: Floats, h: float) -> tuple[Floats, Floats]:
    """Return y (m) and rate (m/s) of modes from rest; load (time, modes) linear in steps h."""
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
