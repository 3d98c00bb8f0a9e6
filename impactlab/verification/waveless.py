"""Impacts without waves: contact laws on a half-space, a rigid beam, a mass on a spring.

Half-space: a beam too heavy to move.
"""

from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.simulate import run_dataset
from impactlab.verification.cases import Sweep, elastic, rigid_backed
from impactlab.verification.finding import (
    CLOSED_FORM,
    Comparisons,
    Curve,
    CurvePanel,
    Finding,
    Reference,
    check,
)
from impactlab.verification.solutions import hertz, modal
from impactlab.verification.solutions.contact_laws import (
    LAWS,
    LawOnHalfSpace,
    law_on_half_space,
    stronge_impact,
)
from impactlab.verification.solutions.hertz import HuntCrossleyImpact

# With so small a Courant number the contact alone determines the time step.
_GRID = Discretisation(nodes=11, points=3, courant=0.005)
_VELOCITY, _RESTITUTION = ("velocity", "m s-1"), ("coefficient of restitution", "1")


@check(
    "Impact on a half-space",
    "Hertz 1881; closed forms in impactlab.verification.solutions.hertz",
    CLOSED_FORM,
)
def half_space() -> Finding:
    """Compare peak force, largest indentation, contact duration and restitution."""
    impact = rigid_backed(0.99, "hertz")
    run = run_dataset(impact, _GRID, duration=0.4e-3)
    comparisons = Comparisons("the paper's sphere at 0.99 m/s")
    return Finding(comparisons.responses(run, _hertzian(impact), 2e-5))


def _hertzian(impact: Impact) -> dict[str, float]:
    """Return the responses by Hertz's closed forms."""
    args = hertz.arguments(impact)
    return {
        "peak_force": hertz.peak_force(*args),
        "contact_duration": hertz.contact_duration(*args),
        "maximum_indentation": hertz.maximum_indentation(*args),
        "restitution": 1.0,
    }


def _compare_law(
    where: str, velocity: float, run: xr.Dataset, law: LawOnHalfSpace, mass: float
) -> Comparisons:
    """Compare restitution, peak force, dent and dissipation of a sphere of `mass` (kg)."""
    # Larger than for smooth laws: a jump of the force falls within a time step.
    tolerance = 1e-4
    deepest, restitution = law.maximum_indentation(velocity, mass), law.restitution(velocity, mass)
    peak, force = run.peak_force.item(), law.loading_force(deepest)
    # The dent passes through zero, hence its error is relative to the largest indentation.
    dent = run.permanent_indentation.item() / deepest
    left = law.residual_indentation(deepest) / deepest
    lost = run.contact_dissipation.item() / (0.5 * mass * velocity**2)
    share = 1.0 - restitution**2
    comparisons = Comparisons(where)
    comparisons.absolute("restitution", "1", run.restitution.item(), restitution, tolerance)
    comparisons.relative("peak force", "N", peak, force, tolerance)
    comparisons.absolute("dent over indentation", "1", dent, left, tolerance)
    return comparisons.absolute("share of energy lost", "1", lost, share, tolerance)


VELOCITIES = (0.012, 0.03, 0.1, 0.3, 0.99, 3.0, 10.0)
"""In m/s, from just above the first yield of all laws but Hertz's."""
DRAWN = 0.99  # velocity in m/s of the curves of force against indentation
_QUADRATURE = "quadrature of the law"


