"""Bounds of the time step: the largest eigenvalue at rest, and the elements' shapes later on."""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from impactlab.fem3d.solver.jit import Array, compiled
from impactlab.fem3d.solver.mesh.mesh import Floats
from impactlab.fem3d.solver.stepping.system import System

_TINY = 1e-12
"""Seconds of motion at about 1 m/s: strains stay far below 1."""


def critical_step(system: System) -> float:
    """Return 2/omega of the fastest mode in s, by Lanczos, of a system that is not yet strained.

    The elements' own forces are what the eigenvalue is taken of, so no estimate stands between.
    """
    root = np.sqrt(system.inverse_mass)
    rest = system.v.copy()

    def product(vector: Floats) -> Floats:
        system.v[:] = root * vector.reshape(root.shape)
        system.strain(_TINY)
        answer = root * _gathered(system)
        for group in system.groups:
            group.state[:] = 0.0
        return np.asarray(answer.ravel() / _TINY)

    operator = LinearOperator((root.size, root.size), matvec=product, dtype=np.float64)
    start = np.random.default_rng(0).standard_normal(root.size)
    (largest,) = eigsh(
        operator, k=1, which="LA", tol=1e-2, ncv=20, v0=start, return_eigenvectors=False
    )
    system.v[:] = rest
    return float(2.0 / np.sqrt(largest))


def _gathered(system: System) -> Floats:
    """Return the elements' forces by node, (n, 3) in N, and clear them."""
    rows = system.assembly
    forces = np.asarray(np.add.reduceat(system.forces[rows.slots], rows.starts[:-1], axis=0))
    system.forces[:] = 0.0
    return forces


_NEIGHBOURS = np.array(
    [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]]
)
"""The three corners that share an edge with each corner, turning right-handed."""


@compiled
def corner_volumes(elements: Array, x: Array, volumes: Array) -> float:
    """Store triple products of the edges at each corner in volumes (e, 8), in m3; inverted: < 0.

    elements: (e, 8). x: (n, 3) in m. Returns the shortest edge in m.
    """
    shortest = np.inf
    for e in range(elements.shape[0]):
        for corner in range(8):
            o = elements[e, corner]
            a = elements[e, _NEIGHBOURS[corner, 0]]
            b = elements[e, _NEIGHBOURS[corner, 1]]
            c = elements[e, _NEIGHBOURS[corner, 2]]
            a0, a1, a2 = x[a, 0] - x[o, 0], x[a, 1] - x[o, 1], x[a, 2] - x[o, 2]
            b0, b1, b2 = x[b, 0] - x[o, 0], x[b, 1] - x[o, 1], x[b, 2] - x[o, 2]
            c0, c1, c2 = x[c, 0] - x[o, 0], x[c, 1] - x[o, 1], x[c, 2] - x[o, 2]
            volumes[e, corner] = (
                a0 * (b1 * c2 - b2 * c1) + a1 * (b2 * c0 - b0 * c2) + a2 * (b0 * c1 - b1 * c0)
            )
            shortest = min(
                shortest,
                a0 * a0 + a1 * a1 + a2 * a2,
                b0 * b0 + b1 * b1 + b2 * b2,
                c0 * c0 + c1 * c1 + c2 * c2,
            )
    return float(np.sqrt(shortest))
