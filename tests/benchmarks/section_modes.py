"""Make the tables of a strip in model/contact_compliance.py from modes of the beam's section.

    python tests/benchmarks/section_modes.py                 # prints the tables, some seconds

An endless elastic beam of rectangular section whose displacements go with the wave number k along
it, u = U(y, z) cos(k x), v = V(y, z) sin(k x), w = W(y, z) sin(k x), with U, V and W polynomials
over the section (Ritz): the frequencies are those of the 3-D body, no theory of beams is in it.

Of its symmetric modes at k = 0, the lowest in which the axis moves against the section's mean is
the section's bending across the width. s is its amplitude, such that bending along the beam alone
drives it to -nu kappa; then its stiffness, its inertia and how far the struck face moves at
mid-width follow. The twist is the one with which s has the frequency of this mode at k B = pi,
half a wave over the width.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh
from scipy.optimize import brentq

from impactlab.model.contact_compliance import DEPTHS, FREE_STRIP, RATIOS

ACROSS, THROUGH = 7, 4
"""Even (or odd) polynomials over the width and over the depth."""
WAVE = np.pi
"""k B at which the twist is taken."""
SHEAR = 5.0 / 6.0
LEAST_RATIO = 1e-6
"""Poisson's ratio in place of 0, where bending along and across do not meet."""
Array = np.ndarray[Any, Any]


class Section:
    """Stiffness k0 + k k1 + k^2 k2 and mass m of a section of width 1, E = rho = 1.

    middle: the struck face's displacement at mid-width; axis, mean: of the axis there, and of the
    section at the depth of the axis, as rows over the unknowns.
    """

    def __init__(self, depth: float, nu: float) -> None:
        """Integrate over the section by Gauss and Legendre's rule."""
        (y, across), (z, through) = (legendre.leggauss(2 * n + 4) for n in (ACROSS, THROUGH))
        points = [grid.ravel() for grid in np.meshgrid(0.5 * y, 0.5 * depth * z, indexing="ij")]
        weights = np.outer(0.5 * across, 0.5 * depth * through).ravel()
        even, odd = (lambda n: 2 * np.arange(n)), (lambda n: 2 * np.arange(n) + 1)
        self.depth = depth
        self.orders = (even(ACROSS), odd(THROUGH)), (odd(ACROSS), odd(THROUGH))
        self.orders += ((even(ACROSS), even(THROUGH)),)
        fields = [self.shapes(orders, *points) for orders in self.orders]
        size = len(fields[0][0])
        u, v, w = (slice(i * size, (i + 1) * size) for i in range(3))
        self.vertical = w
        (U, U_y, U_z), (V, V_y, V_z), (W, W_y, W_z) = fields
        # strains xx yy zz xy xz yz: those without k, and those that go with it
        plain, waved = np.zeros((2, 6, 3 * size, weights.size))
        waved[0, u], plain[1, v], plain[2, w] = -U, V_y, W_z
        plain[3, u], waved[3, v], plain[4, u], waved[4, w] = U_y, V, U_z, W
        plain[5, v], plain[5, w] = V_z, W_y
        G = 0.5 / (1.0 + nu)
        law = np.diag([2.0 * G] * 3 + [G] * 3)
        law[:3, :3] += 2.0 * G * nu / (1.0 - 2.0 * nu)

        def energy(first: Array, second: Array) -> Array:
            product: Array = np.einsum(
                "inp,ij,jmp,p->nm", first, law, second, weights, optimize=True
            )
            return product

        mixed = energy(plain, waved)
        self.k0, self.k1, self.k2 = energy(plain, plain), mixed + mixed.T, energy(waved, waved)
        self.mass = np.zeros((3 * size, 3 * size))
        for part, shape in ((u, U), (v, V), (w, W)):
            self.mass[part, part] = (shape * weights) @ shape.T
        self.middle = self.deflection(np.zeros(1), -0.5 * depth)
        self.axis = self.deflection(np.zeros(1), 0.0)
        self.mean = 0.5 * across @ self.deflection(0.5 * y, 0.0)

    def shapes(self, orders: tuple[Array, Array], y: Array, z: Array) -> tuple[Array, Array, Array]:
        """Return polynomials and their derivatives by y and z, (unknowns, points) each."""
        values = []
        for degrees, places in zip(orders, (2.0 * y, 2.0 * z / self.depth), strict=True):
            series = [np.eye(degree + 1)[degree] for degree in degrees]
            curves = np.array([legendre.legval(places, s) for s in series])
            slopes = np.array([legendre.legval(places, legendre.legder(s)) for s in series])
            values.append((curves, slopes))
        (f, f_y), (g, g_z) = values

        def product(a: Array, b: Array) -> Array:
            return (a[:, None] * b[None]).reshape(-1, y.size)

        return product(f, g), 2.0 * product(f_y, g), 2.0 / self.depth * product(f, g_z)

    def deflection(self, y: Array, z: float) -> Array:
        """Return w at points of one depth over the unknowns, (points, unknowns)."""
        rows = np.zeros((y.size, len(self.mass)))
        rows[:, self.vertical] = self.shapes(self.orders[2], y, np.full(y.size, z))[0].T
        return rows

    def modes(self, k: float) -> tuple[Array, Array]:
        """Return squared frequencies and modes of unit mass, in columns."""
        squares, vectors = eigh(self.k0 + k * self.k1 + k * k * self.k2, self.mass)
        return squares, vectors