@check(
    "All contact laws on a half-space",
    "each law from its formulas, integrated by adaptive quadrature: "
    "impactlab.verification.solutions.contact_laws, which names the papers",
    Reference("quadrature", 1e-10, "tolerances of quadrature and bisection"),
)
def contact_laws() -> Finding:
    """Compare restitution, peak force, dent and dissipation of each law at its worst velocity.

    Laws that create energy do so here, too: a restitution above 1 must appear in both solutions.
    """
    comparisons = Comparisons()
    forces: list[Curve] = []
    against_velocity: dict[str, list[Curve]] = {"restitution": [], "permanent_indentation": []}
    fine = np.geomspace(VELOCITIES[0], VELOCITIES[-1], 61)
    for name in LAWS:
        impact = rigid_backed(DRAWN, name)
        law, mass = law_on_half_space(impact), impact.sphere.total_mass
        runs, table = {}, []
        for velocity in VELOCITIES:
            # Until the sphere has left: at most Hertz's contact time and that of full plasticity.
            duration = 0.5e-3 * (DRAWN / velocity) ** 0.2 + 0.2e-3
            impact = rigid_backed(velocity, name)
            run = runs[velocity] = run_dataset(impact, _GRID, duration=duration, samples=401)
            where = f"{name}, {velocity:.3g} m/s"
            table.append(_compare_law(where, velocity, run, law, mass))
        comparisons.worst(table)
        forces += _force_curves(runs[DRAWN], law, mass)
        deepest = [law.maximum_indentation(float(v), mass) for v in fine]
        expected = {
            "restitution": [law.restitution(float(v), mass) for v in fine],
            "permanent_indentation": [law.residual_indentation(depth) for depth in deepest],
        }
        for variable, curves in against_velocity.items():
            ours = np.array([run[variable].item() for run in runs.values()])
            curves.append(Curve(name, np.array(VELOCITIES), ours))
            curves.append(Curve(_QUADRATURE, fine, np.array(expected[variable]), independent=True))
    restitutions, dents = against_velocity.values()
    axes = ("indentation", "m"), ("contact force", "N")
    dent = ("permanent indentation", "m")
    panels = [
        CurvePanel(f"force against indentation at {DRAWN} m/s", *axes, forces),
        CurvePanel("restitution against velocity", _VELOCITY, _RESTITUTION, restitutions, log=True),
        CurvePanel("permanent indentation against velocity", _VELOCITY, dent, dents, log=True),
    ]
    return Finding(comparisons, panels)


def _force_curves(run: xr.Dataset, law: LawOnHalfSpace, mass: float) -> list[Curve]:
    touching = run.contact_force.values > 0
    ours = run.indentation.values[touching], run.contact_force.values[touching]
    depth = np.linspace(1e-3, 1.0, 101) * law.maximum_indentation(DRAWN, mass)
    force = np.array([law.loading_force(float(d)) for d in depth])
    return [Curve(law.law, *ours), Curve(_QUADRATURE, depth, force, independent=True)]


@check(
    "Viscous contact on a half-space",
    "Hunt and Crossley 1975; the first integral in impactlab.verification.solutions.hertz",
    Reference("quadrature", 1e-10, "tolerances of quadrature and bisection"),
)
def viscous_contact() -> Finding:
    """Compare restitution, peak force, indentation and dissipation, and the order in time."""
    tables, restitutions = [], []
    for velocity in VELOCITIES:
        impact = replace(rigid_backed(velocity, "hunt_crossley"), beam_model="rigid")
        runs = [_run_rigid_beam(impact, courant=courant) for courant in (1.0, 0.5)]
        mass, exact = impact.sphere.total_mass, _viscous(impact)
        expected = {
            "restitution": exact.restitution,
            "peak_force": exact.peak_force,
            "maximum_indentation": exact.maximum_indentation,
            "contact_dissipation": 0.5 * mass * velocity**2 * (1.0 - exact.restitution**2),
        }
        where = f"{velocity:g} m/s"
        tables.append(Comparisons(where).responses(runs[1], expected, RIGID_TOLERANCE))
        restitutions.append(runs[1].restitution.item())
    comparisons = Comparisons().worst(tables)
    coarse, fine = (run.restitution.item() - exact.restitution for run in runs)  # of the fastest
    label, order = "order of restitution in the time step", float(np.log2(coarse / fine))
    comparisons += Comparisons(where).absolute(label, "1", order, 2.0, 0.1)
    speeds = np.geomspace(VELOCITIES[0], VELOCITIES[-1], 61)
    impacts = [_viscous(rigid_backed(float(speed), "hunt_crossley")) for speed in speeds]
    expected_curve = np.array([impact.restitution for impact in impacts])
    curves = [
        Curve("hunt_crossley", np.array(VELOCITIES), np.array(restitutions)),
        Curve("first integral", speeds, expected_curve, independent=True),
    ]
    panel = CurvePanel("restitution against velocity", _VELOCITY, _RESTITUTION, curves, log=True)
    return Finding(comparisons, [panel])


