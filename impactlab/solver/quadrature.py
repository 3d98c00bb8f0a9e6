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
def _legendre_point(x: float, points: int) -> tuple[float, float]:
    """Return a root of P_n near x, n = points, and its weight 2 (1 - x^2)/(n P_{n-1})^2."""
    for _ in range(_NEWTON_STEPS):
        value, lower = legendre_pair(points, x)
        step = value * (x * x - 1.0) / (points * (x * value - lower))
        x -= step
        if abs(step) < 1e-15:
            break
    value, lower = legendre_pair(points, x)
    return x, 2.0 * (1.0 - x * x) / (points * lower) ** 2


@compiled
def _lobatto_point(x: float, points: int) -> tuple[float, float]:
    """Return a root of (1 - x^2) P'_n near x and its weight 2/(n (n + 1) P_n^2), n = points - 1."""
    n = points - 1
    for _ in range(_NEWTON_STEPS):
        value, lower = legendre_pair(n, x)
        step = (x * value - lower) / (points * value)
        x -= step
        if abs(step) < 1e-15:
            break
    value, lower = legendre_pair(n, x)
    return x, 2.0 / (n * points * value * value)


@compiled
def upper_half(rule: int, points: int, positions: Array, weights: Array) -> None:
    """Fill `positions`, `weights`, shape (points // 2,), with the points above 0, outermost first.

    The rest of the rule is their mirror image, and for odd P the point 0, which bends nothing.
    """
    for j in range(points // 2):
        if rule == LOBATTO:
            guess = math.cos(math.pi * j / (points - 1))
            positions[j], weights[j] = _lobatto_point(guess, points)
        elif rule == LEGENDRE:
            guess = math.cos(math.pi * (j + 0.75) / (points + 0.5))
            positions[j], weights[j] = _legendre_point(guess, points)
        else:
            positions[j], weights[j] = 1.0 - (2 * j + 1) / points, 2.0 / points


def rule_points(rule: str, points: int) -> np.ndarray:
    """Return the positions of a rule's fibres in [-1, 1], ascending, shape (points,)."""
    half = np.empty((2, points // 2))
    upper_half(RULES.index(rule), points, half[0], half[1])
    middle = np.zeros(points % 2)
    return np.concatenate([-half[0], middle, half[0][::-1]])
