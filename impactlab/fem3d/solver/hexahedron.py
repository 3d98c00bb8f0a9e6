"""The hexahedron: SIMD blocks, modes of nodal values, volume and mean gradient.

Elements pass through the arithmetic in blocks of W, one per SIMD lane. The numbers of a block lie
in rows of W in one flat array: `s`, the scratch of a thread, or `state`, the memory of the
elements. One array each, so that the compiler sees that rows do not overlap.

Nodal values (8,) of an element are decomposed into modes: with xi, eta, zeta in -1 to 1,

    u = u_0 + c_1 xi + c_2 eta + c_3 zeta
        + g_1 eta zeta + g_2 zeta xi + g_3 xi eta + g_4 xi eta zeta,

where c_k and g_k are an eighth of the sums of nodal values times the signs of xi ... xi eta zeta at
the nodes. In this package, c_k and g_k are those of the position x (m), w_k and h_k those of the
velocity (m/s).

With b_a the integral of grad N_a over the element, 8 b_a is the sum of B_k times the signs of
xi, eta, zeta, eta zeta, zeta xi, xi eta at node a (xi eta zeta has no part in it). The B_k are
integrals of the cofactors of dx/dxi.
Source of the mean gradient: D. P. Flanagan and T. Belytschko, Int. J. Numer. Meth. Engng. 17 (1981)
679; written here in modes.
"""

from impactlab.fem3d.solver.compiler import Array, inlined

W = 16  # lanes of a block
X, V = 0, 24  # first rows of positions and velocities in `s`: node 0's x, y, z, node 1's ...
F = 48  # first row of the nodes' forces in `s`
SCRATCH = 48 + 24 + 63 + 5  # rows of `s`


@inlined
def gather(s: Array, nodes: Array, x: Array, v: Array) -> None:
    """Copy positions and velocities of a block's nodes (nodes: (8 W,)) into its lanes."""
    for corner in range(8):
        for lane in range(W):
            node = nodes[corner * W + lane]
            for axis in range(3):
                s[(X + 3 * corner + axis) * W + lane] = x[node, axis]
                s[(V + 3 * corner + axis) * W + lane] = v[node, axis]


@inlined
def scatter(s: Array, rows: Array, forces: Array) -> None:
    """Add a block's nodal forces to its rows (8 W,) of forces (., 3)."""
    for corner in range(8):
        for lane in range(W):
            row = rows[corner * W + lane]
            for axis in range(3):
                forces[row, axis] += s[(F + 3 * corner + axis) * W + lane]


Vector = tuple[float, float, float]
Tensor = tuple[Vector, Vector, Vector]


@inlined
def load(s: Array, row: int, lane: int) -> Vector:
    """Return the numbers in three rows from `row` on."""
    first = row * W + lane
    return (s[first], s[first + W], s[first + 2 * W])


@inlined
def store(s: Array, row: int, lane: int, a: Vector) -> None:
    """Store numbers in three rows from `row` on."""
    first = row * W + lane
    s[first], s[first + W], s[first + 2 * W] = a[0], a[1], a[2]


