"""A step of the nodes: forces taken in a fixed order, velocities kicked, positions moved on."""

from __future__ import annotations

from impactlab.fem3d.solver.jit import compiled
from impactlab.fem3d.solver.types import Array


@compiled
def kick(
    nodes: tuple[int, int],
    starts: Array,
    slots: Array,
    forces: Array,
    inverse_mass: Array,
    pull: Array,
    x: Array,
    v: Array,
    kick_dt: float,
    dt: float,
) -> None:
    """Move the nodes from the first to before the last of `nodes`.

    starts: (n + 1,); slots[starts[i]:starts[i + 1]]: node i's rows of forces (., 3) in N, which are
    left at 0.
    inverse_mass: (n, 3) in 1/kg, 0 where a node is held. pull: (n,) downward acceleration in m/s2.
    kick_dt, dt: seconds between the velocities and between the positions.
    """
    for node in range(nodes[0], nodes[1]):
        f0, f1, f2 = 0.0, 0.0, 0.0
        for at in range(starts[node], starts[node + 1]):
            slot = slots[at]
            f0 += forces[slot, 0]
            f1 += forces[slot, 1]
            f2 += forces[slot, 2]
            forces[slot, 0], forces[slot, 1], forces[slot, 2] = 0.0, 0.0, 0.0
        v[node, 0] -= kick_dt * inverse_mass[node, 0] * f0
        v[node, 1] -= kick_dt * inverse_mass[node, 1] * f1
        v[node, 2] -= kick_dt * (inverse_mass[node, 2] * f2 + pull[node])
        x[node, 0] += dt * v[node, 0]
        x[node, 1] += dt * v[node, 1]
        x[node, 2] += dt * v[node, 2]
