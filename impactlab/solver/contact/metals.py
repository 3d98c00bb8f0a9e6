"""Coefficients of the curve of `finite_element` for two metals.

The curve (finite_element.py) is linear in 25 functions of the indentation. Their coefficients are
polynomials in
    u = 2 share - 1         share: of the compliance 1/E* that is the softer body's
    v = 4 (nu - 0.3)        nu: its Poisson's ratio
    t = S/S_other - 0.4     S: yield stresses; 0 where the other body is harder than 2.5 times
    m = 100 S/E*
    k                       share of its hardening modulus that is kinematic
PLAIN: of 13 functions of x = delta/delta_y; STRAIN: of three that finite strains add; HARDENING: of
nine that grow with q sqrt(x), q = H (1 - nu^2)/(E share), H its hardening modulus.

Fitted by tests/benchmarks/contact_law.py, which says to what, and writes them here. Beyond the
data the numbers are held at their ends.
"""

import math

import numpy as np

from impactlab.solver.jit import compiled
from impactlab.solver.types import Array, Shape

LEAST_RATIO, LARGEST_RATIO = 60.0, 1500.0
LEAST_SHARE, LARGEST_SHARE = 0.24, 0.92
LEAST_POISSONS_RATIO, LARGEST_POISSONS_RATIO = 0.05, 0.45
LARGEST_HARDENING = 0.05
LARGEST_REVERSAL = 1.0
"""k q sqrt(x) at which unloading is held: beyond, metal yields in reverse and no longer unloads by
a power of what is left."""
LARGEST_COMPARED_REVERSAL = 0.45
"""The same, beyond which runs are marked: at 0.5 and 0.9 contacts end 2.5 and 5.4 % sooner than in
3-D, and at 0.9 dents are 6.6 % deeper."""
LARGEST_HARDENED = 2.0
"""Hardened flow stress under the contact over the other body's yield stress, beyond which runs are
marked: that body then yields more than in the data; at 4.2 the force is 8 % too large."""
ONSET, ONSET_EXPONENT = 0.33, -0.14
"""First-order parts of what is recovered and of the exponent in w (finite_element.py): no metal
creates energy if the first is below 0.5 plus 0.4 times the second."""

# fmt: off
PLAIN = np.array([
    [0.028489, -0.086837, 0.11461, 0.21647, 0.29457, -0.068269, 0.10995, -0.18877,
     -0.29759, 0.29096, 0.42017],
    [0.13012, -0.07696, 0.059459, -0.18493, -0.29602, 0.12445, -0.0033538, -0.33225,
     -0.20453, 0.77462, -0.65687],
    [0.33334, -0.16251, 0.00065729, -0.11075, -0.42071, 0.034316, -0.093923, 0.2074,
     -0.007338, 1.5812, -0.51022],
    [0.49175, -0.27099, -0.097335, 0.52155, 0.57796, -0.21846, -0.19012, -0.17826,
     0.040393, -0.73377, 1.4363],
    [-0.34482, 0.070032, -0.0083723, -0.06317, -0.01525, 0.015356, 0.035647, 0.11848,
     0.013936, -0.3454, -0.10235],
    [0.29855, -0.5774, 0.97648, 0.086647, 0.66956, -0.19714, 0.52305, -0.74257,
     -1.3475, 1.7366, 0.31063],
    [-0.73311, 0.52226, -1.8377, 0.19557, -1.7623, 0.56929, -0.14724, 0.33099,
     -0.29948, 0.82772, -1.5995],
    [0.034603, 0.10382, 0.89639, -0.32337, 1.1987, -0.47427, 0.22016, -0.17303,
     0.72603, -1.4447, 1.9341],
    [0.093839, -0.017344, -0.011627, 0.0034414, -0.0053672, 0.013823, -0.1224, 0.1652,
     0.1687, -0.27231, -0.097484],
    [-0.19489, -0.4071, 0.2878, -0.19743, 0.44436, -0.26966, -0.12879, -0.43763,
     -0.78976, 0.30054, 0.40218],
    [-0.29993, 0.76066, -0.71714, 0.87529, -1.1036, 0.68643, 0.73401, 0.95498,
     0.84892, 1.3702, -1.3537],
    [-0.10357, -0.25949, 0.62073, -0.97013, 0.575, -0.20364, -0.0060228, -0.72004,
     -0.91169, -2.7915, 1.381],
    [0.10576, -0.025664, -0.036611, 0.044607, 0.012553, -0.039822, -0.13117, 0.073168,
     0.19384, 0.11663, -0.058536],
])
STRAIN = np.array([
    [-0.0056079, -0.003135, 0.0038306, -0.0018332, -0.00032041],
    [-0.0034822, -7.7525e-05, -0.0089897, 0.0093092, -0.0031674],
    [-0.0034783, 0.013218, -0.0032492, 0.0091847, -0.027265],
])
HARDENING = np.array([
    [0.26887, 0.37094, 0.24008, 0.031123, 0.14467, -0.24021, -0.18417],
    [-0.31049, -0.32, -0.46097, -0.2436, -0.18667, 0.48426, 0.38697],
    [0.046823, -0.0032289, 0.033268, -0.032127, -0.0037642, -0.034415, -0.011992],
    [0.56534, 0.63468, -0.38518, -0.66717, -0.024588, 0.28727, -0.30617],
    [-0.33988, -0.41083, 0.42312, 0.48921, 0.33744, -0.77899, 0.034092],
    [0.043479, -0.29337, -0.0014433, -0.24814, -0.0025813, 0.81066, -0.088286],
    [0.49009, 0.31373, -0.082285, 0.31, 0.34726, 0.09861, -0.6221],
    [-0.89134, -0.10421, 0.0021796, 0.17096, 0.074804, -0.59884, -0.18126],
    [0.11401, -0.38249, 0.049921, -0.25033, -0.018095, 0.99955, 0.30965],
])
# fmt: on


