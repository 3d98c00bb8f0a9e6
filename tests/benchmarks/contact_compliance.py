"""Make the tables of model/contact_compliance.py by 3-D elastic statics (scikit-fem).

    pip install scikit-fem
    python tests/benchmarks/contact_compliance.py            # prints the tables, some 20 minutes

Beam: a quarter of a beam under a unit point force on its upper face, its ends held by the
parabolic shear of beam theory. Boussinesq's half-space is taken out before the solve: the finite
elements see what its tractions on the beam's other faces leave, which is smooth, and give the
surface under the force less the half-space's displacement. From that the deflection of
Timoshenko's beam is subtracted, L^3/(48 EI) + L/(4 k G A) with k = 5/6, measured from the ends,
each weighted with its shear; from that of the axis, half a depth below, as well. The rest is
straight in L: c + gamma M/(EI) with M = L/4. Two spans give both, in c E H and gamma/H^2. So are
the stresses under the force less the half-space's, along and across the beam, a tenth of the depth
below the surface: of M, beam theory's (0 and -6 M/(B H^2) (1 - 0.2), within 0.1 %), and of F, the
table `STRESS`, in F/H^2.

Sphere: Hertz's pressure on its pole, balanced by an even deceleration: the patch's displacement,
weighted with the pressure, from the centre of mass, less the half-space's; c E R.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from skfem import (
    Basis,
    BilinearForm,
    ElementHex2,
    ElementQuad2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshHex,
    MeshQuad,
    condense,
    solve,
)
from skfem.models.elasticity import lame_parameters, linear_elasticity

DEPTHS = (0.2, 0.3, 0.45, 0.7, 1.0, 1.5, 2.5, 4.0)
"""H/B."""
RATIOS = (0.0, 0.25, 0.45)
"""Poisson's ratio."""
STEP = 1e-4
Array = np.ndarray[Any, Any]


def graded(first: float, end: float, growth: float, most: float) -> Array:
    """Return positions from 0 to `end`, the intervals growing from `first` to `most`."""
    places, step = [0.0], first
    while places[-1] < end:
        places.append(places[-1] + step)
        step = min(step * growth, most)
    return np.array(places) * end / places[-1]


def boussinesq(at: Array, nu: float) -> Array:
    """Return the displacement of a half-space z > 0, E = 1, under a unit force along z."""
    x, y, z = at
    rho = np.sqrt(x * x + y * y + z * z)
    radial = z / rho**3 - (1 - 2 * nu) / (rho * (rho + z))
    along = z * z / rho**3 + 2 * (1 - nu) / rho
    return (1 + nu) / (2 * np.pi) * np.array([x * radial, y * radial, along])


def stress(at: Array, nu: float, field: Callable[[Array], Array] | None = None) -> Array:
    """Return the stresses (3, 3, ...) of a field or of the half-space, E = 1, by differences."""
    field = field or partial(boussinesq, nu=nu)
    lam, mu = lame_parameters(1.0, nu)
    grad = np.empty((3, *at.shape))
    for j in range(3):
        shift = np.zeros((3, *(1,) * (at.ndim - 1)))
        shift[j] = STEP
        difference = field(at + shift) - field(at - shift)
        grad[:, j] = difference.reshape(at.shape) / (2 * STEP)
    strain = 0.5 * (grad + grad.swapaxes(0, 1))
    found: Array = 2 * mu * strain
    for i in range(3):
        found[i, i] += lam * np.trace(strain)
    return found


def beam(B: float, L: float, nu: float, n: int = 4) -> Array:
    """Return surface less half-space less Timoshenko, axis less Timoshenko, stresses x and y.

    At mid-width; H = E = F = 1; n elements over H, an even number.
    """
    most = 1.5 / n * max(1.0, 0.5 * B)
    width = np.linspace(0, B / 2, max(int(np.ceil(n * B / 2)), 3) + 1)
    if len(width) > 9:
        width = graded(1.0 / n, B / 2, 1.2, most)
    mesh = MeshHex.init_tensor(graded(1.0 / n, L / 2, 1.3, most), width, np.linspace(0, 1, n + 1))
    element = ElementVector(ElementHex2())
    basis = Basis(mesh, element, intorder=4)
    K = linear_elasticity(*lame_parameters(1.0, nu)).assemble(basis)
    faces = {
        "bottom": lambda at: np.isclose(at[2], 1),
        "side": lambda at: np.isclose(at[1], B / 2),
        "end": lambda at: np.isclose(at[0], L / 2),
    }
    taken = LinearForm(lambda v, w: -np.einsum("ij...,j...,i...", stress(w.x, nu), w.n, v))
    parabola = LinearForm(lambda v, w: 12 / B * w.x[2] * (1 - w.x[2]) * v[2])
    f = np.zeros(basis.N)
    for inside in faces.values():
        facets = mesh.facets_satisfying(inside, boundaries_only=True)
        face = FacetBasis(mesh, element, facets=facets, intorder=8)
        f += taken.assemble(face)
    weights = parabola.assemble(face)  # of the end, the last face; their sum is 1
    f -= 0.25 * weights
    at = face.default_parameters()["x"]
    ends = np.sum(boussinesq(at, nu)[2] * 12 / B * at[2] * (1 - at[2]) * face.dx)
    pin = [d for d in basis.nodal_dofs[2] if np.allclose(basis.doflocs[:, d], 0)]
    held = [
        basis.get_dofs(lambda at: np.isclose(at[0], 0)).all("u^1"),
        basis.get_dofs(lambda at: np.isclose(at[1], 0)).all("u^2"),
        pin,
    ]
    u = solve(*condense(K, f, D=np.unique(np.concatenate(held))))
    timoshenko = L**3 / (4 * B) + L * (1 + nu) / (2 * 5 / 6 * B)
    axis = [d for d in basis.nodal_dofs[2] if np.allclose(basis.doflocs[:, d], (0, 0, 0.5))]
    below = boussinesq(np.array([0.0, 0.0, 0.5]), nu)[2]
    sag = np.array([u[pin[0]], u[axis[0]] + below]) - weights @ u - ends - timoshenko
    left = stress(np.array([[STEP], [STEP], [0.1]]), nu, lambda at: basis.probes(at) @ u)
    return np.r_[sag, left[0, 0], left[1, 1]]


