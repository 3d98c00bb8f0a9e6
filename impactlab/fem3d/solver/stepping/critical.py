"""The largest stable time step, from the largest eigenvalue of the elastic system at rest."""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from impactlab.fem3d.solver.mesh.mesh import Floats
from impactlab.fem3d.solver.stepping.system import System

_TINY = 1e-12
"""Seconds of motion at about 1 m/s: strains stay far below 1."""


def critical_step(system: System) -> float:
    """2/omega of the fastest mode in s, by Lanczos, of a system that is not yet strained.

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
    """The elements' forces by node, (n, 3) in N, which are taken away."""
    rows = system.rows
    forces = np.asarray(np.add.reduceat(system.forces[rows.slots], rows.starts[:-1], axis=0))
    system.forces[:] = 0.0
    return forces
