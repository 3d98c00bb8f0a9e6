"""Coefficients of the curve of `finite_element` for two metals.

The curve (finite_element.py) is linear in 25 functions of the indentation. Their coefficients are
polynomials in
    u = 2 share - 1         share: of the compliance 1/E* that is the softer body's
    v = 4 (nu - 0.3)        nu: its Poisson's ratio
    t = S/S_other - 0.4     S: yield stresses; 0 where the other body is harder than 2.5 times
    T = t - 0.45            0 where it is harder than 1.18 times
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
    [0.040224, -0.11565, 0.16576, 0.10874, 0.21435, -0.063547, 0.05624, -0.11724,
     -0.16718, 0.12094, 0.22619, -0.017116],
    [0.12853, 0.042942, -0.089151, 0.15396, -0.28599, 0.20116, 0.082523, 0.1751,
     0.25571, 0.74113, -0.49604, 0.10845],
    [0.29742, -0.31506, 0.12646, -0.47557, -0.082047, -0.2142, -0.59323, -0.35668,
     -0.16807, -0.58532, -0.0025233, -1.7377],
    [0.54693, -0.071342, -0.0226, 0.50383, 0.22085, 0.073239, -0.34892, 0.57866,
     1.1042, 0.27899, 0.33496, 0.57625],
    [-0.35093, 0.049989, -0.024091, -0.039649, -0.0038957, -0.002123, 0.1476, -0.045879,
     -0.25049, -0.028365, -0.0081466, 0.23519],
    [0.31953, -0.62783, 1.0643, 0.098022, 0.61215, -0.15411, 0.40937, -0.79917,
     -0.61282, 2.0987, 0.22817, -2.0327],
    [-0.80106, 0.73383, -2.1211, 0.20958, -1.5538, 0.43766, -0.31998, 0.5916,
     -1.3078, -0.42096, -1.2021, 4.362],
    [0.069947, -0.14017, 1.085, -0.31161, 1.0928, -0.31343, 0.60111, 0.37341,
     0.60722, -2.7935, 1.5166, 0.71423],
    [0.097476, -0.0041668, -0.0067905, -0.0023741, -0.017046, 0.00078315, -0.12086, 0.0013979,
     0.21828, 0.15235, -0.084713, -0.47271],
    [-0.20049, -0.38635, 0.29713, -0.18115, 0.39295, -0.24351, -0.077988, -0.30948,
     -0.57836, 0.19667, 0.33011, -1.3063],
    [-0.28307, 0.73417, -0.66268, 0.84309, -1.0448, 0.63753, 0.63796, 0.89801,
     0.44713, 0.72101, -1.2469, 2.8922],
    [-0.10467, -0.31618, 0.44214, -0.90195, 0.76961, -0.15036, -0.094406, -0.63059,
     -0.99177, -2.1352, 1.5717, 1.7892],
    [0.1033, -0.01501, -0.015139, 0.037651, -0.02224, -0.045766, -0.08965, 0.015283,
     0.21396, 0.2113, -0.10011, -0.69602],
])
STRAIN = np.array([
    [-0.0050202, -0.0031391, 0.0045337, -0.0012814, -0.0024127, -0.10736, 0.10867],
    [-0.0038674, -0.00045289, -0.0099256, 0.0071947, -0.0080725, -0.11017, 0.11406],
    [-0.003672, 0.014602, -0.0059744, 0.0060696, -0.039256, 0.19728, -0.11489],
])
HARDENING = np.array([
    [0.17271, 0.23776, 0.13864, -0.11552, 0.18791, -0.28423, -0.65767, -0.46115,
     0.13027],
    [-0.17355, -0.21899, -0.3089, 0.27061, -0.22894, 0.46274, 1.0345, 0.55348,
     0.41784],
    [0.041421, 0.0034487, 0.025775, -0.10429, -0.0053371, -0.028985, -0.044765, 0.031657,
     -0.051875],
    [0.7855, 0.33686, -0.15494, 0.098898, -0.36732, 0.14381, 1.1102, -1.6019,
     2.1411],
    [-0.56892, -0.26443, 0.15359, 0.45088, 0.69285, -0.26228, -1.8286, 0.27051,
     -1.7515],
    [0.043186, -0.051926, 0.01937, -1.1593, 0.0059775, 0.26659, 0.063397, 1.6547,
     -0.51271],
    [0.55765, 0.16345, 0.023187, -0.0033135, 0.18833, 0.014499, 0.20756, -0.84176,
     1.1476],
    [-0.92676, -0.075544, -0.12428, 0.36929, 0.19291, -0.065506, -0.9915, 1.3357,
     -1.4074],
    [0.10173, -0.15725, 0.070963, -0.49754, 0.032011, 0.42207, 0.095702, 0.49031,
     0.0028369],
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
    T = max(t - 0.45, 0.0)
    m = 100.0 / min(max(yield_ratio, LEAST_RATIO), LARGEST_RATIO)
    plain = (1.0, u, v, u * u, u * v, v * v, t, t * u, t * t, t * t * u, t * v, T)
    strain = (1.0, m, m * u, m * v, m * t, m * T, m * m * T)
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
