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
nine that grow with q sqrt(x), q = H (1 - nu^2)/(E share), H its hardening modulus. Unloading yields
in reverse where

    z = w^2 k^2 q sqrt(x) max(1 - 1.4 t, 0)/(1 + (1 - k) q sqrt(x)),    w = 1 - 1/sqrt(x),

is above z_0 = 0.29 (1 - 0.51 u + 0.59 v). With e = z - z_0, and D the dent over what is recovered
otherwise, what is recovered is longer by L = 0.18 e^2 D/(e + 0.012 D/share^2) of itself, and the
exponent larger by 2.24 L/(1 + 0.53 L) (tests/benchmarks/reversal.py).

The softer body begins to yield at x = x_0 = y^2, with y(nu) by von Mises below a Hertzian contact,
the harder one at (y S_other/S)^2. A few first yields deep, the dent over the indentation is d, with
d^2.3 the sum over both bodies of (A exp(0.35 w_0) w_0^p)^2.3, w_0 = 1 - sqrt(x_0/x), where
A = 0.55 share^0.22 exp(-0.96 q) and p = 1.63 - 0.24 ln share have the body's own share of the
compliance; q is 0 and nu 0.3 for the harder one (tests/benchmarks/first_dents.py). Of what both
yield the softer one has the share 1/(1 + (r^2.8 d_2/d_1)^2.3), with the two dents of that sum and
r, the softer body's hardened flow stress over the other one's yield stress: 0.47 of two metals of
S_other/S = 1.045 a few first yields deep, where it is 1 at 1.5, and 0.48, 0.85 and 1 at 1, 1.3 and
2 deep in steel, by what a compressed beam changes of dents in 3-D.

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
REVERSED = 1.4
"""Factor of t in z."""
LEAST_REVERSAL, LARGEST_REVERSAL = (0.29, -0.51, 0.59), 2.7
"""Factors of z_0, and z at which it is held: there its data end, and beyond it runs are marked."""
REVERSED_RECOVERY, REVERSED_EXPONENT = (0.18, 0.012), (2.24, 0.53)
"""Factors of L and of what it adds to the exponent."""
FIRST_YIELD = 0.97744, 0.72573, 0.34947, 0.13914
"""Coefficients of y, a cubic in nu - 0.3: within 5e-5, the peak pressure over 1.65 S at which the
von Mises stress on the axis of a Hertzian contact (Johnson 1985, Eq. 3.45) is S."""
FIRST_DENT, FIRST_DENT_POWER, FIRST_DENT_GROWTH = (-0.589, 0.218, -0.961), (1.627, -0.241), 0.352
"""Factors of ln A, of p, and in the exponential."""
BOTH_BODIES, FLOWS = 2.3, 2.8
"""Power in which the dents of both bodies are summed, and that of r in the softer one's share."""
LARGEST_HARDENED = 2.0
"""Hardened flow stress under the contact over the other body's yield stress, beyond which runs are
marked: that body then yields more than in the data; at 4.2 the force is 8 % too large."""
LARGEST_HARDENED_FAR, FAR_REVERSAL = 1.0, 0.5
"""The same beyond 0.024 R, and z beyond which it is the same: no more was compared with 3-D. From
1.1 on, the force is 3 to 8 % above the data."""
SUNK_IN = 0.47, 1.5
"""Share that hardening takes off a^2/(R delta) in the end, for metal that hardens sinks in around a
contact, and how that falls with t: of two bodies that yield it presses the other one flat."""
ONSET, ONSET_EXPONENT = 0.36, -0.074
"""First-order parts of what is recovered and of the exponent in w (finite_element.py): no metal
creates energy if the first is below 0.5 plus 0.4 times the second."""