def _viscous(impact: Impact) -> HuntCrossleyImpact:
    mass, stiffness = impact.sphere.total_mass, hertz.contact_stiffness(impact)
    return HuntCrossleyImpact(mass, impact.velocity, stiffness)


HISTORIES = "contact_force", "midspan_deflection", "sphere_displacement", "indentation"
SPRING_MASS_TOLERANCE = 2e-6
_NODES, _SAMPLES = 101, 401
_FORCE_AXES = ("time", "s"), ("contact force", "N")

_PAPER = elastic(paper_impact(0.99))
_SLENDER = replace(_PAPER, beam=replace(_PAPER.beam, depth=0.008, width=0.02))
CASES = {
    "the paper's beam": Sweep(_PAPER, (0.1, 0.99, 5.0, 20.0), 0.5e-3),
    "a slender beam": Sweep(_SLENDER, (0.2, 1.0), 20e-3),
}
"""A heavy sphere touches the slender beam more than once."""


@check(
    "Spring-mass model",
    "Rayleigh's mass 17/35 rho A L and stiffness 48 EI/L^3, DOP853 of scipy, in "
    "impactlab.verification.solutions.hertz",
    Reference("quadrature", 4e-8, "what a tolerance of 1e-10 for 1e-12 changes"),
)
def spring_mass() -> Finding:
    """Compare histories, responses, the curvature, and the order in the time step."""
    comparisons = Comparisons()
    for beam, case in CASES.items():
        table = []
        for velocity in case.velocities:
            impact = replace(case.impact, velocity=velocity)
            table.append(_compare_spring_mass(f"{beam}, {velocity:g} m/s", impact, case.duration))
        comparisons.worst(table)
    where, duration = "the paper's beam, 0.99 m/s", CASES["the paper's beam"].duration
    exact = hertz.solve_spring_mass(_PAPER, duration)
    runs = [_run_spring_mass(_PAPER, duration, courant) for courant in (1.0, 0.5)]
    gaps = [run.indentation.values - exact.at("indentation", run.time.values) for run in runs]
    coarse, fine = (float(np.sqrt(np.mean(gap**2))) for gap in gaps)
    label, observed = "order of convergence in the time step", float(np.log2(coarse / fine))
    comparisons += Comparisons(where).absolute(label, "1", observed, 2.0, 0.1)
    time = np.linspace(0.0, duration, _SAMPLES)
    series = modal.solve(_PAPER, duration)
    curves = [
        Curve("spring-mass model", time, runs[1].contact_force.values),
        Curve("spring-mass model, DOP853", time, exact.at("contact_force", time), True),
        # whose mass resists only gradually
        Curve("elastic beam, modal series", time, series.at("contact_force", time), True),
    ]
    return Finding(comparisons, [CurvePanel(where, *_FORCE_AXES, curves)])


def _run_spring_mass(impact: Impact, duration: float, courant: float = 0.5) -> xr.Dataset:
    grid = Discretisation(nodes=_NODES, points=3, courant=courant)
    model = replace(impact, beam_model="spring_mass")
    return run_dataset(model, grid, duration=duration, samples=_SAMPLES)


