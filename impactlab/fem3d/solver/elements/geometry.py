"""An element's volume and mean gradient, in closed form.

With b_a the integral of grad N_a over the element, 8 b_a is the sum of B_k times the signs of
xi, eta, zeta, eta zeta, zeta xi, xi eta at node a (xi eta zeta has no part in it). The B_k are
integrals of the cofactors of dx/dxi.
Source of the mean gradient: D. P. Flanagan and T. Belytschko, Int. J. Numer. Meth. Engng. 17 (1981)
679; written here in modes.
"""

from __future__ import annotations

from impactlab.fem3d.solver.elements.modes import Shape
from impactlab.fem3d.solver.elements.vectors import Tensor, Vector, add, combine, cross, plus, times
from impactlab.fem3d.solver.jit import inlined

Gradient = tuple[Vector, Vector, Vector, Vector, Vector, Vector]


@inlined
def gradient(c: Shape) -> Gradient:
    """B_1 to B_6 in m2."""
    third = 1.0 / 3.0
    return (
        times(8.0, plus(cross(c[1], c[2]), third, cross(c[5], c[4]))),
        times(8.0, plus(cross(c[2], c[0]), third, cross(c[3], c[5]))),
        times(8.0, plus(cross(c[0], c[1]), third, cross(c[4], c[3]))),
        times(8.0 * third, add(cross(c[2], c[4]), cross(c[5], c[1]))),
        times(8.0 * third, add(cross(c[0], c[5]), cross(c[3], c[2]))),
        times(8.0 * third, add(cross(c[1], c[3]), cross(c[4], c[0]))),
    )


@inlined
def volume(c: Shape, B: Gradient) -> float:
    """Of the element, in m3."""
    low = c[0][0] * B[0][0] + c[1][0] * B[1][0] + c[2][0] * B[2][0]
    return low + c[3][0] * B[3][0] + c[4][0] * B[4][0] + c[5][0] * B[5][0]


@inlined
def mean_gradient(w: Shape, B: Gradient, V: float) -> Tensor:
    """The mean of dv_i/dx_j over the element in 1/s, by rows."""
    share = 1.0 / V
    w1, w2, w3, h1, h2, h3, _ = w
    return (
        times(share, _row((w1[0], w2[0], w3[0]), (h1[0], h2[0], h3[0]), B)),
        times(share, _row((w1[1], w2[1], w3[1]), (h1[1], h2[1], h3[1]), B)),
        times(share, _row((w1[2], w2[2], w3[2]), (h1[2], h2[2], h3[2]), B)),
    )


@inlined
def _row(w: Vector, h: Vector, B: Gradient) -> Vector:
    low = combine((B[0], B[1], B[2]), w)
    return add(low, combine((B[3], B[4], B[5]), h))


@inlined
def midway(L: Tensor, dt: float) -> Tensor:
    """dv/dx at the middle of a step, from that at its end: L (I - dt L/2)^-1, to second order.

    With it, a rigid rotation strains nothing (T. J. R. Hughes and J. Winget, 1980).
    """
    half = 0.5 * dt
    return (
        plus(L[0], half, combine(L, L[0])),
        plus(L[1], half, combine(L, L[1])),
        plus(L[2], half, combine(L, L[2])),
    )
