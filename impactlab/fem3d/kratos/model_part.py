"""The mesh as Kratos' model part, filled before a run and read after each step.

Kratos counts from 1: its node i + 1 is the mesh's node i.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from impactlab.fem3d.kratos.engine import BEAM_TOP, MM, MPA, SPHERE_BOTTOM, TONNES_PER_MM3, Engine
from impactlab.fem3d.solver import Mesh
from impactlab.fem3d.solver.mesh import BEAM, SPHERE
from impactlab.fem3d.solver.mesh.mesh import Floats, Integers, sphere_density
from impactlab.model.impact import Impact, Material

ELEMENT, LAW, FACE = "SmallDisplacementBbarElement3D8N", "SmallStrainJ2Plasticity3DLaw", 4


def fill(engine: Engine, part: Any, mesh: Mesh, impact: Impact) -> None:
    """Put the mesh into the empty model part `part`, which must know its variables.

    Raises ValueError for a material with kinematic hardening, which Kratos' law does not have.
    """
    for number, place in enumerate((mesh.nodes * MM).tolist(), 1):
        part.CreateNewNode(number, *place)
    steels = {
        BEAM: _steel(engine, part, 1, impact.beam.material, impact.beam.material.density),
        SPHERE: _steel(engine, part, 2, impact.sphere.material, sphere_density(mesh, impact)),
    }
    of_element = zip((mesh.elements + 1).tolist(), mesh.body.tolist(), strict=True)
    for number, (nodes, body) in enumerate(of_element, 1):
        part.CreateNewElement(ELEMENT, number, nodes, steels[body])
    first = 1
    for name, quads, body in (
        (SPHERE_BOTTOM, _quads(mesh.pairs[:, 0])[:, ::-1], SPHERE),
        (BEAM_TOP, _quads(mesh.pairs[:, 1]), BEAM),
    ):
        surface = part.CreateSubModelPart(name)
        surface.AddNodes(np.unique(quads + 1).tolist())
        for number, nodes in enumerate((quads + 1).tolist(), first):
            surface.CreateNewCondition(f"SurfaceCondition3D{FACE}N", number, nodes, steels[body])
        first += len(quads)


def hold(engine: Engine, part: Any, mesh: Mesh) -> None:
    """Fix the nodes in the planes of symmetry and on the supports."""
    held = {"X": mesh.symmetry_x, "Y": mesh.symmetry_y, "Z": mesh.support}
    for axis, nodes in held.items():
        variable = engine.variable(f"DISPLACEMENT_{axis}")
        for node in (nodes + 1).tolist():
            part.GetNode(node).Fix(variable)


def launch(engine: Engine, part: Any, mesh: Mesh, impact: Impact) -> None:
    """Set the sphere's velocity, now and in the step before, and gravity, for it alone."""
    given = {"VELOCITY_Z": impact.velocity, "VOLUME_ACCELERATION_Z": impact.gravity}
    for node in (np.unique(mesh.elements[mesh.body == SPHERE]) + 1).tolist():
        for name, value in given.items():
            for step in (0, 1):
                part.GetNode(node).SetSolutionStepValue(engine.variable(name), step, -value * MM)


def _steel(engine: Engine, part: Any, number: int, material: Material, density: float) -> Any:
    """Return Kratos' properties of a material; density in kg/m3."""
    if material.kinematic_hardening_modulus > 0.0:
        raise ValueError(
            f"kinematic_hardening_modulus = {material.kinematic_hardening_modulus!r}: {LAW} of "
            "Kratos has isotropic hardening only; set it to 0"
        )
    yield_stress = material.yield_stress * MPA
    given = {
        "DENSITY": density * TONNES_PER_MM3,
        "YOUNG_MODULUS": material.youngs_modulus * MPA,
        "POISSON_RATIO": material.poissons_ratio,
        "YIELD_STRESS": yield_stress,
        "ISOTROPIC_HARDENING_MODULUS": material.isotropic_hardening_modulus * MPA,
        "EXPONENTIAL_SATURATION_YIELD_STRESS": yield_stress,  # no exponential hardening
        "HARDENING_EXPONENT": 0.0,
    }
    result = part.CreateNewProperties(number)
    for name, value in given.items():
        result[engine.variable(name)] = value
    law = engine.core.KratosGlobals.GetConstitutiveLaw(LAW)
    result[engine.core.CONSTITUTIVE_LAW] = law.Clone()
    return result


def _quads(patch: Integers) -> Integers:
    """Return the faces (f, 4) of a square patch of nodes, y fastest; normals point upwards."""
    side = round(np.sqrt(patch.size))
    place = patch.reshape(side, side)
    corners = (place[:-1, :-1], place[1:, :-1], place[1:, 1:], place[:-1, 1:])
    return np.stack(corners, axis=-1).reshape(-1, FACE)


_TOUCHING = "ComputingContact"
"""Kratos' part for the pairs of faces that it found."""


def vectors(engine: Engine, part: Any, name: str) -> Floats:
    """Return a vector at every node, (n, 3), converted from mm to m."""
    values = engine.core.VariableUtils().GetSolutionStepValuesVector(
        part.Nodes, engine.variable(name), 0, 3
    )
    return np.array(values).reshape(-1, 3) / MM


def contact_force(engine: Engine, part: Any) -> float:
    """Return the force of the whole beam on the whole sphere in N, upwards: four quarters.

    Of each pair of faces in contact, what its condition puts on the beam's four nodes, which come
    first in it, the other way round.
    """
    core, total, residual = engine.core, 0.0, engine.core.Vector()
    for pair in part.GetSubModelPart(_TOUCHING).Conditions:
        if pair.Is(core.ACTIVE):
            pair.CalculateRightHandSide(residual, part.ProcessInfo)
            total -= sum(list(residual)[2:12:3])
    return 4.0 * total


def plastic_strains(engine: Engine, part: Any) -> Floats:
    """Return PEEQ at each element's integration points, (e, 8)."""
    name = engine.variable("ACCUMULATED_PLASTIC_STRAIN")
    info = part.ProcessInfo
    return np.array([each.CalculateOnIntegrationPoints(name, info) for each in part.Elements])
