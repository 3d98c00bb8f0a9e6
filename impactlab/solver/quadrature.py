"""Integration rules over the depth, mapped to [-1, 1]: points z/(H/2), weights that sum to 2.

Computed for any number of points P by Newton's method on the Legendre polynomials.
"""

from __future__ import annotations

import math

import numpy as np

from impactlab.solver import RULES
from impactlab.solver.jit import compiled
from impactlab.solver.types import Array

LOBATTO = RULES.index("lobatto")
LEGENDRE = RULES.index("legendre")
_NEWTON_STEPS = 100


@compiled
def legendre_pair(degree: int, x: float) -> tuple[float, float]:
    """Return (P_n(x), P_{n-1}(x)), n = degree >= 1, by the three-term recurrence."""
    previous, current = 1.0, x
    for k in range(2, degree + 1):
        previous, current = current, ((2 * k - 1) * x * current - (k - 1) * previous) / k
    return current, previous


@compiled
def upper_half(rule: int, points: int, positions: Array, weights: Array) -> None:
    """Fill `positions`, `weights`, shape (points // 2,), with the points above 0, outermost first.

    The rest of the rule is their mirror image, and for odd P the point 0, which bends nothing.
    Legendre: the roots of P_n, n = P, with the weights 2 (1 - x^2)/(n P_{n-1})^2. Lobatto: those of
    (1 - x^2) P'_n, n = P - 1, with 2/(n (n + 1) P_n^2).
    """
    lobatto = rule == LOBATTO
    n = points - 1 if lobatto else points
    for j in range(points // 2):
        if not (lobatto or rule == LEGENDRE):
            positions[j], weights[j] = 1.0 - (2 * j + 1) / points, 2.0 / points
            continue
        if lobatto:
            x = math.cos(math.pi * j / (points - 1))
        else:
            x = math.cos(math.pi * (j + 0.75) / (points + 0.5))
        for _ in range(_NEWTON_STEPS):
            value, lower = legendre_pair(n, x)
            step = x * value - lower
            step = step / (points * value) if lobatto else value * (x * x - 1.0) / (points * step)
            x -= step
            if abs(step) < 1e-15:
                break
        value, lower = legendre_pair(n, x)
        positions[j] = x
        if lobatto:
            weights[j] = 2.0 / (n * points * value * value)
        else:
            weights[j] = 2.0 * (1.0 - x * x) / (points * lower) ** 2


def rule_points(rule: str, points: int) -> np.ndarray:
    """Return the positions of a rule's fibres in [-1, 1], ascending, shape (points,)."""
    half = np.empty((2, points // 2))
    upper_half(RULES.index(rule), points, half[0], half[1])
    middle = np.zeros(points % 2)
    return np.concatenate([-half[0], middle, half[0][::-1]])
