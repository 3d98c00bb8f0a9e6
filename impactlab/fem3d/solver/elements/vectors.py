"""Vectors of three numbers as tuples: what compiles into plain arithmetic."""

from __future__ import annotations

from impactlab.fem3d.solver.jit import inlined

Vector = tuple[float, float, float]
Tensor = tuple[Vector, Vector, Vector]


@inlined
def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inlined
def dot(a: Vector, b: Vector) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def add(a: Vector, b: Vector) -> Vector:
    """Sum."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@inlined
def times(factor: float, a: Vector) -> Vector:
    """Product with a number."""
    return (factor * a[0], factor * a[1], factor * a[2])


@inlined
def plus(a: Vector, factor: float, b: Vector) -> Vector:
    """a + factor b."""
    return (a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2])


@inlined
def apply(S: Tensor, a: Vector) -> Vector:
    """S a, S by rows."""
    return (dot(S[0], a), dot(S[1], a), dot(S[2], a))


@inlined
def combine(e: Tensor, q: Vector) -> Vector:
    """q_1 e_1 + q_2 e_2 + q_3 e_3."""
    return plus(plus(times(q[0], e[0]), q[1], e[1]), q[2], e[2])
