"""The beam bent slowly and beyond yield: section, static load, collapse, and one plastic hinge."""

import math
from dataclasses import replace

import numpy as np
import xarray as xr

from impactlab.model.bodies import Beam, Sphere
from impactlab.model.case_table import case_table
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.material import Material
from impactlab.simulate import run_dataset
from impactlab.solve import fibre_section
from impactlab.solver import RULES, section
from impactlab.types import Floats
from impactlab.verification.cases import with_beam_material
from impactlab.verification.finding import (
    CLOSED_FORM,
    ROUNDING,
    Comparisons,
    Curve,
    CurvePanel,
    Finding,
    Reference,
    check,
)
from impactlab.verification.solutions import beam_modes, bending, fibre_beam

_HARDENING = {
    "perfectly plastic": {},
    "isotropic 10 GPa": {"isotropic_hardening_modulus": 10e9},
    "kinematic 10 GPa": {"kinematic_hardening_modulus": 10e9},
}
_POINTS = (2, 3, 4, 9, 21)


@check(
    "Moment and curvature",
    "Masing 1926; stresses clipped fibre by fibre in impactlab.verification.solutions.bending",
    CLOSED_FORM,
)
def moment_curvature() -> Finding:
    """Compare two loops of each hardening: rules with their fibres, a fine one with M.

    240 steps go out, back through zero to the other side, and out.
    """
    turn = 6.0  # largest curvature over that at first yield
    out = np.linspace(0.0, turn, 41)[1:]
    back = np.linspace(turn, -turn, 101)[1:]
    path = np.concatenate([out, back, back[::-1]])
    comparisons = Comparisons()
    curves = []
    for name, moduli in _HARDENING.items():
        beam = with_beam_material(paper_impact(), **moduli).beam
        kappa = path * bending.yield_curvature(beam)
        ours, expected = [], []
        for rule in RULES:
            for points in _POINTS:
                ours.append(_moments(beam, rule, points, kappa))
                expected.append(bending.path_moments(beam, kappa, *bending.rule(rule, points)))
        where = f"{name}; every rule with {', '.join(map(str, _POINTS))} points, its own fibres"
        fibres = np.concatenate(ours), np.concatenate(expected)
        fine, exact = _moments(beam, "legendre", 100, kappa), _exact_moments(beam, kappa)
        exact_where = f"{name}; 100 Gauss-Legendre points, the exact section"
        comparisons.at(where).curve("moment", "N m", *fibres, 1e-12)
        comparisons.at(exact_where).curve("moment", "N m", fine, exact, 5e-4)
        curves.append(Curve(name, kappa, fine))
        curves.append(Curve(f"{name}, exact", kappa, exact, independent=True))
    axes = ("curvature", "m-1"), ("bending moment", "N m")
    return Finding(comparisons, [CurvePanel("Bent to and fro", *axes, curves)])


