"""Indent an elastic-plastic half-space by a sphere: the data of `finite_element`.

    python tests/benchmarks/sphere_indentation.py OUT.csv --depth 30 --elements 60

An axisymmetric quasi-static finite-element solve, load and unload, frictionless. Four-node
quadrilaterals with the mean dilatation (Hughes 1980, B-bar), J2 plasticity with linear hardening,
isotropic and kinematic, by radial return with the consistent tangent (Simo and Taylor 1985), and,
unless --small, an updated Lagrangian formulation with the rotation of Hughes and Winget (1980):
strains of a step on the geometry at its middle, equilibrium on that at its end. The sphere touches
the nodes of the surface from above, by an active set. It is a half-space with the profile of a
sphere: an elastic one with the compliance of the same mesh, in the share that --share leaves it (1
for a rigid sphere); with --sphere-yield one that yields, on a second mesh like the first, or, with
--round, on one that is a sphere's cap up to half the radius from the axis. Steps
are even in the radius of contact, and have to be short, since plastic flow depends on its path:
from 2 to 200 delta_y, on 15 elements, 40 steps in equal ratios give 1 to 4 % less force than 400
even ones, 200 even ones 0.1 % less.

Lengths are in radii of the sphere, stresses in yield stresses of the flat. x = delta/delta_y and
F/F_y are those of the contact laws, for first yield at a mean pressure of 1.1 yield stresses
(stronge). With --stress the half-space is stretched evenly beforehand, in all directions along its
surface: the data of `contact_prestress`. With --axis a second file is written, the data of
solver/contact/axis_lift.py: the displacement of the axis above that of the elastic half-space under
the same contact pressure, over delta_y, at the depth where a/z is what the column says. Output: one
row per equilibrium: E*/S_y, the flat's share of 1/E*, its Poisson's ratio and hardening moduli over
Young's, the sphere's yield stress, small strains or not, that stress, elements over the largest
radius, largest x so far, x, F/F_y, contact radius over that of the sphere.
"""

from __future__ import annotations

import argparse
import csv
import math
import time
from pathlib import Path
from typing import Any

import numba
import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

NU = 0.3
"""Of the sphere, and by default of the flat."""
Array = np.ndarray[Any, Any]
COLUMNS = (
    *("E_over_S", "share", "nu", "isotropic", "kinematic", "sphere_yield", "strains", "stress"),
    *("elements", "x_max", "x", "F", "a_over_R"),
)
AXIS = (0.1, 0.2, 0.3, 0.4)
"""Contact radius over the depths below the surface at which the axis is looked at."""
_G = 1.0 / math.sqrt(3.0)


def spacing(first: float, uniform: float, a: float) -> Array:
    """Return positions from 0 to about 400 a: even up to `uniform`, then growing."""
    places = list(np.arange(0.0, uniform + 0.5 * first, first))
    step = first
    while places[-1] < 400.0 * a:
        step *= 1.1 if places[-1] < 3.0 * a else 1.4
        places.append(places[-1] + step)
    return np.array(places)


@numba.njit(cache=True)  # type: ignore[untyped-decorator]
def _gradients(x: Array, p: int, N: Array, dN: Array) -> float:
    """Fill shape functions (4,) and their gradients (4, 2); return the weight, r included."""
    s = (-1.0, 1.0, 1.0, -1.0)
    t = (-1.0, -1.0, 1.0, 1.0)
    a, b = s[p] * _G, t[p] * _G
    J = np.zeros((2, 2))
    d = np.empty((4, 2))
    r = 0.0
    for i in range(4):
        N[i] = 0.25 * (1 + s[i] * a) * (1 + t[i] * b)
        d[i, 0], d[i, 1] = 0.25 * s[i] * (1 + t[i] * b), 0.25 * t[i] * (1 + s[i] * a)
        r += N[i] * x[i, 0]
        for j in range(2):
            for k in range(2):
                J[j, k] += d[i, j] * x[i, k]
    det = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
    for i in range(4):
        dN[i, 0] = (J[1, 1] * d[i, 0] - J[0, 1] * d[i, 1]) / det
        dN[i, 1] = (J[0, 0] * d[i, 1] - J[1, 0] * d[i, 0]) / det
    for i in range(4):
        N[i] /= r
    return 2.0 * math.pi * r * det


