"""Eight nodal values taken apart into modes, and put together again (see the package)."""

from __future__ import annotations

from impactlab.fem3d.solver.elements.lanes import W
from impactlab.fem3d.solver.elements.vectors import Vector
from impactlab.fem3d.solver.jit import inlined
from impactlab.fem3d.solver.types import Array

Modes = tuple[float, float, float, float, float, float, float]
Shape = tuple[Vector, Vector, Vector, Vector, Vector, Vector, Vector]


@inlined
def modes(s: Array, row: int, lane: int) -> Modes:
    """c_1, c_2, c_3, g_1, g_2, g_3, g_4 of the values in rows row, row + 3, ... row + 21."""
    at = row * W + lane
    a0, a1, a2, a3 = s[at], s[at + 3 * W], s[at + 6 * W], s[at + 9 * W]
    a4, a5, a6, a7 = s[at + 12 * W], s[at + 15 * W], s[at + 18 * W], s[at + 21 * W]
    s01, s23, s45, s67 = a1 + a0, a2 + a3, a5 + a4, a6 + a7
    d01, d23, d45, d67 = a1 - a0, a2 - a3, a5 - a4, a6 - a7
    return (
        0.125 * ((d01 + d23) + (d45 + d67)),
        0.125 * ((s23 - s01) + (s67 - s45)),
        0.125 * ((s45 + s67) - (s01 + s23)),
        0.125 * ((s67 - s45) - (s23 - s01)),
        0.125 * ((d45 + d67) - (d01 + d23)),
        0.125 * ((d23 - d01) + (d67 - d45)),
        0.125 * ((d67 - d45) - (d23 - d01)),
    )


@inlined
def shape(s: Array, row: int, lane: int) -> Shape:
    """The modes of a vector's three components, whose rows alternate from `row` on."""
    x, y, z = modes(s, row, lane), modes(s, row + 1, lane), modes(s, row + 2, lane)
    return (
        (x[0], y[0], z[0]),
        (x[1], y[1], z[1]),
        (x[2], y[2], z[2]),
        (x[3], y[3], z[3]),
        (x[4], y[4], z[4]),
        (x[5], y[5], z[5]),
        (x[6], y[6], z[6]),
    )


@inlined
def put(s: Array, row: int, lane: int, F: Modes) -> None:
    """Nodal values from factors of the modes (an eighth included), into rows row, row + 3, ..."""
    at = row * W + lane
    low, high = F[1] - F[3], F[1] + F[3]  # of eta, where zeta is -1 and 1
    one, two = -low - F[2], low - F[2]
    three, four = F[2] - high, F[2] + high
    d_low, d_high = F[0] - F[4], F[0] + F[4]
    e_low, e_high = F[5] - F[6], F[5] + F[6]
    s[at], s[at + 3 * W] = one - (d_low - e_low), one + (d_low - e_low)
    s[at + 6 * W], s[at + 9 * W] = two + (d_low + e_low), two - (d_low + e_low)
    s[at + 12 * W], s[at + 15 * W] = three - (d_high - e_high), three + (d_high - e_high)
    s[at + 18 * W], s[at + 21 * W] = four + (d_high + e_high), four - (d_high + e_high)