def strip(depth: float, nu: float) -> tuple[float, float, float, float]:
    """Return stiffness, inertia, lever and twist of s, over those of the thin plate's parabola.

    Over D B, FREE_STRIP rho H B^5/720, B^2/24 and (1 - nu) D B^3/6.
    """
    nu = max(nu, LEAST_RATIO)
    section = Section(depth, nu)
    squares, vectors = section.modes(1e-6)
    moves = np.abs((section.axis - section.mean) @ vectors)[0]
    chosen = 1 + int(np.argmax(moves[1:5] > 0.1 * moves[1:5].max()))
    square, shape = squares[chosen], vectors[:, chosen]
    bent = np.zeros(len(shape))
    bent[0] = 0.5 * depth  # u = z
    shape = shape * float(bent @ section.k1 @ shape) / (nu * square)
    inertia = float(shape @ section.mass @ shape)
    stiffness = inertia * square
    lever = abs(float(section.middle[0] @ shape))
    waved, shapes = section.modes(WAVE)
    branch = int(np.argmax(np.abs(shape @ section.mass @ shapes)))
    plate = depth**3 / (12.0 * (1.0 - nu**2))
    unit = (1.0 - nu) * plate / 6.0

    def gap(ratio: float) -> float:
        return _second_branch(depth, nu, stiffness, inertia, ratio * unit) - float(waved[branch])

    usual = FREE_STRIP * depth / 720.0
    return stiffness / plate, inertia / usual, 24.0 * lever, float(brentq(gap, 1e-3, 3.0))


def _second_branch(depth: float, nu: float, across: float, inertia: float, twist: float) -> float:
    """Return the second squared frequency of solver/strip.py's beam at k = WAVE."""
    EI, k = depth**3 / 12.0, WAVE
    shear, turned = SHEAR * 0.5 / (1.0 + nu) * depth, nu * across * k
    stiffness = np.array(
        [
            [shear * k * k, -shear * k, 0.0],
            [-shear * k, shear + EI * k * k + nu * turned * k, -turned],
            [0.0, -turned, across + twist * k * k],
        ]
    )
    squares = eigh(stiffness, np.diag([depth, EI, inertia]), eigvals_only=True)
    return float(squares[1])


def main() -> None:
    """Print the tables over H/B and Poisson's ratio."""
    depths = [depth for depth in DEPTHS if depth <= 1.0]
    table = np.array([[strip(depth, nu) for nu in RATIOS] for depth in depths])
    names = "STIFFNESS", "INERTIA", "LEVER", "TWIST"
    for name, values in zip(names, table.transpose(2, 0, 1), strict=True):
        print(f"STRIP_{name} =", np.round(values, 4).tolist())


if __name__ == "__main__":
    main()
