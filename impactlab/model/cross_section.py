"""Sections of the beam that are symmetric about their axis, and the few fibres that stand for them.

A width that jumps, or that has a vertical tangent, is integrated badly by a rule over the depth.
Here the rule takes the width into its weights: the n = points // 2 fibres above the axis are the
nodes of Gauss's rule of z with respect to the area, or of Radau's, whose last node is the edge
(discretisation.py). They have the moments of the section exactly up to z^(2n-1), or z^(2n-2): from
n = 2 on its area, its full plastic moment and its bending stiffness, on any shape. Layers have
their exact area and first moment each. An odd point lies on the axis, without area.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from impactlab.model.discretisation import gauss
from impactlab.types import Floats


@dataclass(frozen=True)
class Section(ABC):
    """A section that is symmetric about its axis, or one per beam in columns.

    Parameters
    ----------
    width, depth : float
        Largest extent across and along the velocity, in m.

    Examples
    --------
    >>> il.paper_impact().beam.section
    Rectangle(width=0.06, depth=0.0278)
    """

    width: Any
    depth: Any

    @property
    @abstractmethod
    def area(self) -> Any:
        """Area of the section.

        Returns
        -------
        float
            A, in m2.
        """

    @property
    @abstractmethod
    def second_moment(self) -> Any:
        """Second moment of area about the axis.

        Returns
        -------
        float
            I, in m4.
        """

    @property
    @abstractmethod
    def plastic_modulus(self) -> Any:
        """Bending moment over the yield stress where every fibre yields.

        Returns
        -------
        float
            Plastic section modulus, in m3.
        """

    @abstractmethod
    def shear_coefficient(self, poissons_ratio: Any) -> Any:
        """Return the shear coefficient of Timoshenko's beam.

        Parameters
        ----------
        poissons_ratio : float
            Poisson's ratio of the metal.

        Returns
        -------
        float
            k, of 1.
        """

    @property
    def stress_per_moment(self) -> Any:
        """Stress in the outermost fibre of an elastic section over the bending moment.

        Returns
        -------
        float
            Reciprocal of the section modulus, in 1/m3.
        """
        return 0.5 * self.depth / self.second_moment

    @property
    def skin_thickness(self) -> Any:
        """Thickness of the outer one of several layers.

        Returns
        -------
        float
            Thickness, in m; 0 where there are none.
        """
        return 0.0

    def strain_ratio(self, z: Floats) -> Floats:
        """Return the yield strain of the metal over that of the outermost one.

        Parameters
        ----------
        z : numpy.ndarray
            Distance from the axis, in m, at most half the depth.

        Returns
        -------
        numpy.ndarray
            Ratio, of 1.
        """
        return np.ones_like(z)

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
        return density * self.area

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
        return youngs_modulus * self.second_moment

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
        return density * self.second_moment

    def width_at(self, z: Floats) -> Floats:
        """Return the width of the metal.

        Parameters
        ----------
        z : numpy.ndarray
            Distance from the axis, in m, at most half the depth.

        Returns
        -------
        numpy.ndarray
            Width, in m.

        Raises
        ------
        NotImplementedError
            If the class is no shape.
        """
        raise NotImplementedError

    def fibres(self, positions: Floats, weights: Floats) -> tuple[Floats, Floats]:
        """Return the fibres into which an integration rule over the depth cuts the section.

        Parameters
        ----------
        positions, weights : numpy.ndarray
            Points of the rule on [-1, 1] and weights that sum to 2, shape (points,).

        Returns
        -------
        z, area : numpy.ndarray
            Distance from the axis in m and area in m2, shape (points,).
        """
        z = 0.5 * self.depth * positions
        return z, 0.5 * self.depth * weights * self.width_at(z)

    def cut(self, rule: str, points: int) -> tuple[Floats, Floats]:
        """Return the fibres of a rule that the kernels take.

        Parameters
        ----------
        rule : {"lobatto", "legendre", "layers"}
            Name of the rule: "lobatto" has fibres at the edges.
        points : int
            Number of fibres over the depth.

        Returns
        -------
        z, area : numpy.ndarray
            Distance from the axis in m, ascending, and area in m2, shape (points,).
        """
        z, area = _upper_fibres(self, rule, points // 2)
        axis = np.zeros(points % 2)
        return np.concatenate([-z[::-1], axis, z]), np.concatenate([area[::-1], axis, area])

    def _quadrature(self, n: int) -> tuple[Floats, Floats]:
        """Return points (m) and areas (m2) above the axis, exact for polynomials of z^(2n-1)."""
        raise NotImplementedError

    def _up_to(self, z: Floats) -> tuple[Floats, Floats]:
        """Return area (m2) and first moment (m3) between the axis and z (m)."""
        raise NotImplementedError


@lru_cache(maxsize=4096)
def _upper_fibres(section: Section, rule: str, n: int) -> tuple[Floats, Floats]:
    """Return z (m), ascending, and area (m2) of n fibres above the axis."""
    edge = 0.5 * section.depth
    if rule != "layers":
        z, area = gauss(*section._quadrature(n), n, edge if rule == "lobatto" else None)
        if rule == "lobatto":
            z[-1] = edge  # without rounding: a section yields first there
        return z, area
    ends = np.linspace(0.0, edge, n + 1)
    area, moment = (np.diff(values) for values in section._up_to(ends))
    return moment / area, area
