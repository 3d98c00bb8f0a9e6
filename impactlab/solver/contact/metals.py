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
"""The same, beyond which runs are marked: at 0.5 and 0.9 contacts end 3 and 5.4 % sooner than in
3-D, and at 0.9 dents are 8 % deeper."""
LARGEST_HARDENED = 2.0
"""Hardened flow stress under the contact over the other body's yield stress, beyond which runs are
marked: that body then yields more than in the data; at 4.2 the force is 8 % too large."""
ONSET, ONSET_EXPONENT = 0.33, -0.14
"""First-order parts of what is recovered and of the exponent in w (finite_element.py): no metal
creates energy if the first is below 0.5 plus 0.4 times the second."""

# fmt: off
PLAIN = np.array([
    [0.036613, -0.11674, 0.16959, 0.11718, 0.21114, -0.056369, 0.064803, -0.11094,
     -0.13402, 0.078503, 0.24073, 0.10058],
    [0.13369, 0.040701, -0.087641, 0.12006, -0.27382, 0.18325, 0.078074, 0.114,
     0.20065, 0.88444, -0.52401, 0.097496],
    [0.30151, -0.2814, 0.099664, -0.44587, -0.09922, -0.206, -0.60958, -0.43698,
     -0.20718, -0.48319, 0.0086653, -2.1227],
    [0.5314, -0.090967, -0.010869, 0.48604, 0.24226, 0.08278, -0.34694, 0.5704,
     1.3137, 0.40606, 0.40012, 0.65849],
    [-0.34934, 0.047191, -0.02234, -0.036988, -0.0060394, -0.0032468, 0.14752, -0.015272,
     -0.2714, -0.090822, -0.018558, 0.26745],
    [0.3168, -0.62519, 1.0438, 0.13398, 0.61891, -0.1612, 0.41435, -0.79419,
     -0.66801, 2.0292, 0.22863, -1.8693],
    [-0.79136, 0.74508, -2.0489, 0.052652, -1.5831, 0.45722, -0.34927, 0.70846,
     -0.97368, -0.62347, -1.2109, 3.6607],
    [0.079696, -0.16039, 0.99911, -0.09479, 1.152, -0.34931, 0.2764, 0.34663,
     1.029, -2.7477, 1.4881, 1.0601],
    [0.093449, -0.0044688, -0.00077097, -0.014269, -0.023674, 0.0048426, -0.056603, -0.028941,
     0.086044, 0.22027, -0.078121, -0.41884],
    [-0.20383, -0.34205, 0.27815, -0.20112, 0.38629, -0.22121, -0.10127, -0.15492,
     -0.35841, -0.25148, 0.27295, -1.4509],
    [-0.26728, 0.66751, -0.58846, 0.72641, -1.0908, 0.53895, 0.47967, 0.89426,
     0.68877, 0.76268, -1.0637, 2.4226],
    [-0.06836, -0.36544, 0.37077, -0.48305, 0.87727, -0.056545, -0.26561, -0.82622,
     -0.68427, -1.5574, 1.2785, 1.9357],
    [0.091075, -0.0040546, -0.010659, -0.0036773, -0.030545, -0.046143, -0.018125, 0.0075815,
     0.05986, 0.21354, -0.072584, -0.57835],
])
STRAIN = np.array([
    [-0.0049846, -0.0033871, 0.0046969, -0.0013553, -0.0010898, -0.1161, 0.11371],
    [-0.0034556, -0.0003392, -0.010335, 0.0064858, -0.0097802, -0.12481, 0.13648],
    [-0.0024403, 0.01563, -0.0078094, 0.0036527, -0.045727, 0.17486, -0.071184],
])
HARDENING = np.array([
    [0.16966, 0.1807, 0.10757, -0.13969, 0.18461, -0.25157, -0.58801, -0.72838,
     0.17754],
    [-0.16655, -0.093521, -0.25226, 0.36623, -0.21848, 0.34982, 0.89426, 0.86379,
     0.3233],
    [0.040573, -0.0051433, 0.022082, -0.11628, -0.0061295, -0.017989, -0.03374, 0.025988,
     -0.052825],
    [0.8084, 0.44971, -0.11666, -0.049877, -0.2577, -0.38387, 0.61109, -1.2679,
     2.6465],
    [-0.59914, -0.45863, 0.07789, 0.65495, 0.53004, 0.52709, -1.1864, -0.42594,
     -2.472],
    [0.058319, -0.021414, 0.0427, -1.0716, -0.018777, 0.14968, 0.21886, 1.577,
     -0.37452],
    [0.66433, 0.23759, -0.013183, -0.13645, 0.33117, -0.79429, -0.92232, -0.80236,
     2.112],
    [-1.0553, -0.19081, -0.13578, 0.67851, -0.10494, 1.0215, 0.38862, 0.75873,
     -2.6649],
    [0.10438, -0.19973, 0.10175, -0.37626, 0.17079, 0.3664, 0.10507, 0.39189,
     0.2934],
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
