"""Sections of the beam: one class per shape, and the fibres that an integration rule cuts it into.

Kernels, limits, costs, the 3-D model and the checks know a section by what its class gives. Where
the extents themselves count (the flat top under the sphere, the faces of the 3-D model, the tables
of contact_compliance.py, a strip's bending across its width), they are its `width` and `depth`.

A further shape is a class here with its name in SHAPES, its dimensions as fields of `Beam` and as
parameters, and a number in the case table, by which `section_of` chooses. The kernels take a
section that is symmetric about its axis: of its fibres they keep those above, each counted twice.
The rules, on [-1, 1] over the depth with weights that sum to 2, are computed for any number of
points by Newton's method on the Legendre polynomials.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from impactlab.solver import RULES
from impactlab.types import Floats

_NEWTON_STEPS = 100


@dataclass(frozen=True)
class Rectangle:
    """A rectangular section, or one per beam in columns.

    Parameters
    ----------
    width, depth : float
        Side across and along the velocity, in m.

    Notes
    -----
    Products keep the order in which results have always been rounded.

    Examples
    --------
    >>> il.paper_impact().beam.section
    Rectangle(width=0.06, depth=0.0278)
    """

    width: Any
    depth: Any

    @property
    def area(self) -> Any:
        """Area of the section.

        Returns
        -------
        float
            A, in m2.
        """
        return self.width * self.depth

    @property
    def second_moment(self) -> Any:
        """Second moment of area about the axis.

        Returns
        -------
        float
            I, in m4.
        """
        return self.bending_stiffness(1.0)

    @property
    def stress_per_moment(self) -> Any:
        """Stress in the outermost fibre of an elastic section over the bending moment.

        Returns
        -------
        float
            Reciprocal of the section modulus, in 1/m3.
        """
        return 6.0 / (self.width * self.depth * self.depth)

    @property
    def plastic_modulus(self) -> Any:
        """Bending moment over the yield stress where every fibre yields.

        Returns
        -------
        float
            Plastic section modulus, in m3.
        """
        return 0.25 * self.width * self.depth * self.depth

    @staticmethod
    def shear_coefficient(poissons_ratio: Any) -> Any:
        """Return the shear coefficient of Timoshenko's beam.

        Parameters
        ----------
        poissons_ratio : float
            Poisson's ratio of the metal, which changes nothing here.

        Returns
        -------
        float
            k = 5/6.
        """
        return 5.0 / 6.0

    def mass_per_length(self, density: Any) -> Any:
        """Return the mass of a beam per length.

        Parameters
        ----------
        density : float
            Density, in kg/m3.

        Returns
        -------
        float
            rho A, in kg/m.
        """
        return density * self.width * self.depth

    def bending_stiffness(self, youngs_modulus: Any) -> Any:
        """Return the bending stiffness of the exact section, not that of an integration rule.

        Parameters
        ----------
        youngs_modulus : float
            Young's modulus, in Pa.

        Returns
        -------
        float
            EI, in N m2.
        """
        return youngs_modulus * self.width * self.depth**3 / 12.0

    def rotary_inertia(self, density: Any) -> Any:
        """Return the rotary inertia of a beam per length.

        Parameters
        ----------
        density : float
            Density, in kg/m3.

        Returns
        -------
        float
            rho I, in kg m.
        """
        return density * self.area * (self.depth * self.depth) / 12.0

    def plate_stiffness(self, youngs_modulus: Any, poissons_ratio: Any) -> Any:
        """Return the bending stiffness of a plate as wide as the section.

        Parameters
        ----------
        youngs_modulus : float
            Young's modulus, in Pa.
        poissons_ratio : float
            Poisson's ratio.

        Returns
        -------
        float
            EI/(1 - nu^2), in N m2.
        """
        stiffness = youngs_modulus * self.width * (self.depth * self.depth * self.depth)
        return stiffness / (12.0 * (1.0 - poissons_ratio * poissons_ratio))

    def fibres(self, positions: Floats, weights: Floats) -> tuple[Floats, Floats]:
        """Return the fibres into which an integration rule cuts the section.

        Parameters
        ----------
        positions, weights : numpy.ndarray
            Points of the rule on [-1, 1] and weights that sum to 2, shape (points,).

        Returns
        -------
        z, area : numpy.ndarray
            Distance from the axis in m and area in m2, shape (points,), or (beams, points).
        """
        z = np.multiply.outer(0.5 * np.asarray(self.depth), positions)
        return z, np.multiply.outer(0.5 * np.asarray(self.area), weights)


SHAPES = {"rectangle": Rectangle}
"""Every shape of the section, by name."""


def section_of(cases: Any) -> Rectangle:
    """Return the section of a case, or of many; cases: records of solver.types.CASE, or columns."""
    return Rectangle(cases["beam_width"], cases["beam_depth"])


def fibre_table(cases: Any) -> Floats:
    """Return the fibres above the axis that the kernels take, (cases, 2, most points // 2).

    Of each case distances from the axis (m), outermost first, and areas (m2), twice a fibre's:
    each stands for its mirror image, too. Cases of fewer points leave the end of their rows at 0.
    """
    table = np.zeros((cases.size, 2, cases["points"].max(initial=0) // 2))
    for number, points in set(zip(cases["rule"].tolist(), cases["points"].tolist(), strict=True)):
        alike = (cases["rule"] == number) & (cases["points"] == points)
        z, area = section_of(cases[alike]).fibres(*integration_rule(RULES[number], points))
        half = points // 2
        table[alike, 0, :half] = z[:, : -half - 1 : -1]
        table[alike, 1, :half] = 2.0 * area[:, : -half - 1 : -1]
    return table


@cache
def integration_rule(rule: str, points: int) -> tuple[Floats, Floats]:
    """Return positions in ascending order and weights of a rule on [-1, 1], both (points,).

    Legendre: the roots of P_n, n = P, with the weights 2 (1 - x^2)/(n P_{n-1})^2. Lobatto: those of
    (1 - x^2) P'_n, n = P - 1, with 2/(n (n + 1) P_n^2). Layers: the midpoints of equal layers.
    """
    place = {"lobatto": _lobatto, "legendre": _gauss, "layers": _layer}[rule]
    pairs = [place(j, points) for j in range((points + 1) // 2)]  # outermost first
    x, weights = np.array(pairs).T
    if points % 2:
        x[-1] = 0.0
    below = slice(None, points // 2)
    positions = np.concatenate([-x[below], x[::-1]])
    return positions, np.concatenate([weights[below], weights[::-1]])


def _layer(j: int, points: int) -> tuple[float, float]:
    return 1.0 - (2 * j + 1) / points, 2.0 / points


def _gauss(j: int, points: int) -> tuple[float, float]:
    x = math.cos(math.pi * (j + 0.75) / (points + 0.5))
    for _ in range(_NEWTON_STEPS):
        value, lower = legendre_pair(points, x)
        step = value * (x * x - 1.0) / (points * (x * value - lower))
        x -= step
        if abs(step) < 1e-15:
            break
    _, lower = legendre_pair(points, x)
    return x, 2.0 * (1.0 - x * x) / ((points * lower) * (points * lower))


def _lobatto(j: int, points: int) -> tuple[float, float]:
    n, x = points - 1, math.cos(math.pi * j / (points - 1))
    for _ in range(_NEWTON_STEPS):
        value, lower = legendre_pair(n, x)
        step = (x * value - lower) / (points * value)
        x -= step
        if abs(step) < 1e-15:
            break
    value, _ = legendre_pair(n, x)
    return x, 2.0 / (n * points * value * value)


def legendre_pair(degree: int, x: float) -> tuple[float, float]:
    """Return (P_n(x), P_{n-1}(x)), n = degree >= 1, by the three-term recurrence."""
    previous, current = 1.0, x
    for k in range(2, degree + 1):
        previous, current = current, ((2 * k - 1) * x * current - (k - 1) * previous) / k
    return current, previous