@numba.njit(cache=True)  # type: ignore[untyped-decorator]
def _strain_matrices(x: Array) -> tuple[Array, Array, Array]:
    """Return B-bar (4 points, 4, 8), gradients (4, 4, 2) and weights (4,); order rr zz tt rz."""
    N, dN, B = np.zeros(4), np.zeros((4, 4, 2)), np.zeros((4, 4, 8))
    weight, mean = np.zeros(4), np.zeros(8)
    for p in range(4):
        weight[p] = _gradients(x, p, N, dN[p])
        for i in range(4):
            B[p, 0, 2 * i] = dN[p, i, 0]
            B[p, 1, 2 * i + 1] = dN[p, i, 1]
            B[p, 2, 2 * i] = N[i]
            B[p, 3, 2 * i], B[p, 3, 2 * i + 1] = dN[p, i, 1], dN[p, i, 0]
            mean[2 * i] += weight[p] * (dN[p, i, 0] + N[i])
            mean[2 * i + 1] += weight[p] * dN[p, i, 1]
    mean /= weight.sum()
    for p in range(4):
        for j in range(8):
            shift = (mean[j] - B[p, 0, j] - B[p, 1, j] - B[p, 2, j]) / 3.0
            for k in range(3):
                B[p, k, j] += shift
    return B, dN, weight


@numba.njit(cache=True)  # type: ignore[untyped-decorator]
def _turned(s: Array, c: float, d: float) -> None:
    """Turn a symmetric tensor rr zz tt rz by the angle of cosine c and sine d."""
    rr, zz, rz = s[0], s[1], s[3]
    s[0] = c * c * rr + 2 * c * d * rz + d * d * zz
    s[1] = d * d * rr - 2 * c * d * rz + c * c * zz
    s[3] = (c * c - d * d) * rz + c * d * (zz - rr)


@numba.njit(cache=True)  # type: ignore[untyped-decorator]
def assemble(  # noqa: C901 one loop over elements and points
    X: Array, elements: Array, u: Array, du: Array, state: Array, metal: Array, large: bool
) -> tuple[Array, Array, Array]:
    """Return internal forces (2 n,), element stiffnesses (e, 8, 8), new states (e, 4, 9).

    X: nodes (n, 2); u: displacement before the step, du: its increment (n, 2); state: before it, of
    each point stress (4), back stress (4) and equivalent plastic strain; metal: Young's modulus,
    Poisson's ratio, yield stress, isotropic and kinematic hardening moduli.
    """
    E, nu, S, H_iso, H_kin = metal
    G, bulk, H = 0.5 * E / (1 + nu), E / (3 * (1 - 2 * nu)), H_iso + H_kin
    forces = np.zeros(u.size)
    K = np.zeros((len(elements), 8, 8))
    new = np.zeros_like(state)
    now, half, step = np.zeros((4, 2)), np.zeros((4, 2)), np.zeros(8)
    one = np.array([1.0, 1.0, 1.0, 0.0])
    for e in range(len(elements)):
        for i in range(4):
            for k in range(2):
                n = elements[e, i]
                step[2 * i + k] = du[n, k]
                half[i, k] = X[n, k] + (u[n, k] + 0.5 * du[n, k] if large else 0.0)
                now[i, k] = X[n, k] + (u[n, k] + du[n, k] if large else 0.0)
        B, dN, _ = _strain_matrices(half)
        B_now, _, weight = _strain_matrices(now)
        for p in range(4):
            strain = B[p] @ step
            s, back = state[e, p, :4].copy(), state[e, p, 4:8].copy()
            if large:
                spin = 0.0
                for i in range(4):
                    spin += 0.5 * (dN[p, i, 1] * step[2 * i] - dN[p, i, 0] * step[2 * i + 1])
                turn = 2.0 * math.atan(0.5 * spin)
                c, d = math.cos(turn), math.sin(turn)
                _turned(s, c, d)
                _turned(back, c, d)
            volume = strain[0] + strain[1] + strain[2]
            mean = (s[0] + s[1] + s[2]) / 3.0
            pressure = mean + bulk * volume
            trial = s - one * mean - back
            for k in range(3):
                trial[k] += 2 * G * (strain[k] - volume / 3.0)
            trial[3] += G * strain[3]
            norm = math.sqrt(trial[0] ** 2 + trial[1] ** 2 + trial[2] ** 2 + 2 * trial[3] ** 2)
            radius = math.sqrt(2.0 / 3.0) * (S + H_iso * state[e, p, 8])
            share, bend, flow = 1.0, 0.0, 0.0
            if norm > radius:
                flow = (norm - radius) / (2 * G + 2.0 / 3.0 * H)
                share = 1.0 - 2 * G * flow / norm
                bend = 1.0 / (1.0 + H / (3 * G)) - (1.0 - share)
            C = np.zeros((4, 4))
            for k in range(3):
                C[k, k] = 2 * G * share
                for m in range(3):
                    C[k, m] += bulk - 2 * G * share / 3.0
            C[3, 3] = G * share
            if bend > 0.0:
                for k in range(4):
                    for m in range(4):
                        C[k, m] -= 2 * G * bend * trial[k] * trial[m] / norm**2
            moved = back + (2.0 / 3.0 * H_kin * flow / norm if flow > 0.0 else 0.0) * trial
            new[e, p, :4] = back + share * trial + pressure * one
            new[e, p, 4:8] = moved
            new[e, p, 8] = state[e, p, 8] + math.sqrt(2.0 / 3.0) * flow
            f = B_now[p].T @ new[e, p, :4] * weight[p]
            K[e] += B_now[p].T @ (C @ B_now[p]) * weight[p]
            for i in range(4):
                for k in range(2):
                    forces[2 * elements[e, i] + k] += f[2 * i + k]
    return forces, K, new


