"""What is read off Kratos' model after a step, in SI units."""

from __future__ import annotations

from typing import Any

import numpy as np

from impactlab.fem3d.kratos.engine import Engine
from impactlab.fem3d.kratos.units import MM
from impactlab.fem3d.solver.mesh.mesh import Floats

_TOUCHING = "ComputingContact"
"""Kratos' part for the pairs of faces that it made out."""


def vectors(engine: Engine, part: Any, name: str) -> Floats:
    """A vector at every node, (n, 3), from mm to m."""
    values = engine.core.VariableUtils().GetSolutionStepValuesVector(
        part.Nodes, engine.variable(name), 0, 3
    )
    return np.array(values).reshape(-1, 3) / MM


def contact_force(engine: Engine, part: Any) -> float:
    """Force of the whole beam on the whole sphere in N, upwards: four quarters.

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
    """PEEQ at each element's integration points, (e, 8)."""
    name = engine.variable("ACCUMULATED_PLASTIC_STRAIN")
    info = part.ProcessInfo
    return np.array([each.CalculateOnIntegrationPoints(name, info) for each in part.Elements])