# fmt: off
PLAIN = np.array([
    [0.032851, -0.088327, 0.16033, 0.091453, 0.23912, -0.05834, 0.089458, -0.15796,
     -0.10479, 0.11501, 0.24777, -0.035993],
    [0.14274, -0.007126, -0.074368, 0.15985, -0.31684, 0.18104, 0.048194, 0.15701,
     0.10976, 0.86248, -0.52334, 0.21624],
    [0.30428, -0.31669, 0.099069, -0.42534, -0.1039, -0.20538, -0.60522, -0.40161,
     -0.23955, -0.28306, 0.014117, -1.685],
    [0.52193, -0.047801, -0.0031981, 0.48924, 0.24925, 0.10893, -0.27187, 0.38536,
     1.3058, 0.44134, 0.37759, 0.10904],
    [-0.34967, 0.049555, -0.023661, -0.043063, -0.0041585, -0.0060407, 0.13401, 0.013224,
     -0.24714, -0.14405, -0.018467, 0.28811],
    [0.27275, -0.5525, 0.94754, 0.10628, 0.51801, -0.12506, 0.42087, -0.64353,
     -0.82335, 1.7507, 0.27439, -2.0106],
    [-0.63772, 0.61842, -1.8158, 0.099785, -1.3152, 0.35514, -0.25914, 0.11083,
     -0.80535, 0.10662, -1.294, 4.8552],
    [-0.013167, -0.1642, 0.88056, -0.034934, 0.99519, -0.33247, 0.31308, -0.21496,
     0.76793, -0.43128, 1.4998, -1.5179],
    [0.091938, 0.0039367, -0.0044365, -0.031488, -0.022527, 0.015418, -0.10559, 0.19664,
     0.18086, -0.34895, -0.076445, -0.14954],
    [-0.26216, -0.27205, 0.18624, -0.26593, 0.24805, -0.24951, -0.18515, -0.21506,
     -0.44719, -0.12778, 0.20224, -1.1448],
    [-0.11338, 0.5415, -0.45118, 0.81336, -0.90162, 0.44905, 0.73587, 0.40168,
     0.64469, 1.5103, -0.87365, 2.3663],
    [-0.16653, -0.34386, 0.46002, -0.4356, 0.91142, 0.16059, -0.11528, -1.1332,
     -1.1673, -0.16576, 1.1121, 0.79373],
    [0.086868, 0.0025088, -0.034504, -0.020341, -0.036128, -0.057829, -0.090181, 0.21095,
     0.20641, -0.27855, -0.068926, -0.4075],
])
STRAIN = np.array([
    [-0.0048984, -0.003187, 0.0045924, -0.0013478, -0.002335, -0.14145, 0.14126],
    [-0.0033468, -0.0016657, -0.0072014, 0.0074778, -0.0061121, -0.24179, 0.22184],
    [-0.0022506, 0.017417, -0.0030366, 0.0075581, -0.049337, 0.061803, 0.025389],
])
HARDENING = np.array([
    [0.15406, 0.18106, 0.048175, -0.16434, 0.10166, 0.048864, -0.10984, -0.72681,
     -0.097315],
    [-0.13563, -0.085927, -0.16631, 0.47449, -0.12058, -0.027477, 0.096465, 0.70546,
     0.64391],
    [0.038381, -0.0056557, 0.018398, -0.12729, -0.0076797, -0.0094264, 0.013203, 0.042424,
     -0.062339],
    [0.75335, 0.27259, -0.1334, 0.20858, -0.31639, 0.20563, 0.23273, -0.69417,
     2.4858],
    [-0.53025, -0.2588, 0.095177, 0.67769, 0.61893, -0.17426, -0.24836, -2.5723,
     -2.5118],
    [0.074991, 0.054841, 0.047813, -1.2091, -0.1273, -0.24094, -0.32094, 2.8745,
     0.28242],
    [0.61894, 0.059857, -0.0049363, 0.43269, -0.070659, 0.11022, -0.66888, -0.69875,
     1.2289],
    [-1.0177, -0.024985, -0.13138, 0.12865, 0.51207, -0.055103, 0.53345, -0.36051,
     -1.7443],
    [0.16479, -0.053408, 0.12122, -0.3735, -0.1975, -0.10223, -0.18834, 1.3309,
     0.74029],
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
def first_yield(nu: float) -> float:
    """Return sqrt(delta/delta_y) at which a body under a harder one begins to yield."""
    v = nu - 0.3
    c = FIRST_YIELD
    return c[0] + v * (c[1] + v * (c[2] + v * c[3]))


@compiled
def first_dent(root: float, shape: Shape) -> float:
    """Return the dent over the indentation, a few first yields deep.

    root: 1/sqrt(x).
    """
    total = 0.0
    for body in (32, 35):
        w = 1.0 - shape[body] * root
        if w > 0.0:
            dent = math.exp(shape[body + 1] + FIRST_DENT_GROWTH * w) * w ** shape[body + 2]
            total += dent**BOTH_BODIES
    return float(total ** (1.0 / BOTH_BODIES))


@compiled
def softer_share(x: float, shape: Shape) -> float:
    """Return the share of the softer body in what both yield; x: delta/delta_y."""
    root = 1.0 / math.sqrt(x)
    w, others = 1.0 - shape[32] * root, 1.0 - shape[35] * root
    if others <= 0.0:
        return 1.0
    if w <= 0.0:
        return 0.0
    log = shape[36] - shape[33] + FIRST_DENT_GROWTH * (others - w)
    log += shape[37] * math.log(others) - shape[34] * math.log(w)
    log += FLOWS * math.log(shape[31] * hardened(shape[25], x))
    return 1.0 / (1.0 + math.exp(BOTH_BODIES * log))


@compiled
def shape(
    yield_ratio: float,
    share: float,
    nu: float,
    hardening: float,
    kinematic: float,
    hardness: float,
) -> Shape:
    """Return the coefficients of the curve of two metals, q, those of z, L and circle, S/S_other.

    Last come sqrt(x_0), ln A and p of the softer body, then of the harder one.

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
    own, others = math.log(share), math.log(1.0 - share)
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
        k * k * q * max(1.0 - REVERSED * t, 0.0),
        (1.0 - k) * q,
        LEAST_REVERSAL[0] * (1.0 + LEAST_REVERSAL[1] * u + LEAST_REVERSAL[2] * v),
        REVERSED_RECOVERY[1] / (share * share),
        SUNK_IN[0] * max(1.0 - SUNK_IN[1] * t, 0.0),
        1.0 / hardness,
        first_yield(nu),
        FIRST_DENT[0] + FIRST_DENT[1] * own + FIRST_DENT[2] * q,
        FIRST_DENT_POWER[0] + FIRST_DENT_POWER[1] * own,
        FIRST_YIELD[0] * hardness,
        FIRST_DENT[0] + FIRST_DENT[1] * others,
        FIRST_DENT_POWER[0] + FIRST_DENT_POWER[1] * others,
    )


@compiled
def reversal(root: float, shape: Shape) -> float:
    """Return z of the module.

    root: sqrt(x).
    """
    w = 1.0 - 1.0 / root
    return float(w * w * shape[26] * root / (1.0 + shape[27] * root))


LIKE_METALS: Shape = (
    *PLAIN[:, 0].tolist(),
    *(STRAIN[:, 0] + STRAIN[:, 1] * 100.0 / 333.0).tolist(),
    *HARDENING[:, 0].tolist(),
    *(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    FIRST_YIELD[0],
    FIRST_DENT[0] + FIRST_DENT[1] * math.log(0.5),
    FIRST_DENT_POWER[0] + FIRST_DENT_POWER[1] * math.log(0.5),
    *(math.inf, 0.0, 0.0),
)
"""Of a flat and an elastic sphere of the same modulus, E*/S_y = 333, which do not harden."""
