"""The stiffness and mass of the 3-D model's beam as matrices."""

import numpy as np
from scipy.sparse import csc_array, diags_array

from impactlab.fem3d.solver.mesh import BEAM
from impactlab.fem3d.solver.system import System, ThreadPool

_STIFFNESS = {}
"""Without springs, by what it is of: springs and damping come on the same beam in many tests."""


def matrices(impact, mesh):
    """Return stiffness in N/m and lumped mass in kg of what moves of the beam, and its freedoms.

    Freedoms are node and axis, (2, freedoms).
    """
    beam = np.unique(mesh.elements[mesh.body == BEAM])
    with ThreadPool(1) as pool:
        system = System(mesh, impact, pool)
        freedoms = [
            (node, axis) for node in beam for axis in range(3) if system.inverse_mass[node, axis]
        ]
        number = np.array(freedoms).T
        key = mesh.nodes.tobytes(), mesh.full.tobytes(), number.tobytes(), impact.beam.material
        if key not in _STIFFNESS:
            _STIFFNESS[key] = csc_array(np.array([*_columns(system, freedoms, number)]))
        springs = system.springs.diagonal(len(mesh.nodes))[number[0], number[1]]
    stiffness = _STIFFNESS[key] + diags_array(springs)
    return 0.5 * (stiffness + stiffness.T), diags_array(system.mass[number[0]]), number


def _columns(system, freedoms, number):
    """Yield the forces on the freedoms as each of them moves by a metre."""
    rows, tiny = system.assembly, 1e-12
    system.v[:] = 0.0
    for node, axis in freedoms:
        system.v[node, axis] = 1.0
        system.strain(tiny)
        system.v[node, axis] = 0.0
        forces = np.add.reduceat(system.forces[rows.slots], rows.starts[:-1], axis=0)
        yield forces[number[0], number[1]] / tiny
        system.forces[:] = 0.0
        for group in system.groups:
            group.state[:], group.works[:] = 0.0, 0.0