def _compare_spring_mass(where: str, impact: Impact, duration: float) -> Comparisons:
    """Compare one impact; curvature with -12 w/L^2."""
    run = _run_spring_mass(impact, duration)
    exact, time = hertz.solve_spring_mass(impact, duration), run.time.values
    comparisons = Comparisons(where)
    histories = {name: exact.at(name, time) for name in HISTORIES}
    comparisons.histories(run, histories, SPRING_MASS_TOLERANCE)
    # of the curvature the finite differences have (1 - 2/(nodes - 1)^2)
    label, tolerance = "history of mid-span curvature", 2.5 / (_NODES - 1) ** 2
    curvature = -12.0 / impact.beam.span**2 * exact.at("midspan_deflection", time)
    comparisons.curve(label, "m-1", run.midspan_curvature.values, curvature, tolerance)
    expected = {"peak_force": exact.peak_force, "contact_duration": exact.contact_duration}
    comparisons.responses(run, expected, SPRING_MASS_TOLERANCE)
    count, contacts = run.number_of_contacts.item(), float(len(exact.contacts))
    return comparisons.absolute("number of contacts", "1", count, contacts, 0.0)


RIGID_TOLERANCE = 5e-6


@check(
    "Rigid beam",
    "Hertz 1881; Stronge, Impact Mechanics (2000), section 6.4; DOP853 of scipy, in "
    "impactlab.verification.solutions.hertz and .contact_laws",
    Reference("quadrature", 4e-8, "what a tolerance of 1e-10 for 1e-12 changes"),
)
def rigid_beam() -> Finding:
    """Compare Hertz's and Stronge's impact at four velocities, and a slow one under gravity."""
    hertzian, plastic = [], []
    for velocity in (0.1, 0.99, 5.0, 20.0):
        impact = replace(paper_impact(velocity, "hertz"), gravity=0.0)
        run, table = _run_rigid_beam(impact), Comparisons(f"Hertz contact, {velocity:g} m/s")
        table.responses(run, _hertzian(impact), RIGID_TOLERANCE)
        hertzian.append(table.absolute("deflection", "m", run.maximum_deflection.item(), 0.0, 0.0))

        impact = replace(impact, contact="stronge")
        law, mass = stronge_impact(impact), impact.sphere.total_mass
        deepest = law.maximum_indentation(velocity, mass)
        expected = {
            "peak_force": law.loading_force(deepest),
            "maximum_indentation": deepest,
            "restitution": law.restitution(velocity, mass),
        }
        run, table = _run_rigid_beam(impact), Comparisons(f"Stronge contact, {velocity:g} m/s")
        plastic.append(table.responses(run, expected, RIGID_TOLERANCE))
    impact = paper_impact(0.02, "hertz")
    run = _run_rigid_beam(impact, samples=401)
    duration, time = run.duration.item(), run.time.values
    exact, bare = (hertz.solve(replace(impact, gravity=g), duration) for g in (9.81, 0.0))
    slow = Comparisons("Hertz contact under gravity, 0.02 m/s")  # it adds 11 % to the peak force
    ours, force = run.contact_force.values, exact.at("contact_force", time)
    expected = {"peak_force": exact.peak_force, "contact_duration": exact.contact_duration}
    slow.histories(run, {"contact_force": force}, RIGID_TOLERANCE)
    slow.responses(run, expected, RIGID_TOLERANCE)
    curves = [
        Curve("solver", time, ours),
        Curve("DOP853", time, force, independent=True),
        Curve("DOP853 without gravity", time, bare.at("contact_force", time), independent=True),
    ]
    title = "the paper's sphere on a rigid beam, 0.02 m/s"
    comparisons = Comparisons().worst(hertzian).worst(plastic)
    return Finding([*comparisons, *slow], [CurvePanel(title, *_FORCE_AXES, curves)])


def _run_rigid_beam(impact: Impact, samples: int = 2, courant: float = 0.9) -> xr.Dataset:
    """Solve on a rigid beam until the sphere has left."""
    model = replace(impact, beam_model="rigid")
    grid = Discretisation(nodes=11, points=3, courant=courant)
    duration = 2.0 * hertz.contact_duration(*hertz.arguments(impact))
    return run_dataset(model, grid, duration=duration, samples=samples)