def _moments(beam: Beam, rule: str, points: int, curvatures: Floats) -> Floats:
    """Return the moments (N m) of the solver's section along a path of curvatures (1/m)."""
    impact = replace(paper_impact(), beam=beam)
    grid = Discretisation(rule=rule, points=points)
    cut = fibre_section(case_table(impact, grid, duration=1.0)[0])
    strain, peeq = np.zeros((1, points // 2)), np.zeros((1, points // 2))
    moments = []
    for kappa in curvatures:
        moment, _, _ = section.bend(cut, float(kappa), strain, peeq, 0)
        moments.append(cut.stiffness * kappa - moment)
    return np.array(moments)


def _exact_moments(beam: Beam, kappa: Floats) -> Floats:
    """Return Masing's closed form or, for isotropic hardening, the moments of 2000 fibres."""
    if beam.material.isotropic_hardening_modulus:
        return bending.path_moments(beam, kappa, *bending.rule("legendre", 2000))
    farthest = int(np.argmax(kappa))
    lowest, turn = int(np.argmin(kappa)), float(kappa[farthest])
    return np.concatenate(
        [
            bending.moment(beam, kappa[:farthest]),
            bending.moment_after_turn(beam, turn, kappa[farthest:lowest]),
            -bending.moment_after_turn(beam, turn, -kappa[lowest:]),
        ]
    )


@check(
    "Static deflection",
    "Closed forms of beam bending, with the integration rule's own stiffness",
    Reference(
        "closed form", ROUNDING, "rounding; that the beam still swings a little is not counted"
    ),
)
def static_deflection() -> Finding:
    """Compare deflection and curvature at mid-span with the load, over 1.2 s: 130 periods.

    And of a Timoshenko beam of a fourth of the span, where shear adds 6.3 % to the deflection, over
    0.1 s: 160 of its periods.
    """
    beam = paper_impact().beam
    impact = _slow_impact(beam, mass=8e4, velocity=0.02, softness=50e-3)
    comparisons = Comparisons()
    panels: list[CurvePanel] = []
    for rule, points in (("lobatto", 9), ("lobatto", 2), ("layers", 5)):
        run = run_dataset(impact, Discretisation(nodes=101, points=points, rule=rule), duration=1.2)
        positions, weights = bending.rule(rule, points)
        # The rule's second moment of area over the exact one.
        force = run.contact_force.values / float(1.5 * np.sum(weights * positions**2))
        expected = _bent(beam, force, bending.static_deflection(beam, 1.0))
        comparisons.at(f"the paper's beam, {points} points ({rule})").histories(run, expected, 1e-3)
        if not panels:
            curves = [
                Curve("solver", run.time.values, run.midspan_deflection.values),
                Curve("F L³/(48 EI)", run.time.values, expected["midspan_deflection"], True),
            ]
            axes = ("time", "s"), ("deflection at mid-span", "m")
            panels = [CurvePanel(comparisons.where, *axes, curves)]

    beam = replace(beam, span=0.25 * beam.span)
    impact = _slow_impact(beam, mass=8e4, velocity=0.24, softness=50e-3)
    grid = Discretisation(nodes=101, points=3)
    run = run_dataset(replace(impact, beam_model="timoshenko"), grid, duration=0.1)
    softness = bending.static_deflection(beam, 1.0) + beam_modes.shear_deflection(beam, 1.0)
    expected = _bent(beam, run.contact_force.values, softness)
    comparisons.at("a stubby Timoshenko beam, 3 points (lobatto)").histories(run, expected, 1e-3)
    return Finding(comparisons, panels)


def _bent(beam: Beam, force: Floats, softness: float) -> dict[str, Floats]:
    """Return the histories of a beam at rest under a force (N) at mid-span; softness in m/N."""
    curvature = -force * beam.span / (4.0 * beam.bending_stiffness)
    return {"midspan_deflection": force * softness, "midspan_curvature": curvature}


def _slow_impact(beam: Beam, mass: float, velocity: float, softness: float) -> Impact:
    """Return a striker of `mass` (kg) at `velocity` (m/s) on `beam`, without gravity.

    Its Hertz contact gives 20 kN at an indentation of `softness` (m), and F ~ delta^1.5 starts
    without a jump in the rate of loading, so that the beam follows without swinging.
    """
    stiffness, radius = 20e3 / softness**1.5, 3.5
    modulus = (1.0 - 0.3**2) * 0.75 * stiffness / math.sqrt(radius)  # the beam is rigid beside it
    soft = Material(
        density=7800.0, youngs_modulus=modulus, poissons_ratio=0.3, yield_stress=0.1 * modulus
    )
    sphere = Sphere(radius=radius, material=soft, mass=mass)
    return replace(paper_impact(velocity, "hertz"), sphere=sphere, beam=beam, gravity=0.0)


@check(
    "Static collapse",
    "Prager and Hodge 1951, chapter 2; impactlab.verification.solutions.bending",
    Reference("quadrature", 1e-9, "tolerances of quadrature and bisection; a swing is not counted"),
)
def static_collapse() -> Finding:
    """Compare load against deflection, plateau, permanent deflection; plateaus of coarse rules.

    The coarse rules have plastic moments of their own, which are not the section's.
    """
    perfect = paper_impact().beam
    hardening = with_beam_material(paper_impact(), isotropic_hardening_modulus=5e9).beam
    run, harder = (_run_collapse(beam, "layers", 40) for beam in (perfect, hardening))
    largest = 30e-3  # m; every run exceeds it
    comparisons = Comparisons()
    curves = []
    for dataset, beam, where, tolerance, label in (
        (run, perfect, "elastic-perfectly plastic, 40 layers", 8e-3, "perfectly plastic"),
        (harder, hardening, "isotropic hardening 5 GPa, 40 layers", 4e-3, "hardening 5 GPa"),
    ):
        points = np.linspace(0.5e-3, largest, 100)
        ours, expected = np.interp(points, *_on_loading(dataset)), _static(beam, points)
        comparisons.at(where).curve("load by deflection", "N", ours, expected, tolerance)
        deflection, force = dataset.midspan_deflection.values, dataset.contact_force.values
        points = np.linspace(0.5e-3, largest, 60)
        curves.append(Curve(label, deflection, force))
        curves.append(Curve(f"{label}, static", points, _static(beam, points), independent=True))
    limit = bending.collapse_load(perfect)
    comparisons.at("40 layers; 4 M_p/L")
    comparisons.relative("collapse load", "N", _plateau(run), limit, 5e-4)
    far = np.array([1e3 * bending.yield_curvature(perfect)])
    for number in (3, 9):
        rule = bending.rule("lobatto", number)
        plastic_load = 4.0 / perfect.span * bending.path_moments(perfect, far, *rule).item()
        plateau = _plateau(_run_collapse(perfect, "lobatto", number))
        comparisons.at(f"{number} Lobatto points; 4/L times the rule's own plastic moment")
        comparisons.relative("collapse load", "N", plateau, plastic_load, 5e-4)
    # The striker leaves slowly, the beam springs back elastically.
    deflection = run.midspan_deflection.values
    left = float(deflection.max()) - bending.static_deflection(perfect, limit)
    permanent = float(deflection[-400:].mean())
    comparisons.at("40 layers; largest deflection less P_c L^3/(48 EI)")
    comparisons.relative("permanent deflection", "m", permanent, left, 1e-3)
    axes = ("deflection at mid-span", "m"), ("load at mid-span", "N")
    return Finding(comparisons, [CurvePanel("Loading to collapse, and back", *axes, curves)])


def _run_collapse(beam: Beam, rule: str, points: int) -> xr.Dataset:
    """Solve over 1 s, 107 periods: the striker stops, and has left after 0.86 s."""
    impact = _slow_impact(beam, mass=4e4, velocity=0.2, softness=20e-3)
    grid = Discretisation(nodes=101, points=points, rule=rule)
    return run_dataset(impact, grid, duration=1.0, samples=4001)


def _on_loading(run: xr.Dataset) -> tuple[Floats, Floats]:
    """Return (deflection, force) at mid-span until the deflection is largest."""
    deflection, force = run.midspan_deflection.values, run.contact_force.values
    until = int(np.argmax(deflection)) + 1
    return deflection[:until], force[:until]


def _static(beam: Beam, deflections: Floats) -> Floats:
    return np.array([bending.load_at(beam, float(w)) for w in deflections])


def _plateau(run: xr.Dataset) -> float:
    """Return the mean load in N once the hinge has formed, which averages out vibrations."""
    deflection, force = _on_loading(run)
    # constant above 20/9 of the 6.1 mm at first yield
    return float(force[deflection > 20e-3].mean())


_MODE_GRID = Discretisation(nodes=101, points=40, rule="layers")


@check(
    "Rigid-plastic mode",
    "Martin and Symonds 1966; Jones, Structural Impact; impactlab.verification.solutions.bending",
    Reference(
        "limit",
        np.nan,
        "the elastic deflection that the mode alone leaves out; what is left out beside it is "
        "not known",
        {"permanent deflection.*; mode$": 3.5e-3},
    ),
)
def rigid_plastic_mode() -> Finding:
    """Compare permanent deflection and duration with the mode, and the approach to it."""
    comparisons = Comparisons()
    # Kinetic energy over the largest elastic energy of the beam; mass of the striker over that of
    # the beam, whose momentum matters more, the lighter: 6 % at 5.
    ratios, heavy = np.array([10.0, 30.0, 100.0, 300.0]), 100.0
    for mass in (heavy, 20.0, 5.0):
        impact, run = _struck(mass, ratio := float(ratios[-1]))
        comparisons.at(f"energy ratio {ratio:g}, mass ratio {mass:g}; mode")
        left, deflection = _permanent_deflection(run), bending.mode_deflection(impact)
        stop = float(run.time[int(np.argmax(run.midspan_deflection.values))])
        comparisons.relative("permanent deflection", "m", left, deflection, 1e-2)
        time = bending.mode_duration(impact)
        comparisons.relative("time to the largest deflection", "s", stop, time, 1e-2)
    permanents, modes, expected = [], [], []
    for ratio in ratios.tolist():
        impact, run = _struck(heavy, ratio)
        permanents.append(_permanent_deflection(run))
        modes.append(bending.mode_deflection(impact))
        expected.append(bending.elastic_plastic_deflection(impact))
        where = f"energy ratio {ratio:g}, mass ratio {heavy:g}; mode and elastic bending"
        values = permanents[-1], expected[-1]
        comparisons.at(where).relative("permanent deflection", "m", *values, 5e-3)
    final = np.array(modes)
    shortfall = 1.0 - np.array(expected) / final
    curves = [
        Curve("solver", ratios, 1.0 - np.array(permanents) / final),
        Curve("mode and elastic bending", ratios, shortfall, independent=True),
    ]
    x = ("kinetic energy over the beam's elastic capacity", "1")
    y = ("shortfall of the permanent deflection from the mode's", "1")
    title = "The rest is elastic: it falls with the energy ratio"
    return Finding(comparisons, [CurvePanel(title, x, y, curves, log=True)])


def _struck(mass_ratio: float, energy_ratio: float) -> tuple[Impact, xr.Dataset]:
    """Return an impact without gravity, and its run until somewhat after the beam has stopped."""
    # yield at so low a stress that both the elastic deflection and the rotation are small
    paper = with_beam_material(paper_impact(1.0, "hertz"), yield_stress=20e6)
    mass = mass_ratio * paper.beam.mass_per_length * paper.beam.span
    slow = replace(paper, sphere=replace(paper.sphere, mass=mass), gravity=0.0)
    impact = replace(slow, velocity=math.sqrt(energy_ratio / bending.energy_ratio(slow)))
    duration = 1.3 * bending.mode_duration(impact) + 5e-3
    return impact, run_dataset(impact, _MODE_GRID, duration=duration, samples=4001)


def _permanent_deflection(run: xr.Dataset) -> float:
    """Return the deflection (m) that the plastic strains leave, by the unit-load theorem."""
    _, weights = bending.rule(_MODE_GRID.rule, _MODE_GRID.points)
    x, z = run.x.values, run.z.values
    curvature = run.plastic_strain.values @ (weights * z) / (weights @ z**2)
    near = np.minimum(x, x[-1] - x)
    return float(np.trapezoid(0.5 * curvature * near, x))


STRUCK = {
    "perfectly plastic, 15 m/s": paper_impact(15.0),
    "isotropic hardening 20 GPa, 20 m/s": with_beam_material(
        paper_impact(20.0), isotropic_hardening_modulus=20e9
    ),
}
ELEMENTS, STEPS, STRUCK_DURATION = 32, 500, 0.5e-3
FIBRE_TOLERANCES = {
    "contact_force": 4e-3,
    "midspan_deflection": 1e-3,
    "peak_force": 5e-4,
    "plastic_dissipation": 1e-2,
}
"""Of histories and responses: more than twice what the fibre solution changes by with twice the
elements and steps."""


@check(
    "Yielding beam: fibre elements",
    "cubic elements with fibre sections, Newmark's average acceleration, in "
    "impactlab.verification.solutions.fibre_beam; McKenna, Comput. Sci. Eng. 13 (2011) 58",
    Reference(
        "finite elements",
        2.5e-3,
        "what twice the elements and steps change",
        {"contact force": 1.8e-3, "deflection": 2.5e-4, "peak force": 1.5e-5},
    ),
)
def fibre_elements() -> Finding:
    """Compare both schemes with an implicit solution of sphere, contact, beam and fibres."""
    comparisons = Comparisons()
    panels: list[CurvePanel] = []
    for name, impact in STRUCK.items():
        exact = fibre_beam.solve(impact, STRUCK_DURATION, elements=ELEMENTS, steps=STEPS)
        curves = []
        for scheme, nodes in (("leapfrog", 401), ("modal", 201)):
            comparisons.at(f"{scheme}: {name}")
            grid = Discretisation(nodes=nodes, scheme=scheme)
            run = run_dataset(impact, grid, duration=STRUCK_DURATION, samples=STEPS + 1)
            for variable, tolerance in FIBRE_TOLERANCES.items():
                compare = comparisons.histories if run[variable].dims else comparisons.responses
                compare(run, {variable: getattr(exact, variable)}, tolerance)
            curves.append(Curve(f"{scheme}, {nodes} nodes", exact.time, run.contact_force.values))
        curves.append(Curve("fibre elements", exact.time, exact.contact_force, independent=True))
        panels.append(CurvePanel(name, ("time", "s"), ("contact force", "N"), curves))
    return Finding(comparisons, panels)
