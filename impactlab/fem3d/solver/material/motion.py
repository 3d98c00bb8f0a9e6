"""What a velocity gradient does to a stress: it strains the material, and turns it."""

from __future__ import annotations

from impactlab.fem3d.solver.elements.vectors import Tensor, Vector
from impactlab.fem3d.solver.jit import inlined
from impactlab.fem3d.solver.material.plasticity import Six, less


@inlined
def deviatoric_rate(L: Tensor) -> Six:
    """Deviator of the strain rate, in 1/s."""
    third = (L[0][0] + L[1][1] + L[2][2]) / 3.0
    return (
        L[0][0] - third,
        L[1][1] - third,
        L[2][2] - third,
        0.5 * (L[1][2] + L[2][1]),
        0.5 * (L[2][0] + L[0][2]),
        0.5 * (L[0][1] + L[1][0]),
    )


@inlined
def spin(L: Tensor, dt: float) -> Vector:
    """Angles in rad by which the material turns about x, y and z in a step."""
    half = 0.5 * dt
    return (half * (L[2][1] - L[1][2]), half * (L[0][2] - L[2][0]), half * (L[1][0] - L[0][1]))


@inlined
def turned(s: Six, r: Vector) -> Six:
    """The tensor turned by small angles, to second order (Jaumann's rate)."""
    first = _rate(s, r)
    return less(less(s, -1.0, first), -0.5, _rate(first, r))


@inlined
def _rate(s: Six, r: Vector) -> Six:
    """W s - s W, W a = r x a."""
    return (
        2.0 * (r[1] * s[4] - r[2] * s[5]),
        2.0 * (r[2] * s[5] - r[0] * s[3]),
        2.0 * (r[0] * s[3] - r[1] * s[4]),
        r[0] * (s[1] - s[2]) - r[1] * s[5] + r[2] * s[4],
        r[1] * (s[2] - s[0]) - r[2] * s[3] + r[0] * s[5],
        r[2] * (s[0] - s[1]) - r[0] * s[4] + r[1] * s[3],
    )