class Mesh:
    """Rings of four nodes about the contact: `number` over the radius a."""

    def __init__(self, a: float, number: int) -> None:
        h = a / number
        r, z = spacing(h, a, a), -spacing(h, 0.5 * a, a)
        R, Z = np.meshgrid(r, z, indexing="ij")
        self.X, m = np.column_stack([R.ravel(), Z.ravel()]), len(z)
        i, j = (q.ravel() for q in np.meshgrid(range(len(r) - 1), range(m - 1), indexing="ij"))
        corners = [(i * m + j + 1), ((i + 1) * m + j + 1), ((i + 1) * m + j), (i * m + j)]
        self.elements = np.column_stack(corners).astype(np.int64)
        self.surface = np.arange(number + 3) * m
        self.axis = np.arange(m - 1)  # the last one is held
        dofs = (2 * self.elements[:, :, None] + np.arange(2)).reshape(-1, 8)
        self.rows, self.columns = np.repeat(dofs, 8, axis=1).ravel(), np.tile(dofs, 8).ravel()
        held = np.zeros((len(r), m, 2), bool)
        held[0, :, 0] = held[-1, :, :] = held[:, -1, :] = True
        self.free = np.flatnonzero(~held.ravel())
        self.place = np.full(held.size, -1)
        self.place[self.free] = np.arange(self.free.size)

    def matrix(self, K: Array) -> sparse.csc_array:
        """Return the stiffness of the free displacements."""
        size = self.place.size
        whole = sparse.coo_array((K.ravel(), (self.rows, self.columns)), (size, size)).tocsr()
        return whole[self.free][:, self.free].tocsc()


class Body:
    """A half-space on the mesh, with a sphere's cap if it is round; metal: see `assemble`."""

    def __init__(self, mesh: Mesh, metal: Array, large: bool, is_round: bool = False) -> None:
        self.mesh, self.metal, self.large, self.X = mesh, metal, large, mesh.X.copy()
        if is_round:
            self.X[:, 1] -= 1.0 - np.sqrt(1.0 - np.minimum(mesh.X[:, 0], 0.5) ** 2)
        self.u, self.state = np.zeros_like(mesh.X), np.zeros((len(mesh.elements), 4, 9))
        self.rate = np.zeros_like(mesh.X)

    def assembled(self, du: Array) -> tuple[Array, Array, Array]:
        """Return internal forces, element stiffnesses and new states after the step `du`."""
        elements = self.mesh.elements
        return assemble(self.X, elements, self.u, du, self.state, self.metal, self.large)


