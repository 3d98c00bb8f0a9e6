"""Elastic-perfectly plastic contact fitted to finite elements, loading and unloading.

Source: tests/benchmarks/sphere_indentation.py, an axisymmetric quasi-static solve of an elastic
sphere (profile and compliance of the half-space's material) on a half-space, without friction, with
finite strains, E*/S_y = 333, nu = 0.3; its data are in finite_element.csv. x = delta/delta_y with
Stronge's delta_y and F_y (th = 1.1), log = ln x:
    x <= 1     Hertz
    loading    F = F_y x^1.5 exp(a_2 log^2 + a_3 log^3)
    unloading  F = F_m ((delta - delta_r)/(delta_m - delta_r))^n,
               delta_m - delta_r = delta_y sqrt(F_m/F_y) (1 + r_1 log + ... + r_4 log^4),
               n = 1.5 + n_1 log + ... + n_4 log^4
The fit, with weights that grow with the elements in contact, is within 3.6 % of every point of
loading, 1.0 % in the mean (nodes that touch one by one make the points scatter by as much), within
0.35 % of their mean over a third of a decade, and within 0.4 % of what is recovered. Half as many
more elements lower the force by 0.1 % in the mean, half as long steps raise it by 0.1 %. On the
same mesh E*/S_y = 600 or small strains raise the force by 0.4 and 0.5 % in the mean from x = 32 on,
by 1.1 and 1.4 % at the end; a rigid sphere of the same E* lowers it by 8 %.
"""

from __future__ import annotations

import math

from impactlab.solver.contact.stronge import yield_indentation
from impactlab.solver.jit import compiled
from impactlab.solver.types import Unloading

LARGEST_INDENTATION = 320.0
"""x at which the data end."""
LARGEST_DEPTH = 0.0194
"""delta/R at which they do."""
LEAST_RATIO, LARGEST_RATIO = 300.0, 660.0
"""E*/S_y: those of the data, 333 and 600, by a tenth beyond them."""

# Ends of what impacts of yielding contacts have in common with the data, of this law and of the
# corrections made for it: beyond, the dent or the force of the corrected model differs from 3-D
# finite elements by more than 2 %.
LEAST_POISSONS_RATIO, LARGEST_POISSONS_RATIO = 0.22, 0.36
"""Of the flat; the data have 0.3. At 0.05 the dent is off by -6 %, at 0.45 by +5 %: in
proportion, 2 % here."""
LARGEST_HARDENING = 0.004
"""Hardening moduli of the flat over its Young's modulus; the data have none. At 0.0048 the dent is
off by 2.3 %, at 0.024 by 7 to 11 %."""
LEAST_HARDNESS = 1.7
"""Yield stress of the sphere over that of the flat; the sphere of the data is elastic. At 1.74 all
is within 2 %, at 1.3 the dent is off by -2.9 %, at 1 by -11 %."""
LEAST_STIFFNESS, LARGEST_STIFFNESS = 0.75, 1.75
"""Young's modulus of the sphere over that of the flat; the data have 1. At 1.7 all is within 2 %,
at 3 the dent is off by -4 %, at 1/3 by +7 %: by its logarithm, 2 % here."""
LARGEST_CIRCLE, LARGEST_CIRCLE_ACROSS = 0.6, 0.3
"""Contact radius over half the depth and over half the width of the beam, for the corrections. On
the paper's beam all is within 2 % up to 0.58 and 0.27 (15 m/s), and the indentation off by 3.6 % at
0.67 (20 m/s). Force and indentation are off by 3 and 2 % on a beam of 12 by 12 mm at 0.37 of both,
by 6 and 2 % on one of 27.8 by 27.8 mm at 0.41 (10 m/s), each on one mesh with 5.5 elements over the
radius. That sections yield does not tell these apart: the paper's does, too, at 15 m/s."""


@compiled
def curve(delta: float, E: float, R: float, S_y: float, nu: float) -> Unloading:
    """Return force and unloading curve of the fit (see contact/hertz.py for the form).

    Beyond the data the force grows with the indentation, and the unloading keeps its shape.
    """
    K = 4.0 / 3.0 * E * math.sqrt(R)
    delta_y = yield_indentation(E, R, S_y)
    if delta <= delta_y:
        return K * delta * math.sqrt(delta), K, 0.0, 1.5
    x = min(delta / delta_y, LARGEST_INDENTATION)
    log = math.log(x)
    ratio = x * math.sqrt(x) * math.exp(log * log * (-0.03499424 + 0.00025112 * log))
    ratio *= max(delta / (LARGEST_INDENTATION * delta_y), 1.0)
    F = ratio * K * delta_y * math.sqrt(delta_y)
    share = 0.01483939 - 0.00101521 * log
    share = 1.0 + log * (0.20880608 + log * (-0.07558935 + log * share))
    n = 0.01219818 - 0.00097196 * log
    n = 1.5 + log * (-0.06673731 + log * (-0.0293631 + log * n))
    recovered = delta_y * math.sqrt(ratio) * share
    return F, F / recovered**n, delta - recovered, n


@compiled
def limit(E: float, R: float, S_y: float, nu: float) -> float:
    """Return the indentation (m) at which the data end, in first yields or in radii.

    For other ratios of E*/S_y than those of the data it is that of first yield.
    """
    if not LEAST_RATIO <= E / S_y <= LARGEST_RATIO:
        return yield_indentation(E, R, S_y)
    return min(LARGEST_INDENTATION * yield_indentation(E, R, S_y), LARGEST_DEPTH * R)


@compiled
def radius(delta: float, E: float, R: float, S_y: float, nu: float) -> float:
    """Return the radius (m) of the contact circle, fitted to within half an element."""
    log = math.log(max(min(delta / yield_indentation(E, R, S_y), LARGEST_INDENTATION), 1.0))
    return math.sqrt(R * delta * (1.0 + 0.04 * log * log))
