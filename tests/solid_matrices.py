"""The stiffness and mass of the 3-D model's beam as matrices."""

import numpy as np
from scipy.sparse import csc_array, diags_array

from impactlab.fem3d.solver.mesh import BEAM
from impactlab.fem3d.solver.system import System, ThreadPool


def matrices(impact, mesh):
    """Return stiffness in N/m and lumped mass in kg of what moves of the beam, and its freedoms.

    Freedoms are node and axis, (2, freedoms).
    """
    beam = np.unique(mesh.elements[mesh.body == BEAM])
    with ThreadPool(1) as pool:
        system = System(mesh, impact, pool)
        rows, tiny = system.assembly, 1e-12
        system.v[:] = 0.0
        freedoms = [
            (node, axis) for node in beam for axis in range(3) if system.inverse_mass[node, axis]
        ]
        number = np.array(freedoms).T
        columns = []
        for node, axis in freedoms:
            system.v[node, axis] = 1.0
            system.strain(tiny)
            system.v[node, axis] = 0.0
            forces = np.add.reduceat(system.forces[rows.slots], rows.starts[:-1], axis=0)
            columns.append(forces[number[0], number[1]] / tiny)
            system.forces[:] = 0.0
            for group in system.groups:
                group.state[:], group.works[:] = 0.0, 0.0
        springs = system.springs.diagonal(len(mesh.nodes))[number[0], number[1]]
    stiffness = csc_array(np.array(columns)) + diags_array(springs)
    return 0.5 * (stiffness + stiffness.T), diags_array(system.mass[number[0]]), number