class Solve:
    """Flat, sphere and contact.

    modulus: E*/S_y of the flat; x_max: the largest delta/delta_y to come; number: of elements over
    the largest radius; share: of the flat in the compliance 1/E*; hardening: of the flat, isotropic
    and kinematic moduli over Young's modulus; sphere_yield: stress over the flat's; is_round:
    whether the sphere's mesh, if it yields, has the shape of a sphere.
    """

    def __init__(
        self,
        modulus: float,
        x_max: float,
        number: int,
        *,
        share: float = 0.5,
        nu: float = NU,
        hardening: tuple[float, float] = (0.0, 0.0),
        sphere_yield: float = math.inf,
        large: bool = True,
        is_round: bool = False,
    ) -> None:
        self.delta_y, self.large = (0.825 * math.pi / modulus) ** 2, large
        self.F_y = 4.0 / 3.0 * modulus * self.delta_y**1.5
        a = min(1.0, 0.72 + 0.1 * math.log10(x_max)) * 1.2 * math.sqrt(2 * x_max * self.delta_y)
        self.mesh = Mesh(a, number)
        self.E = (1.0 - nu**2) * modulus / share
        metal = np.array([self.E, nu, 1.0, *(self.E * ratio for ratio in hardening)])
        self.bodies = [Body(self.mesh, metal, large)]
        nodes, place, free = self.mesh.surface, self.mesh.place, self.mesh.free
        push = np.zeros((free.size, nodes.size))
        push[place[2 * nodes + 1], range(nodes.size)] = 1.0
        K = self.bodies[0].assembled(np.zeros_like(self.mesh.X))[1]
        moved = splu(self.mesh.matrix(K)).solve(push)
        self.compliance = (1.0 - share) / share * push.T @ moved
        self.elastic = moved[place[2 * self.mesh.axis + 1]]
        if math.isfinite(sphere_yield):
            self.compliance *= 0.0
            E = (1.0 - NU**2) * modulus / (1.0 - share)
            sphere = np.array([E, NU, sphere_yield, 0.0, 0.0])
            self.bodies.append(Body(self.mesh, sphere, large, is_round))
        self.force, self.delta, self.radius, self.last = np.zeros(nodes.size), 0.0, 0.0, 0.0

    def move(self, delta: float, halvings: int = 0) -> tuple[float, float]:
        """Go to `delta`, in several steps where one finds none; return (force, contact radius)."""
        if not self._balance(delta):
            if halvings == 5:
                raise RuntimeError(f"no equilibrium at {delta / self.delta_y:.4g} delta_y")
            self.move(0.5 * (self.delta + delta), halvings + 1)
            self.move(delta, halvings + 1)
        return float(self.force.sum()), self.radius

    def lift(self) -> Array:
        """Return how much higher the axis lies than by the same forces on elastic metal."""
        mesh = self.mesh
        above = self.bodies[0].u[mesh.axis, 1] + self.elastic @ self.force
        return np.interp(self.radius / np.array(AXIS), -mesh.X[mesh.axis, 1], above)

    def _profile(self, r: Array) -> tuple[Array, Array]:
        """Return height and slope of the sphere; of a paraboloid, without its slope, if small."""
        if not self.large:
            return 0.5 * r**2, 0.0 * r
        down = np.sqrt(1.0 - np.minimum(r**2, 0.999))
        return 1.0 - down, r / down

    def _gap(
        self, us: list[Array], force: Array, delta: float, segments: Array | None
    ) -> tuple[Array, Array, list[sparse.csr_array], Array | None]:
        """Return radius and gap at the flat's nodes, and its derivatives by both displacements.

        The surface of a sphere that yields is its profile, moved as that of a half-space; segments:
        of it, one under each node of the flat, returned too. They are those of the step's start, or
        Newton's method would cycle between two.
        """
        nodes, place = self.mesh.surface, self.mesh.place
        X, lines = self.mesh.X[nodes, 0], np.arange(nodes.size)
        r = X + (us[0][nodes, 0] if self.large else 0.0)
        height, slope = self._profile(r)
        derivatives = []
        for u in us[1:]:
            v = u[nodes]
            R = X + (v[:, 0] if self.large else 0.0)
            if segments is None:
                segments = np.clip(np.searchsorted(R, r) - 1, 0, nodes.size - 2)
            j, k = segments, segments + 1
            s = (r - R[j]) / (R[k] - R[j])
            height, slope = self._profile(X[j] + s * (X[k] - X[j]))
            height = height - (v[j, 1] + s * (v[k, 1] - v[j, 1]))
            if self.large:
                slope = (slope * (X[k] - X[j]) - (v[k, 1] - v[j, 1])) / (R[k] - R[j])
            weights = (j, 1.0 - s), (k, s)
            terms = [(lines, place[2 * nodes[n] + 1], -weight) for n, weight in weights]
            terms += [(lines, place[2 * nodes[n]], -weight * slope) for n, weight in weights]
            derivatives.append(self._sparse(terms))
        of_flat = [(lines, place[2 * nodes], slope), (lines, place[2 * nodes + 1], 0.0 * r - 1.0)]
        gap = height - delta + self.compliance @ force - us[0][nodes, 1]
        return r, gap, [self._sparse(of_flat), *derivatives], segments

    def _sparse(self, terms: list[tuple[Array, Array, Array]]) -> sparse.csr_array:
        rows, columns, values = (np.concatenate(part) for part in zip(*terms, strict=True))
        free = columns >= 0  # the node on the axis does not move sideways
        shape = self.mesh.surface.size, self.mesh.free.size
        return sparse.coo_array((values[free], (rows[free], columns[free])), shape).tocsr()

    def _balance(self, delta: float) -> bool:
        """Find the equilibrium at `delta` and keep it; return False where Newton's method fails."""
        free, step = self.mesh.free, delta - self.delta
        force, segments = self.force.copy(), None
        # the answer does not need it
        steps = [body.rate * (step if step * self.last > 0.0 else 0.0) for body in self.bodies]
        penalty = self.E * self.mesh.X[self.mesh.surface[1], 0]
        for _ in range(30):
            parts = [body.assembled(du) for body, du in zip(self.bodies, steps, strict=True)]
            us = [body.u + du for body, du in zip(self.bodies, steps, strict=True)]
            if not np.abs(us[0]).max() < 1.0:
                return False
            r, gap, derivatives, segments = self._gap(us, force, delta, segments)
            on = force - penalty * gap > 0.0
            lines = np.flatnonzero(on)
            rows = [D[lines] for D in derivatives]
            residual = [
                part[0][free] - D.T @ force[on] for part, D in zip(parts, rows, strict=True)
            ]
            lost = self.compliance[np.ix_(lines, np.flatnonzero(~on))] @ -force[~on]
            size = max(float(force.sum()), 1e-3 * self.F_y)
            error = max(
                *(np.abs(forces).max() / size for forces in residual),
                np.abs(gap[on]).max(initial=0.0) / delta,
                np.abs(force[~on]).max(initial=0.0) / size,
            )
            if error < 1e-7:
                break
            blocks: list[list[Any]] = [
                [self.mesh.matrix(part[1]) if k == i else None for k in range(len(rows))] + [-D.T]
                for i, (part, D) in enumerate(zip(parts, rows, strict=True))
            ]
            corner = sparse.csc_array(self.compliance[np.ix_(lines, lines)])
            system = sparse.block_array([*blocks, [*rows, corner]], format="csc")
            try:
                right = np.concatenate([*(-forces for forces in residual), -gap[on] - lost])
                # symmetric in structure: 1.5 times as fast as with the default order
                factors = splu(system, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0)
                answer = factors.solve(right)
            except RuntimeError:  # singular
                return False
            for i, du in enumerate(steps):
                du.ravel()[free] += answer[i * free.size : (i + 1) * free.size]
            force = force.copy()
            force[on] += answer[len(rows) * free.size :]
            force[~on] = 0.0
        else:
            return False
        for body, du, part in zip(self.bodies, steps, parts, strict=True):
            body.rate, body.u, body.state = du / step, body.u + du, part[2]
        self.force, self.delta, self.last = force, delta, step
        self.radius = float(r[force > 0].max(initial=0.0))
        return True