@compiled
def _sum(table: Array, row: int, monomials: tuple[float, ...]) -> float:
    """Return a coefficient: a row of a table times the monomials."""
    total = 0.0
    for j in range(len(monomials)):
        total += table[row, j] * monomials[j]
    return total


@compiled
def hardened(q: float, x: float) -> float:
    """Return the flow stress of the softer metal under the contact over its yield stress.

    At Tabor's strain 0.2 a/R, with a^2 = 2 R delta; q: of the module, x: delta/delta_y.
    """
    return 1.0 + 0.2 * math.sqrt(2.0) * 0.825 * math.pi * q * math.sqrt(x)


@compiled
def shape(
    yield_ratio: float,
    share: float,
    nu: float,
    hardening: float,
    kinematic: float,
    hardness: float,
) -> Shape:
    """Return the coefficients of the curve of two metals, q and k q.

    yield_ratio: E*/S_y of the softer metal; share: of the compliance 1/E* that is its own; nu: its
    Poisson's ratio; hardening: its hardening moduli over Young's; kinematic: share of the latter;
    hardness: the other's yield stress over its own.
    """
    share = min(max(share, LEAST_SHARE), LARGEST_SHARE)
    nu = min(max(nu, LEAST_POISSONS_RATIO), LARGEST_POISSONS_RATIO)
    hardening = min(hardening, LARGEST_HARDENING)
    u, v, k = 2.0 * share - 1.0, 4.0 * (nu - 0.3), kinematic
    t = max(1.0 / hardness - 0.4, 0.0)
    m = 100.0 / min(max(yield_ratio, LEAST_RATIO), LARGEST_RATIO)
    plain = (1.0, u, v, u * u, u * v, v * v, t, t * u, t * t, t * t * u, t * v)
    strain = (1.0, m, m * u, m * v, m * t)
    hardened = (1.0, u, v, t, k, k * u, k * t)
    q = hardening * (1.0 - nu * nu) / share
    row = int(np.int64(0))  # rows that are literals would be types, and `_sum` compiled for each
    # written out: kernels have no arrays of their own
    return (
        _sum(PLAIN, row, plain),
        _sum(PLAIN, row + 1, plain),
        _sum(PLAIN, row + 2, plain),
        _sum(PLAIN, row + 3, plain),
        _sum(PLAIN, row + 4, plain),
        _sum(PLAIN, row + 5, plain),
        _sum(PLAIN, row + 6, plain),
        _sum(PLAIN, row + 7, plain),
        _sum(PLAIN, row + 8, plain),
        _sum(PLAIN, row + 9, plain),
        _sum(PLAIN, row + 10, plain),
        _sum(PLAIN, row + 11, plain),
        _sum(PLAIN, row + 12, plain),
        _sum(STRAIN, row, strain),
        _sum(STRAIN, row + 1, strain),
        _sum(STRAIN, row + 2, strain),
        _sum(HARDENING, row, hardened),
        _sum(HARDENING, row + 1, hardened),
        _sum(HARDENING, row + 2, hardened),
        _sum(HARDENING, row + 3, hardened),
        _sum(HARDENING, row + 4, hardened),
        _sum(HARDENING, row + 5, hardened),
        _sum(HARDENING, row + 6, hardened),
        _sum(HARDENING, row + 7, hardened),
        _sum(HARDENING, row + 8, hardened),
        q,
        k * q,
    )


LIKE_METALS: Shape = (
    *PLAIN[:, 0].tolist(),
    *(STRAIN[:, 0] + STRAIN[:, 1] * 100.0 / 333.0).tolist(),
    *HARDENING[:, 0].tolist(),
    *(0.0, 0.0),
)
"""Of a flat and an elastic sphere of the same modulus, E*/S_y = 333, which do not harden."""
