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
    [0.05556, -0.098667, 0.13026, 0.11933, 0.2536, -0.080001, 0.11382, -0.12865,
     -0.35921, 0.2141, 0.42052],
    [0.11381, -0.012912, -0.010456, 0.13983, -0.22732, 0.22569, 0.11832, -0.20478,
     0.11563, 0.69666, -0.66802],
    [0.27176, -0.24785, 0.11394, -0.5112, -0.39361, -0.16491, -0.37239, -0.040304,
     -0.74761, 1.2314, -0.59609],
    [0.61141, -0.079589, -0.11089, 0.56832, 0.5394, -0.017396, 0.30048, -0.29042,
     0.12643, -0.61734, 1.2763],
    [-0.35812, 0.047129, -0.015792, -0.042955, -0.0189, 0.0020467, -0.015973, 0.11829,
     0.083236, -0.24419, -0.05815],
    [0.32381, -0.6078, 1.0646, 0.089872, 0.6484, -0.14606, 0.59297, -0.78194,
     -1.4888, 2.1273, 0.2768],
    [-0.81469, 0.65598, -2.1175, 0.22613, -1.6924, 0.40182, -0.50977, 0.43517,
     0.35749, -0.29886, -1.4222],
    [0.11429, 0.0061176, 1.0747, -0.36599, 1.2142, -0.28426, 0.063857, 0.18742,
     1.3522, -2.314, 1.8045],
    [0.089795, -0.018314, -0.0060488, 0.0066219, -0.017664, 0.0011315, -0.037842, 0.061244,
     -0.02891, 0.032257, -0.10043],
    [-0.20039, -0.38296, 0.29444, -0.18444, 0.40843, -0.23039, -0.16113, -0.2577,
     -0.69895, 0.14348, 0.35394],
    [-0.28195, 0.73134, -0.6542, 0.8176, -1.0889, 0.60932, 0.64549, 0.83271,
     1.074, 1.0504, -1.2617],
    [-0.098715, -0.27849, 0.45742, -0.90509, 0.74443, -0.13789, -0.19166, -0.8173,
     -0.7946, -2.0986, 1.4028],
    [0.10155, -0.02217, -0.019559, 0.044574, -0.012061, -0.045642, -0.051815, 0.044917,
     0.063067, 0.15454, -0.073324],
])
STRAIN = np.array([
    [-0.0045101, -0.0033486, 0.0040092, -0.0018223, 0.00059464],
    [-0.0032266, -0.0001836, -0.0094812, 0.0073037, -0.0055731],
    [-0.003491, 0.01461, -0.0051129, 0.0066853, -0.032311],
])
HARDENING = np.array([
    [0.1613, 0.21758, 0.13696, -0.073316, 0.16469, -0.028166, 0.063994, 0.28927,
     -0.43323],
    [-0.15437, -0.18822, -0.28498, 0.15494, -0.19211, 0.10739, -0.30531, -0.54983,
     1.2186],
    [0.039837, 0.0025198, 0.022056, -0.079193, -0.0066938, -0.017929, 0.049857, 0.05966,
     -0.081406],
    [0.79541, 0.3793, -0.18283, -0.09755, -0.28208, 0.20497, 0.76342, -1.9504,
     1.6695],
    [-0.59167, -0.28032, 0.18426, 0.58149, 0.57049, -0.56874, -1.3496, 0.99618,
     -1.0256],
    [0.047369, -0.17154, 0.020366, -1.1138, 0.053143, 0.70792, 0.092674, 1.4736,
     -0.42264],
    [0.58626, 0.12698, -0.053635, 0.22535, 0.21781, -0.0021515, -0.48879, -0.38498,
     0.12094],
    [-0.97243, 0.027627, -0.025076, 0.097808, 0.17849, -0.21783, -0.16296, 0.79488,
     -0.18587],
    [0.11144, -0.29814, 0.056471, -0.60997, 0.012113, 0.74297, 0.1727, 0.68534,
     0.1432],
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
    hardened = (1.0, u, v, t, k, k * u, k * t, t * t, t * u)
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
