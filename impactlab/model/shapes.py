"""Shapes of the section, one class each.

Shear coefficients: Cowper, J. Appl. Mech. 33 (1966) 335, of thin walls for boxes and I-sections; of
a rectangle that of energy. Products have the same bits for a column as for a number, which powers
do not.
"""

# ruff: noqa: D102 - a shape's methods are documented once, in Section

import math
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

from impactlab.model.cross_section import Section
from impactlab.model.discretisation import integration_rule
from impactlab.types import Floats

_PI = math.pi
_leggauss = cache(np.polynomial.legendre.leggauss)
_OF_ENERGY = 60
"""Points of a piece: the energy of a width that vanishes at the edge is no polynomial."""


@dataclass(frozen=True)
class Rectangle(Section):
    """A rectangular section. Products keep the order in which results have always been rounded."""

    @property
    def area(self) -> Any:
        return self.width * self.depth

    @property
    def second_moment(self) -> Any:
        return self.bending_stiffness(1.0)

    @property
    def stress_per_moment(self) -> Any:
        return 6.0 / (self.width * self.depth * self.depth)

    @property
    def plastic_modulus(self) -> Any:
        return 0.25 * self.width * self.depth * self.depth

    def shear_coefficient(self, poissons_ratio: Any) -> Any:
        return 5.0 / 6.0  # of energy; Poisson's ratio changes nothing

    def mass_per_length(self, density: Any) -> Any:
        return density * self.width * self.depth

    def bending_stiffness(self, youngs_modulus: Any) -> Any:
        return youngs_modulus * self.width * self.depth**3 / 12.0

    def rotary_inertia(self, density: Any) -> Any:
        return density * self.area * (self.depth * self.depth) / 12.0

    def plate_stiffness(self, youngs_modulus: Any, poissons_ratio: Any) -> Any:
        """Return the bending stiffness EI/(1 - nu^2) of a plate as wide as the section, in N m2."""
        stiffness = youngs_modulus * self.width * (self.depth * self.depth * self.depth)
        return stiffness / (12.0 * (1.0 - poissons_ratio * poissons_ratio))

    def fibres(self, positions: Floats, weights: Floats) -> tuple[Floats, Floats]:
        """Return the fibres of a rule; of columns of beams (beams, points)."""
        z = np.multiply.outer(0.5 * np.asarray(self.depth), positions)
        return z, np.multiply.outer(0.5 * np.asarray(self.area), weights)

    def cut(self, rule: str, points: int) -> tuple[Floats, Floats]:
        return self.fibres(*integration_rule(rule, points))


@dataclass(frozen=True)
class _Cored(Section):
    """A rectangle without a smaller one, or two beside the middle: `core` (width, depth; m)."""

    @property
    def core(self) -> tuple[Any, Any]:
        raise NotImplementedError

    @property
    def area(self) -> Any:
        b, h = self.core
        return self.width * self.depth - b * h

    @property
    def second_moment(self) -> Any:
        b, h = self.core
        return (self.width * (self.depth * self.depth * self.depth) - b * (h * h * h)) / 12.0

    @property
    def plastic_modulus(self) -> Any:
        b, h = self.core
        return 0.25 * (self.width * (self.depth * self.depth) - b * (h * h))

    def width_at(self, z: Floats) -> Floats:
        b, h = self.core
        return np.asarray(np.where(np.abs(z) < 0.5 * h, self.width - b, self.width))

    def _quadrature(self, n: int) -> tuple[Floats, Floats]:
        b, h = self.core
        return _pieces(
            [0.0, 0.5 * h, 0.5 * self.depth], [[self.width - b] * 2, [self.width] * 2], n
        )

    def _up_to(self, z: Floats) -> tuple[Floats, Floats]:
        b, h = self.core
        inner = np.minimum(z, 0.5 * h)
        return self.width * z - b * inner, 0.5 * (self.width * z**2 - b * inner**2)


