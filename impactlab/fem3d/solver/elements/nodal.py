"""From an element's stresses to its nodes' forces."""

from __future__ import annotations

from impactlab.fem3d.solver.elements.lanes import F
from impactlab.fem3d.solver.elements.modes import Shape, put
from impactlab.fem3d.solver.elements.vectors import Vector
from impactlab.fem3d.solver.jit import inlined
from impactlab.fem3d.solver.types import Array

NONE: Vector = (0.0, 0.0, 0.0)


@inlined
def nodal(s: Array, lane: int, f: Shape) -> None:
    """Nodal forces (N) of the modes' forces f, an eighth included, into the rows F of `s`."""
    f1, f2, f3, f4, f5, f6, f7 = f
    put(s, F, lane, (f1[0], f2[0], f3[0], f4[0], f5[0], f6[0], f7[0]))
    put(s, F + 1, lane, (f1[1], f2[1], f3[1], f4[1], f5[1], f6[1], f7[1]))
    put(s, F + 2, lane, (f1[2], f2[2], f3[2], f4[2], f5[2], f6[2], f7[2]))
