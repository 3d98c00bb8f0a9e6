"""Elements go through the arithmetic in blocks of W, one a lane: processors do several at once.

A block's numbers lie in rows of W in one flat array: `s`, a thread's scratch, or `state`, what the
elements remember. One array each: a compiler sees that rows do not overlap.
"""

from __future__ import annotations

from impactlab.fem3d.solver.jit import inlined
from impactlab.fem3d.solver.types import Array

W = 16
"""Lanes of a block."""
X, V = 0, 24
"""First rows of the nodes' positions and velocities in `s`: node 0's x, y, z, node 1's ..."""
F = 48
"""First row of the nodes' forces in `s`."""
SCRATCH = 48 + 24 + 63
"""Rows of `s`."""


@inlined
def gather(s: Array, nodes: Array, x: Array, v: Array) -> None:
    """Positions and velocities of a block's nodes (nodes: (8 W,)) into its lanes."""
    for corner in range(8):
        for lane in range(W):
            node = nodes[corner * W + lane]
            for axis in range(3):
                s[(X + 3 * corner + axis) * W + lane] = x[node, axis]
                s[(V + 3 * corner + axis) * W + lane] = v[node, axis]


@inlined
def scatter(s: Array, rows: Array, forces: Array) -> None:
    """A block's nodal forces, added to its rows (8 W,) of forces (., 3)."""
    for corner in range(8):
        for lane in range(W):
            row = rows[corner * W + lane]
            for axis in range(3):
                forces[row, axis] += s[(F + 3 * corner + axis) * W + lane]