@dataclass(frozen=True)
class Box(_Cored):
    """A rectangular tube of one wall thickness, in m."""

    wall_thickness: Any

    @property
    def core(self) -> tuple[Any, Any]:
        return self.width - 2.0 * self.wall_thickness, self.depth - 2.0 * self.wall_thickness

    def shear_coefficient(self, poissons_ratio: Any) -> Any:
        nu = poissons_ratio
        n = (self.width - self.wall_thickness) / (self.depth - self.wall_thickness)
        flanges = 10.0 * (n * n) * ((3.0 + nu) * n + 3.0 * (n * n))  # as thick as the webs: m = n
        return _thin_walled(n, nu, flanges)


@dataclass(frozen=True)
class ISection(_Cored):
    """A web between two equal flanges, of these thicknesses, in m."""

    flange_thickness: Any
    web_thickness: Any

    @property
    def core(self) -> tuple[Any, Any]:
        return self.width - self.web_thickness, self.depth - 2.0 * self.flange_thickness

    def shear_coefficient(self, poissons_ratio: Any) -> Any:
        nu, h = poissons_ratio, self.depth - self.flange_thickness
        n, m = self.width / h, 2.0 * self.width * self.flange_thickness / (h * self.web_thickness)
        flanges = 30.0 * (m + m * m) + 5.0 * nu * (8.0 * m + 9.0 * (m * m))
        return _thin_walled(m, nu, (n * n) * flanges)


def _thin_walled(m: Any, nu: Any, flanges: Any) -> Any:
    """Return Cowper's coefficient; m: area of the flanges over that of the webs."""
    square = m * m
    webs = 12.0 + 72.0 * m + 150.0 * square + 90.0 * (square * m)
    lateral = 11.0 + 66.0 * m + 135.0 * square + 90.0 * (square * m)
    return 10.0 * (1.0 + nu) * ((1.0 + 3.0 * m) * (1.0 + 3.0 * m)) / (webs + nu * lateral + flanges)


@dataclass(frozen=True)
class Circle(Section):
    """A solid round bar; width and depth are its diameter, in m."""

    @property
    def bore(self) -> Any:
        """Inner diameter, in m."""
        return 0.0

    @property
    def area(self) -> Any:
        return 0.25 * _PI * (self.depth * self.depth - self.bore * self.bore)

    @property
    def second_moment(self) -> Any:
        outer, inner = self.depth * self.depth, self.bore * self.bore
        return _PI / 64.0 * (outer * outer - inner * inner)

    @property
    def plastic_modulus(self) -> Any:
        d, bore = self.depth, self.bore
        return (d * d * d - bore * bore * bore) / 6.0

    def shear_coefficient(self, poissons_ratio: Any) -> Any:
        nu, m = poissons_ratio, self.bore / self.depth
        square = (1.0 + m * m) * (1.0 + m * m)
        below = (7.0 + 6.0 * nu) * square + (20.0 + 12.0 * nu) * (m * m)
        return 6.0 * (1.0 + nu) * square / below

    def width_at(self, z: Floats) -> Floats:
        outer, inner = (
            np.sqrt(np.maximum(d * d - 4.0 * z * z, 0.0)) for d in (self.depth, self.bore)
        )
        return np.asarray(outer - inner)

    def _quadrature(self, n: int) -> tuple[Floats, Floats]:
        """Use polar coordinates: no width with a vertical tangent."""
        x, along = _leggauss(n + 1)
        y, around = _leggauss(n + 12)  # of sin^(2n-1), to rounding
        wall = 0.25 * (self.depth - self.bore)
        radius, angle = 0.5 * self.bore + wall * (1.0 + x), 0.25 * _PI * (1.0 + y)
        z = np.multiply.outer(radius, np.sin(angle))
        area = np.multiply.outer(2.0 * radius * wall * along, 0.25 * _PI * around)
        return z.ravel(), area.ravel()

    def _up_to(self, z: Floats) -> tuple[Floats, Floats]:
        outer, inner = (_segment(z, 0.5 * d) for d in (self.depth, self.bore))
        return outer[0] - inner[0], outer[1] - inner[1]


@dataclass(frozen=True)
class Tube(Circle):
    """A round tube of one wall thickness, in m."""

    wall_thickness: Any

    @property
    def bore(self) -> Any:
        """Inner diameter, in m."""
        return self.depth - 2.0 * self.wall_thickness


