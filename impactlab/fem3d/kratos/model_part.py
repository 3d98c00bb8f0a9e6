"""The mesh as Kratos' model: nodes, elements with their material, and the surfaces that may touch.

Kratos counts from 1: its node i + 1 is the mesh's node i.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from impactlab.fem3d.kratos.engine import Engine
from impactlab.fem3d.kratos.settings import BEAM_TOP, SPHERE_BOTTOM
from impactlab.fem3d.kratos.units import MM, MPA, TONNES_PER_MM3
from impactlab.fem3d.solver import Mesh
from impactlab.fem3d.solver.mesh import BEAM, SPHERE
from impactlab.fem3d.solver.mesh.mesh import Integers
from impactlab.fem3d.solver.stepping.masses import element_volumes
from impactlab.model.impact import Impact
from impactlab.model.material import Material

ELEMENT, LAW, FACE = "SmallDisplacementBbarElement3D8N", "SmallStrainJ2Plasticity3DLaw", 4


def fill(engine: Engine, part: Any, mesh: Mesh, impact: Impact) -> None:
    """Put the mesh into the empty model part `part`, which must know its variables.

    Raises ValueError for a material with kinematic hardening, which Kratos' law does not have.
    """
    for number, place in enumerate((mesh.nodes * MM).tolist(), 1):
        part.CreateNewNode(number, *place)
    steels = {
        BEAM: _steel(engine, part, 1, impact.beam.material, impact.beam.material.density),
        SPHERE: _steel(engine, part, 2, impact.sphere.material, _sphere_density(mesh, impact)),
    }
    of_element = zip((mesh.elements + 1).tolist(), mesh.body.tolist(), strict=True)
    for number, (nodes, body) in enumerate(of_element, 1):
        part.CreateNewElement(ELEMENT, number, nodes, steels[body])
    first = 1
    for name, quads, body in (
        (SPHERE_BOTTOM, _quads(mesh.pairs[:, 0])[:, ::-1], SPHERE),
        (BEAM_TOP, _quads(mesh.pairs[:, 1]), BEAM),
    ):
        _surface(part.CreateSubModelPart(name), quads + 1, first, steels[body])
        first += len(quads)


def hold(engine: Engine, part: Any, mesh: Mesh) -> None:
    """Symmetry planes and supports."""
    held = {"X": mesh.symmetry_x, "Y": mesh.symmetry_y, "Z": mesh.support}
    for axis, nodes in held.items():
        variable = engine.variable(f"DISPLACEMENT_{axis}")
        for node in (nodes + 1).tolist():
            part.GetNode(node).Fix(variable)


def launch(engine: Engine, part: Any, mesh: Mesh, impact: Impact) -> None:
    """The sphere's velocity, now and in the step before, and gravity, which acts on it alone."""
    given = {"VELOCITY_Z": impact.velocity, "VOLUME_ACCELERATION_Z": impact.gravity}
    for node in (np.unique(mesh.elements[mesh.body == SPHERE]) + 1).tolist():
        for name, value in given.items():
            for step in (0, 1):
                part.GetNode(node).SetSolutionStepValue(engine.variable(name), step, -value * MM)


def _steel(engine: Engine, part: Any, number: int, material: Material, density: float) -> Any:
    """Kratos' properties of a material; density in kg/m3."""
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


def _sphere_density(mesh: Mesh, impact: Impact) -> float:
    """kg/m3 that give the meshed sphere the impact's mass."""
    quarter = float(element_volumes(mesh)[mesh.body == SPHERE].sum())
    return impact.sphere.total_mass / (4.0 * quarter)


def _quads(patch: Integers) -> Integers:
    """Faces (f, 4) of a square patch of nodes, counted with y fastest; normals upwards."""
    side = round(np.sqrt(patch.size))
    place = patch.reshape(side, side)
    corners = (place[:-1, :-1], place[1:, :-1], place[1:, 1:], place[:-1, 1:])
    return np.stack(corners, axis=-1).reshape(-1, FACE)


def _surface(part: Any, quads: Integers, first: int, steel: Any) -> None:
    part.AddNodes(np.unique(quads).tolist())
    for number, nodes in enumerate(quads.tolist(), first):
        part.CreateNewCondition(f"SurfaceCondition3D{FACE}N", number, nodes, steel)
