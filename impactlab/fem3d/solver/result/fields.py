"""Stresses and plastic strains of the elements at the end of a run."""

from __future__ import annotations

import numpy as np

from impactlab.fem3d.solver.elements import point
from impactlab.fem3d.solver.mesh import BEAM, Mesh
from impactlab.fem3d.solver.mesh.mesh import Floats
from impactlab.fem3d.solver.stepping.groups import Group
from impactlab.model.impact import Impact

PLASTIC_ZONE_STRAIN = 1e-5
"""PEEQ from which on a section counts as plastic, as in the beam models."""


def fields(groups: list[Group], count: int) -> dict[str, Floats]:
    """Of each element, (count,): means over its integration points, and the largest PEEQ.

    equivalent_plastic_strain, largest_equivalent_plastic_strain, plastic_strain (along the beam):
    1. von_mises_stress: Pa.
    """
    names = ("equivalent_plastic_strain", "largest_equivalent_plastic_strain", "plastic_strain")
    result = {name: np.full(count, np.nan) for name in (*names, "von_mises_stress")}
    for group in groups:
        strain = group.points(point.PEEQ)
        result[names[0]][group.elements] = strain.mean(axis=0)
        result[names[1]][group.elements] = strain.max(axis=0)
        result[names[2]][group.elements] = group.points(point.ALONG).mean(axis=0)
        result["von_mises_stress"][group.elements] = _mises(group)
    return result


def _mises(group: Group) -> Floats:
    """Von Mises stress in Pa, mean over the integration points."""
    s = np.stack([group.points(point.STRESS + row) for row in range(6)])
    squares = np.sum(s[:3] ** 2, axis=0) + 2.0 * np.sum(s[3:] ** 2, axis=0)
    return np.asarray(np.sqrt(1.5 * squares).mean(axis=0))


def plastic_responses(mesh: Mesh, impact: Impact, strain: Floats) -> dict[str, float]:
    """Answers about the beam's PEEQ, by the names of dataset.RESPONSES.

    strain: each element's largest. And sphere_plastic_strain, and one_point_plastic_strain: where
    bending is not integrated over an element.
    """
    points = mesh.nodes[mesh.elements, 0]
    beam = mesh.body == BEAM
    coarse = strain[~mesh.full]
    remote = beam & (points.mean(axis=1) > impact.beam.depth)
    return {
        "peak_plastic_strain": float(strain[beam].max()),
        "remote_plastic_strain": float(strain[remote].max(initial=0.0)),
        "sphere_plastic_strain": float(strain[~beam].max(initial=0.0)),
        "one_point_plastic_strain": float(coarse.max(initial=0.0)),
        "plastic_zone_length": _length(points[beam & (strain > PLASTIC_ZONE_STRAIN)]),
    }


def _length(along: Floats) -> float:
    """Length in m of whole beam that elements with these x of their nodes (e, 8) take up."""
    cuts = np.unique(np.round(np.stack([along.min(axis=1), along.max(axis=1)], axis=1), 12), axis=0)
    return float(2.0 * np.sum(cuts[:, 1] - cuts[:, 0]))
