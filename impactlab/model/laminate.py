"""Sections of layers of several metals: laminates, and graded metals in steps.

The lay-up is symmetric about the axis: another one would couple bending with stretching, which the
beams here do not have. Bonds are perfect, so the strain is -z kappa across all layers.

To kernels a layer is a part of the outer layer's metal. With the moduli's ratio e = E_j/E as a
factor of its width the elastic section is that of one metal (the transformed section). A fibre of
yield strain r times the outer layer's, r = S_j/(E_j) E/S, then is one at the distance z/r with the
area r^2 e A: moment, energies and work are the same, and its strains are 1/r of the real ones
(model/section.py). So no kernel knows of layers, and the first fibre to yield still comes first.

Source: the transformed section of composite beams (Gere and Goodno, Mechanics of Materials, 6.3).
"""

# ruff: noqa: D102 - a shape's methods are documented once, in Section

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from impactlab.model.cross_section import Section
from impactlab.model.discretisation import gauss
from impactlab.types import Floats

LEAST_FIBRES = 2
"""Fibres of a layer above the axis, with which its stiffness and full plastic moment are exact."""
_leggauss = np.polynomial.legendre.leggauss


def layer_rows(layers: Any) -> tuple[tuple[float, ...], ...]:
    """Return the rows of layers, which may be text or rows; see Laminate.

    Raises TypeError or ValueError where they are no numbers, or not four each.
    """
    if isinstance(layers, str):
        layers = [row.split() for row in layers.split(",")]
    rows = tuple(tuple(float(value) for value in row) for row in layers)
    if any(len(row) != 4 for row in rows):
        raise ValueError("four numbers each")
    return rows


@dataclass(frozen=True)
class Laminate(Section):
    """A rectangle of layers, symmetric about its axis.

    layers: rows of share of half the depth, Young's modulus (Pa), yield stress (Pa) and density
    (kg/m3), from the axis outwards. skin: the last three of the outer layer, which has the rest.
    """

    layers: Any
    skin: tuple[Any, Any, Any]

    def __post_init__(self) -> None:
        object.__setattr__(self, "layers", layer_rows(self.layers))

    def _stack(self) -> Iterator[tuple[Any, Any, Any, Any, Any]]:
        """Yield lower and upper end (m), and the ratios of modulus, strength and density."""
        metal = self.skin
        half, share, low = 0.5 * self.depth, 0.0, 0.0 * self.depth
        for thickness, modulus, strength, density in self.layers:
            share += thickness
            yield low, half * share, modulus / metal[0], strength / metal[1], density / metal[2]
            low = half * share
        yield low, half, 1.0, 1.0, 1.0

    def _sum(self, ratio: int, power: int) -> Any:
        """Return twice the integral of z^(power - 1) over the upper half, with a ratio's weight."""
        total: Any = 0.0
        for low, high, *ratios in self._stack():
            above, below = high, low
            for _ in range(power - 1):
                above, below = above * high, below * low
            total = total + ratios[ratio] * (above - below)
        return 2.0 / power * self.width * total

    @property
    def skin_thickness(self) -> Any:
        *_, (low, high, *_) = self._stack()
        return high - low

    @property
    def area(self) -> Any:
        return self._sum(0, 1)

    @property
    def second_moment(self) -> Any:
        return self._sum(0, 3)

    @property
    def plastic_modulus(self) -> Any:
        return self._sum(1, 2)

    def mass_per_length(self, density: Any) -> Any:
        return density * self._sum(2, 1)

    def rotary_inertia(self, density: Any) -> Any:
        return density * self._sum(2, 3)

    def shear_coefficient(self, poissons_ratio: Any) -> Any:
        """Take the shear stress V S/(I b) by energy, shear moduli in the ratio of Young's."""
        beyond, energy = 0.5 * self._sum(0, 2), 0.0
        for low, high, ratio, *_ in self._stack():
            width = ratio * self.width
            first = beyond + 0.5 * width * (low * low)  # of S = first - width z^2/2
            cubes = high * high * high - low * low * low
            fifths = high * high * high * (high * high) - low * low * low * (low * low)
            energy += first * first / width * (high - low) - first * cubes / 3.0
            energy += width * fifths / 20.0
            beyond = beyond - 0.5 * width * (high * high - low * low)
        second = self.second_moment
        return second * second / (self.area * (2.0 * energy))

    def width_at(self, z: Floats) -> Floats:
        """Return the width times the ratio of Young's moduli."""
        return np.asarray(self.width * self._ratio_at(z, 0))

    def strain_ratio(self, z: Floats) -> Floats:
        return self._ratio_at(z, 1) / self._ratio_at(z, 0)

    def _ratio_at(self, z: Floats, ratio: int) -> Floats:
        _, highs, *ratios = zip(*self._stack(), strict=True)
        layer = np.searchsorted(np.array(highs)[:-1], np.abs(z))
        return np.asarray(np.array(ratios[ratio])[layer])

    def cut(self, rule: str, points: int) -> tuple[Floats, Floats]:
        """Return the fibres of a rule in every layer; Lobatto's edge is that of the last."""
        z, area = _fibres(self, rule, points // 2)
        axis = np.zeros(points % 2)
        return np.concatenate([-z[::-1], axis, z]), np.concatenate([area[::-1], axis, area])


@lru_cache(maxsize=4096)
def _fibres(section: Laminate, rule: str, n: int) -> tuple[Floats, Floats]:
    """Return z (m), ascending, and area (m2, of the outer layer's metal) of n fibres."""
    stack = list(section._stack())
    thickness = np.array([high - low for low, high, *_ in stack])
    counts = np.full(len(stack), LEAST_FIBRES)
    for _ in range(n - counts.sum()):
        counts[np.argmax(thickness / counts)] += 1
    places, areas = [], []
    for (low, high, ratio, *_), count in zip(stack, counts.tolist(), strict=True):
        width = ratio * section.width
        if rule == "layers":
            ends = np.linspace(low, high, count + 1)
            z, area = 0.5 * (ends[:-1] + ends[1:]), width * np.diff(ends)
        else:
            x, weights = _leggauss(count + 1)
            z, area = 0.5 * (low + high + (high - low) * x), 0.5 * (high - low) * weights * width
            edge = rule == "lobatto" and low == stack[-1][0]
            z, area = gauss(z - low, area, count, high - low if edge else None)
            z = z + low
            if edge:
                z[-1] = high  # without rounding
        places.append(z)
        areas.append(area)
    return np.concatenate(places), np.concatenate(areas)