def profile_points(profile: Any) -> tuple[tuple[float, float], ...]:
    """Return the points of a profile, which may be text or pairs; see Profile.

    Raises TypeError or ValueError where they are no pairs of numbers.
    """
    if isinstance(profile, str):
        profile = [pair.split() for pair in profile.split(",")]
    return tuple((float(distance), float(width)) for distance, width in profile)


@dataclass(frozen=True)
class Profile(Section):
    """A width that is straight between points above the axis, and the same below it.

    profile: pairs (distance from the axis over half the depth, width over the largest one) from 0
    to 1; two of the same distance are a step.
    """

    profile: Any

    def __post_init__(self) -> None:
        object.__setattr__(self, "profile", profile_points(self.profile))

    @property
    def _unit(self) -> tuple[Floats, Floats]:
        """Points and areas of half a section of width 1 and depth 2."""
        z, width = np.array(self.profile).T
        return _pieces(z, np.stack([width[:-1], width[1:]], axis=1), _OF_ENERGY)

    @property
    def area(self) -> Any:
        return self.width * self.depth * self._unit[1].sum()

    @property
    def second_moment(self) -> Any:
        z, area = self._unit
        cube = self.depth * self.depth * self.depth
        return 0.25 * (area * z * z).sum() * (self.width * cube)

    @property
    def plastic_modulus(self) -> Any:
        z, area = self._unit
        return 0.5 * (area * z).sum() * (self.width * (self.depth * self.depth))

    def shear_coefficient(self, poissons_ratio: Any) -> Any:
        """Take the shear stress V S/(I b), by energy."""
        z, area = self._unit
        ends, width = np.array(self.profile).T
        beyond = (area * z).sum() - _first_moments(z, ends, width)[1]
        energy = (area * (beyond / np.interp(z, ends, width)) ** 2).sum()
        return (area * z * z).sum() ** 2 / (area.sum() * energy)

    def width_at(self, z: Floats) -> Floats:
        ends, width = np.array(self.profile).T
        return np.asarray(self.width * np.interp(np.abs(z) / (0.5 * self.depth), ends, width))

    def _quadrature(self, n: int) -> tuple[Floats, Floats]:
        z, width = np.array(self.profile).T
        pairs = self.width * np.stack([width[:-1], width[1:]], axis=1)
        return _pieces(0.5 * self.depth * z, pairs, n)

    def _up_to(self, z: Floats) -> tuple[Floats, Floats]:
        ends, width = np.array(self.profile).T
        return _first_moments(z, 0.5 * self.depth * ends, self.width * width)


def _first_moments(z: Floats, ends: Floats, width: Floats) -> tuple[Floats, Floats]:
    """Return area and first moment from the axis to z, the width straight between `ends`."""
    area, moment = np.zeros_like(z), np.zeros_like(z)
    for (low, lower), (high, upper) in pairwise(zip(ends, width, strict=True)):
        if high > low:
            s, slope = np.clip(z, low, high) - low, (upper - lower) / (high - low)
            part = s * (lower + 0.5 * slope * s)
            area += part
            moment += low * part + s * s * (0.5 * lower + slope * s / 3.0)
    return area, moment


def _segment(z: Floats, radius: float) -> tuple[Floats, Floats]:
    """Return area and first moment of a circle between its axis and z."""
    z = np.minimum(z, radius)
    root = np.sqrt(radius**2 - z**2)
    angle = np.arcsin(z / radius) if radius else np.zeros_like(z)
    return z * root + radius**2 * angle, 2.0 / 3.0 * (radius**3 - root**3)


def _pieces(ends: Any, widths: Any, n: int) -> tuple[Floats, Floats]:
    """Return points and areas of pieces between `ends` (m), in which the width (m) is straight.

    widths: at the lower and the upper end of each piece, (pieces, 2). See Section._quadrature.
    """
    x, weights = _leggauss(n + 1)
    share = 0.5 * (1.0 + x)
    low, length = np.asarray(ends[:-1]), np.diff(ends)
    z = low[:, np.newaxis] + np.multiply.outer(length, share)
    lower, upper = np.asarray(widths, np.float64).T
    width = lower[:, np.newaxis] + np.multiply.outer(upper - lower, share)
    return z.ravel(), (np.multiply.outer(0.5 * length, weights) * width).ravel()
