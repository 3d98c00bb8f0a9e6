"""The yielding beam in OpenSees (extra `opensees`), struck by a given force history.

Half the beam, or all of it where struck beside its middle: displacement-based elements with cubic
shape functions and lumped mass, corotational where the axis is held, three Lobatto sections each,
elastic-perfectly plastic, of the same fibres as ours (a rectangle), or of layers of each flange and
of the web (an I-section, a box); elastic ends on springs to fixed nodes; Newmark's average
acceleration with Newton's iterations.
Source: F. McKenna, Comput. Sci. Eng. 13 (2011) 58.
"""

from __future__ import annotations

import numpy as np
import openseespy.opensees as ops

import impactlab as il
from impactlab.model.discretisation import integration_rule

POINTS = 9
LAYERS = {"flange": 8, "web": 40}


def fibres_of(beam: il.Beam) -> list[tuple[float, float]]:
    """Return the fibres: distance from the axis (m) and area (m2)."""
    if beam.shape == "rectangle":
        z, _ = integration_rule("lobatto", POINTS)
        legendre = np.polynomial.legendre.Legendre.basis(POINTS - 1)(z)
        areas = beam.width * beam.depth / (POINTS * (POINTS - 1) * legendre**2)
        return list(zip((0.5 * beam.depth * z).tolist(), areas.tolist(), strict=True))
    flange = beam.wall_thickness or beam.flange_thickness
    web, edge = beam.web_thickness or 2.0 * beam.wall_thickness, 0.5 * beam.depth
    plates = [(-edge, flange - edge, beam.width, "flange")]
    plates += [
        (flange - edge, edge - flange, web, "web"),
        (edge - flange, edge, beam.width, "flange"),
    ]
    fibres = []
    for low, high, width, name in plates:
        thickness = (high - low) / LAYERS[name]
        middles = low + thickness * (np.arange(LAYERS[name]) + 0.5)
        fibres += [(z, width * thickness) for z in middles.tolist()]
    return fibres


def strike(  # noqa: C901
    beam: il.Beam,
    force: np.ndarray,
    duration: float,
    elements: int,
    steps: int,
    *,
    held: bool = False,
    place: float = 0.5,
) -> tuple[float, float]:
    """Return the largest deflection under the force (m) and the plastic dissipation (J).

    force (N): equally spaced from 0 to the duration (s). elements: over half the span. held:
    whether the supports hold the axis. place: of the force, as a share of the span.
    """
    halved = place == 0.5
    steel, dx = beam.material, 0.5 * beam.span / elements
    elements = elements if halved else 2 * elements
    E, fibres = steel.youngs_modulus, fibres_of(beam)
    mass = steel.density * sum(area for _, area in fibres)
    middle, inside = round(place * beam.span / dx) + 1, range(1, elements + 1)
    share = 0.5 if halved else 1.0

    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for node in range(elements + 1):
        ops.node(node + 1, node * dx, 0.0)
    for end, support in ((1, beam.support_left), (elements + 1, beam.support_right))[: 2 - halved]:
        elastic = support == "elastic"
        ops.fix(end, int(held), int(not elastic), int(support == "clamped"))
    if halved:
        ops.fix(middle, 1, 0, 1)
    springs = {}
    for side, end in (("left", 1), ("right", elements + 1))[: 2 - halved]:
        if getattr(beam, f"support_{side}") == "elastic":
            lift, turn = (getattr(beam, f"{of}stiffness_{side}") for of in ("", "rotational_"))
            springs[end] = lift, turn
            ops.node(1000 + end, ops.nodeCoord(end, 1), 0.0)
            ops.fix(1000 + end, 1, 1, 1)
            tags = 10 * end, 10 * end + 1
            for tag, stiffness in zip(tags, springs[end], strict=True):
                ops.uniaxialMaterial("Elastic", 10_000 + tag, stiffness)
            numbers = [10_000 + tag for tag in tags]
            ops.element("zeroLength", 1000 + end, 1000 + end, end, "-mat", *numbers, "-dir", 2, 6)
    ops.uniaxialMaterial("ElasticPP", 1, E, steel.yield_stress / E)
    ops.section("Fiber", 1)
    for y, area in fibres:
        ops.fiber(y, 0.0, area, 1)
    ops.geomTransf("Corotational" if held else "Linear", 1)
    ops.beamIntegration("Lobatto", 1, 1, 3)
    for k in inside:
        ops.element("dispBeamColumn", k, k, k + 1, 1, 1, "-mass", mass)
    spacing = duration / (force.size - 1)
    ops.timeSeries("Path", 1, "-dt", spacing, "-values", *(share * force).tolist())
    ops.pattern("Plain", 1, 1)
    ops.load(middle, 0.0, 1.0, 0.0)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandSPD")
    ops.test("NormDispIncr", 1e-12, 20)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")

    w = np.zeros(steps + 1)
    for step in range(steps):
        if ops.analyze(1, duration / steps):
            raise RuntimeError(f"OpenSees: no convergence in step {step}")
        w[step + 1] = ops.nodeDisp(middle, 2)

    F = np.interp(np.linspace(0.0, 1.0, steps + 1), np.linspace(0.0, 1.0, force.size), force)
    work = float(np.sum(0.5 * (F[1:] + F[:-1]) * np.diff(w)))
    moving = sum(mass * dx * ops.nodeVel(k, i) ** 2 for k in range(2, elements + 1) for i in (1, 2))
    moving += 0.5 * mass * dx * sum(ops.nodeVel(k, 2) ** 2 for k in (1, elements + 1))
    moving *= 1.0 if halved else 0.5
    stored = (1.0 if halved else 0.5) * sum(
        lift * ops.nodeDisp(end, 2) ** 2 + turn * ops.nodeDisp(end, 3) ** 2
        for end, (lift, turn) in springs.items()
    )
    per_element = dx if halved else 0.5 * dx
    for k in inside:
        for section, weight in enumerate((1.0, 4.0, 1.0), start=1):
            place = (k, "section", section, "fiber")
            for y, area in fibres:
                stress = ops.eleResponse(*place, y, 0.0, "stressStrain")[0]
                stored += weight / 6.0 * per_element * area * stress**2 / E
    return float(w.max()), work - moving - stored