def sphere(nu: float, a: float = 0.06, n: int = 12) -> float:
    """Return the patch's displacement less the half-space's for R = E = F = 1, radius a."""
    rim = np.arcsin(a)
    outer = rim + graded(rim / n, np.pi - rim, 1.12, np.pi / 30)
    angle = np.concatenate([np.linspace(0, rim, n + 1)[:-1], outer])
    mesh = MeshQuad.init_tensor(angle, graded(a / n, 0.995, 1.12, 0.06))
    theta, depth = mesh.p
    mesh = MeshQuad(np.array([np.sin(theta), np.cos(theta)]) * (1 - depth), mesh.t)
    element = ElementVector(ElementQuad2())
    basis = Basis(mesh, element, intorder=6)
    lam, mu = lame_parameters(1.0, nu)

    def strains(u: Any, r: Array) -> tuple[Array, ...]:
        shear = 0.5 * (u.grad[0][1] + u.grad[1][0])
        return u.grad[0][0], u.grad[1][1], u.value[0] / r, shear

    @BilinearForm
    def stiffness(u: Any, v: Any, w: Any) -> Array:
        (*e, s), (*f, t) = strains(u, w.x[0]), strains(v, w.x[0])
        normal = sum((lam * sum(e) + 2 * mu * e[i]) * f[i] for i in range(3))
        return 2 * np.pi * w.x[0] * (normal + 4 * mu * s * t)

    @LinearForm
    def hertz(v: Any, w: Any) -> Array:
        pressure = 1.5 / (np.pi * a * a) * np.sqrt(np.maximum(1 - (w.x[0] / a) ** 2, 0))
        return -2 * np.pi * w.x[0] * pressure * np.einsum("i...,i...", v, w.n)

    def near_pole(at: Array) -> Array:
        return (np.hypot(*at) > 0.99) & (at[1] > 0) & (at[0] < a)

    facets = mesh.facets_satisfying(near_pole, boundaries_only=True)
    push = hertz.assemble(FacetBasis(mesh, element, facets=facets, intorder=12))
    mass = LinearForm(lambda v, w: 2 * np.pi * w.x[0] * v[1]).assemble(basis)
    upright = np.concatenate([basis.nodal_dofs[1], basis.facet_dofs[1], basis.interior_dofs[1]])
    F = -push[upright].sum()
    axis = basis.get_dofs(lambda at: np.isclose(at[0], 0, atol=1e-9)).all("u^1")
    pin = basis.nodal_dofs[1][:1]
    f = push + F * mass / mass.sum()
    u = solve(*condense(stiffness.assemble(basis), f, D=np.unique(np.concatenate([axis, pin]))))
    return float((push @ u) / F + (mass @ u) / mass.sum() - 0.6 * (1 - nu**2) / a)


def main() -> None:
    """Print the tables as Python tuples: c E H and gamma/H^2 by H/B and nu, c E R by nu."""
    rows: dict[str, list[list[float]]] = {}
    for depth in DEPTHS:
        B, found = 1.0 / depth, []
        spans = [3.0 * max(B, 1.0), 5.0 * max(B, 1.0)]
        for nu in RATIOS:
            near, far = (beam(B, L, nu) for L in spans)
            slope = (far - near) / (spans[1] - spans[0])
            found.append((near - slope * spans[0], slope * B / 3.0))  # M/(EI) = 3 L/B
        print(depth, [np.round(each, 4).tolist() for each in found], flush=True)
        for at, name in enumerate(("FORCE", "AXIS_FORCE", "STRESS_ALONG", "STRESS_ACROSS")):
            rows.setdefault(name, []).append([round(c[at], 4) for c, _ in found])
        for at, name in enumerate(("MOMENT", "AXIS_MOMENT")):
            rows.setdefault(name, []).append([round(g[at], 4) for _, g in found])
    print(rows)
    print("SPHERE", [round(sphere(nu), 4) for nu in RATIOS])


if __name__ == "__main__":
    main()