@inlined
def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inlined
def dot(a: Vector, b: Vector) -> float:
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def add(a: Vector, b: Vector) -> Vector:
    """Return the sum."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@inlined
def times(factor: float, a: Vector) -> Vector:
    """Return the product with a number."""
    return (factor * a[0], factor * a[1], factor * a[2])


@inlined
def plus(a: Vector, factor: float, b: Vector) -> Vector:
    """Return a + factor b."""
    return (a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2])


@inlined
def apply(S: Tensor, a: Vector) -> Vector:
    """Return S a, S by rows."""
    return (dot(S[0], a), dot(S[1], a), dot(S[2], a))


@inlined
def combine(e: Tensor, q: Vector) -> Vector:
    """Return q_1 e_1 + q_2 e_2 + q_3 e_3."""
    return plus(plus(times(q[0], e[0]), q[1], e[1]), q[2], e[2])


Modes = tuple[float, float, float, float, float, float, float]
Shape = tuple[Vector, Vector, Vector, Vector, Vector, Vector, Vector]


@inlined
def load_modes(s: Array, row: int, lane: int) -> Shape:
    """Return the seven vectors in rows from `row` on."""
    return (
        load(s, row, lane),
        load(s, row + 3, lane),
        load(s, row + 6, lane),
        load(s, row + 9, lane),
        load(s, row + 12, lane),
        load(s, row + 15, lane),
        load(s, row + 18, lane),
    )


@inlined
def store_modes(s: Array, row: int, lane: int, f: Shape) -> None:
    """Store seven vectors in rows from `row` on."""
    for mode in range(7):
        store(s, row + 3 * mode, lane, f[mode])


@inlined
def modes(s: Array, row: int, lane: int) -> Modes:
    """Return c_1, c_2, c_3, g_1, g_2, g_3, g_4 of the values in rows row, row + 3, ... row + 21."""
    first = row * W + lane
    a0, a1, a2, a3 = s[first], s[first + 3 * W], s[first + 6 * W], s[first + 9 * W]
    a4, a5, a6, a7 = s[first + 12 * W], s[first + 15 * W], s[first + 18 * W], s[first + 21 * W]
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
    """Return the modes of a vector's three components, whose rows alternate from `row` on."""
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
    """Store nodal values of the modes' factors (an eighth included) in rows row, row + 3, ..."""
    first = row * W + lane
    low, high = F[1] - F[3], F[1] + F[3]  # of eta, where zeta is -1 and 1
    sum1, sum2 = -low - F[2], low - F[2]
    sum3, sum4 = F[2] - high, F[2] + high
    d_low, d_high = F[0] - F[4], F[0] + F[4]
    e_low, e_high = F[5] - F[6], F[5] + F[6]
    s[first], s[first + 3 * W] = sum1 - (d_low - e_low), sum1 + (d_low - e_low)
    s[first + 6 * W], s[first + 9 * W] = sum2 + (d_low + e_low), sum2 - (d_low + e_low)
    s[first + 12 * W], s[first + 15 * W] = sum3 - (d_high - e_high), sum3 + (d_high - e_high)
    s[first + 18 * W], s[first + 21 * W] = sum4 + (d_high + e_high), sum4 - (d_high + e_high)


@inlined
def nodal(s: Array, lane: int, f: Shape) -> None:
    """Store the nodal forces (N) of the modes' forces f, an eighth included, in rows F of `s`."""
    f1, f2, f3, f4, f5, f6, f7 = f
    put(s, F, lane, (f1[0], f2[0], f3[0], f4[0], f5[0], f6[0], f7[0]))
    put(s, F + 1, lane, (f1[1], f2[1], f3[1], f4[1], f5[1], f6[1], f7[1]))
    put(s, F + 2, lane, (f1[2], f2[2], f3[2], f4[2], f5[2], f6[2], f7[2]))


Gradient = tuple[Vector, Vector, Vector, Vector, Vector, Vector]


@inlined
def gradient(c: Shape) -> Gradient:
    """Return B_1 to B_6 in m2."""
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
    """Return the volume of the element in m3."""
    low = c[0][0] * B[0][0] + c[1][0] * B[1][0] + c[2][0] * B[2][0]
    return low + c[3][0] * B[3][0] + c[4][0] * B[4][0] + c[5][0] * B[5][0]


@inlined
def mean_gradient(w: Shape, B: Gradient, V: float) -> Tensor:
    """Return the mean of dv_i/dx_j over the element in 1/s, by rows."""
    share = 1.0 / V
    return (
        times(share, _mean_slope(w, B, 0)),
        times(share, _mean_slope(w, B, 1)),
        times(share, _mean_slope(w, B, 2)),
    )


@inlined
def _mean_slope(w: Shape, B: Gradient, axis: int) -> Vector:
    low = combine((B[0], B[1], B[2]), (w[0][axis], w[1][axis], w[2][axis]))
    return add(low, combine((B[3], B[4], B[5]), (w[3][axis], w[4][axis], w[5][axis])))


@inlined
def midway(L: Tensor, dt: float) -> Tensor:
    """Return dv/dx at mid-step from that at its end: L (I - dt L/2)^-1, to second order.

    With it, a rigid rotation strains nothing (T. J. R. Hughes and J. Winget, 1980).
    """
    half = 0.5 * dt
    return (
        plus(L[0], half, combine(L, L[0])),
        plus(L[1], half, combine(L, L[1])),
        plus(L[2], half, combine(L, L[2])),
    )