def run(args: argparse.Namespace) -> None:
    """Load to the depth and unload from the depths asked for; append rows to the file."""
    hardening = args.isotropic, args.kinematic
    solve = Solve(
        args.modulus,
        args.depth,
        args.elements,
        share=args.share,
        nu=args.nu,
        hardening=hardening,
        sphere_yield=args.sphere_yield,
        large=not args.small,
        is_round=args.round,
    )
    solve.bodies[0].state[:, :, [0, 2]] = args.stress
    metals = args.modulus, args.share, args.nu, *hardening, args.sphere_yield
    kind = *metals, "small" if args.small else "large", args.stress
    begun, rows, lifts = time.process_time(), [], []

    def note(x: float, top: str) -> float:
        F, a = solve.move(x * solve.delta_y)
        rows.append((*kind, args.elements, top, f"{x:.6g}", f"{F / solve.F_y:.7g}", f"{a:.5g}"))
        lifts.append((f"{x:.6g}", *(f"{lift:.4g}" for lift in solve.lift() / solve.delta_y)))
        return F

    tops = {*(args.unload or []), args.depth}
    loading = np.linspace(0.09, 1.0, args.steps)[:-1] ** 2 * args.depth
    for number, x in enumerate(sorted({*loading.tolist(), *tops})):
        if x in tops or number % max(args.steps // 30, 1) == 0:
            note(x, f"{x:.6g}")
        else:
            solve.move(x * solve.delta_y)
        if x in tops and x in (args.unload or []):
            loaded = [(body.u, body.state) for body in solve.bodies], solve.force, solve.delta
            F_m, depth, step = solve.force.sum(), x, 0.0
            step = 0.1 * F_m / (2.0 * args.modulus * math.sqrt(x * solve.delta_y)) / solve.delta_y
            while note(depth := depth - min(step, 0.9 * depth), f"{x:.6g}") > args.last * F_m:
                left, fell = float(rows[-1][-2]), float(rows[-2][-2]) - float(rows[-1][-2])
                step *= min(0.15 * F_m / solve.F_y, 0.45 * left) / fell
            states, solve.force, solve.delta = loaded
            for body, (u, state) in zip(solve.bodies, states, strict=True):
                body.u, body.state = u, state
    new = not Path(args.output).exists()
    with Path(args.output).open("a", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        if new:
            table.writerow(COLUMNS)
        table.writerows(rows)
    if args.axis:
        with Path(args.axis).open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([("x", *AXIS), *lifts])
    print(*kind, args.depth, len(solve.mesh.X), f"{time.process_time() - begun:.0f} s", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("output")
    parser.add_argument("--modulus", type=float, default=115e9 / 345e6, help="E*/S_y")
    parser.add_argument("--share", type=float, default=0.5, help="of the flat in 1/E*")
    parser.add_argument("--nu", type=float, default=NU, help="Poisson's ratio of the flat")
    parser.add_argument(
        "--isotropic", type=float, default=0.0, help="hardening over Young's modulus"
    )
    parser.add_argument("--kinematic", type=float, default=0.0, help="the same")
    parser.add_argument("--sphere-yield", type=float, default=math.inf, help="over the flat's")
    parser.add_argument("--round", action="store_true", help="a sphere that yields is round")
    parser.add_argument("--depth", type=float, required=True, help="largest delta/delta_y")
    parser.add_argument("--unload", type=float, nargs="*", help="unload from these, too")
    parser.add_argument("--last", type=float, default=0.03, help="force of unloading, over largest")
    parser.add_argument("--elements", type=int, default=60, help="over the largest radius")
    parser.add_argument("--stress", type=float, default=0.0, help="along the surface, over S_y")
    parser.add_argument("--steps", type=int, default=200, help="of loading")
    parser.add_argument("--axis", help="write the displacement of the axis to this file, too")
    parser.add_argument("--small", action="store_true", help="small strains, a paraboloid")
    run(parser.parse_args())
