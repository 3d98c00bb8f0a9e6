"""Indent an elastic-perfectly plastic half-space by a sphere: the data of `finite_element`.

    python tests/benchmarks/sphere_indentation.py OUT.csv --depth 30 --elements 60

An axisymmetric quasi-static finite-element solve, load and unload, frictionless. Four-node
quadrilaterals with the mean dilatation (Hughes 1980, B-bar), J2 plasticity by radial return with
the consistent tangent (Simo and Taylor 1985), and, unless --small, an updated Lagrangian
formulation with the rotation of Hughes and Winget (1980): strains of a step on the geometry at its
middle, equilibrium on that at its end. The sphere, a rigid or an elastic half-space with the
profile of a sphere, touches the nodes of the surface from above, by an active set; its elastic
compliance is that of the same mesh. Steps are even in the radius of contact, and have to be short,
since plastic flow depends on its path: from 2 to 200 delta_y, on 15 elements, 40 steps in equal
ratios give 1 to 4 % less force than 400 even ones, 200 even ones 0.1 % less.

Lengths are in radii of the sphere, stresses in yield stresses, nu = 0.3. x = delta/delta_y and
F/F_y are those of the contact laws, for first yield at a mean pressure of 1.1 yield stresses
(stronge). With --stress the half-space is stretched evenly beforehand, in all directions along its
surface: the data of `contact_prestress`. With --axis a second file is written, the data of
solver/contact/axis_lift.py: the displacement of the axis above that of the elastic half-space under
the same contact pressure, over delta_y, at the depth where a/z is what the column says. Output: one
row per equilibrium: elastic sphere or rigid, small strains or not, E*/S_y, that stress, elements
over the largest radius, largest x so far, x, F/F_y, contact radius over that of the sphere.
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
Array = np.ndarray[Any, Any]
COLUMNS = ("sphere", "strains", "E_over_S", "stress", "elements", "x_max", "x", "F", "a_over_R")
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
def assemble(  # noqa: C901 one loop over elements and points
    X: Array, elements: Array, u: Array, du: Array, stress: Array, E: float, S: float, large: bool
) -> tuple[Array, Array, Array]:
    """Return internal forces (2 n,), element stiffnesses (e, 8, 8), new stresses (e, 4, 4).

    X: nodes (n, 2); u: displacement before the step, du: its increment (n, 2); stress: before it.
    """
    G, bulk = 0.5 * E / (1 + NU), E / (3 * (1 - 2 * NU))
    forces = np.zeros(u.size)
    K = np.zeros((len(elements), 8, 8))
    new = np.zeros_like(stress)
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
            s = stress[e, p].copy()
            if large:
                spin = 0.0
                for i in range(4):
                    spin += 0.5 * (dN[p, i, 1] * step[2 * i] - dN[p, i, 0] * step[2 * i + 1])
                turn = 2.0 * math.atan(0.5 * spin)
                c, d = math.cos(turn), math.sin(turn)
                rr, zz, rz = s[0], s[1], s[3]
                s[0] = c * c * rr + 2 * c * d * rz + d * d * zz
                s[1] = d * d * rr - 2 * c * d * rz + c * c * zz
                s[3] = (c * c - d * d) * rz + c * d * (zz - rr)
            volume = strain[0] + strain[1] + strain[2]
            pressure = (s[0] + s[1] + s[2]) / 3.0 + bulk * volume
            trial = s - one * ((s[0] + s[1] + s[2]) / 3.0)
            for k in range(3):
                trial[k] += 2 * G * (strain[k] - volume / 3.0)
            trial[3] += G * strain[3]
            norm = math.sqrt(trial[0] ** 2 + trial[1] ** 2 + trial[2] ** 2 + 2 * trial[3] ** 2)
            radius = math.sqrt(2.0 / 3.0) * S
            share, bend = 1.0, 0.0
            if norm > radius:
                share = radius / norm
                bend = share
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
            new[e, p] = share * trial + pressure * one
            f = B_now[p].T @ new[e, p] * weight[p]
            K[e] += B_now[p].T @ (C @ B_now[p]) * weight[p]
            for i in range(4):
                for k in range(2):
                    forces[2 * elements[e, i] + k] += f[2 * i + k]
    return forces, K, new


class Solve:
    """The half-space, the sphere and their state; x_max: the largest delta/delta_y to come."""

    def __init__(self, modulus: float, x_max: float, number: int, rigid: bool, small: bool):
        self.E = (1.0 if rigid else 2.0) * (1.0 - NU**2) * modulus
        self.delta_y, self.large = (0.825 * math.pi / modulus) ** 2, not small
        self.F_y = 4.0 / 3.0 * modulus * self.delta_y**1.5
        a = min(1.0, 0.72 + 0.1 * math.log10(x_max)) * 1.2 * math.sqrt(2 * x_max * self.delta_y)
        h = a / number
        r = spacing(h, a, a)
        z = -spacing(h, 0.5 * a, a)
        R, Z = np.meshgrid(r, z, indexing="ij")
        self.X, m = np.column_stack([R.ravel(), Z.ravel()]), len(z)
        i, j = (q.ravel() for q in np.meshgrid(range(len(r) - 1), range(m - 1), indexing="ij"))
        corners = [(i * m + j + 1), ((i + 1) * m + j + 1), ((i + 1) * m + j), (i * m + j)]
        self.elements = np.column_stack(corners).astype(np.int64)
        self.surface = np.arange(number + 3) * m
        dofs = (2 * self.elements[:, :, None] + np.arange(2)).reshape(-1, 8)
        self.rows, self.columns = np.repeat(dofs, 8, axis=1).ravel(), np.tile(dofs, 8).ravel()
        held = np.zeros((len(r), m, 2), bool)
        held[0, :, 0] = held[-1, :, :] = held[:, -1, :] = True
        self.free = np.flatnonzero(~held.ravel())
        self.place = np.full(held.size, -1)
        self.place[self.free] = np.arange(self.free.size)
        self.u, self.stress = np.zeros_like(self.X), np.zeros((len(self.elements), 4, 4))
        self.force, self.delta, self.radius = np.zeros(self.surface.size), 0.0, 0.0
        self.rate, self.last = np.zeros_like(self.X), 0.0
        none = np.zeros_like(self.X)
        args = self.X, self.elements, none, none, self.stress, self.E, 1.0, False
        push = np.zeros((self.free.size, self.surface.size))
        push[self.place[2 * self.surface + 1], range(self.surface.size)] = 1.0
        moved = splu(self._matrix(assemble(*args)[1])).solve(push)
        self.compliance = 0.0 * push.T @ push if rigid else push.T @ moved
        self.axis = np.arange(m - 1)  # the last one is held
        self.elastic = moved[self.place[2 * self.axis + 1]]

    def _matrix(self, K: Array) -> sparse.csc_array:
        size = self.place.size
        whole = sparse.coo_array((K.ravel(), (self.rows, self.columns)), (size, size)).tocsr()
        return whole[self.free][:, self.free].tocsc()

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
        above = self.u[self.axis, 1] + self.elastic @ self.force
        return np.interp(self.radius / np.array(AXIS), -self.X[self.axis, 1], above)

    def _balance(self, delta: float) -> bool:
        """Find the equilibrium at `delta` and keep it; return False where Newton's method fails."""
        force, nodes, step = self.force.copy(), self.surface, delta - self.delta
        du = self.rate * (step if step * self.last > 0.0 else 0.0)  # the answer does not need it
        for _ in range(30):
            f, K, stress = assemble(
                self.X, self.elements, self.u, du, self.stress, self.E, 1.0, self.large
            )
            moved = (self.u + du)[nodes]
            r = self.X[nodes, 0] + (moved[:, 0] if self.large else 0.0)
            if not np.abs(r).max() < 1.0:
                return False
            profile = 1.0 - np.sqrt(1.0 - r**2) if self.large else 0.5 * r**2
            slope = r / np.sqrt(1.0 - r**2) if self.large else np.zeros_like(r)
            gap = profile - delta + self.compliance @ force - moved[:, 1]
            on = force - self.E * self.X[nodes[1], 0] * gap > 0.0
            lines, pair = np.flatnonzero(on), np.arange(on.sum())
            at_r, at_z = self.place[2 * nodes[on]], self.place[2 * nodes[on] + 1]
            turned = at_r >= 0  # the node on the axis does not move sideways
            D = sparse.coo_array(
                (
                    np.r_[slope[on][turned], -np.ones(pair.size)],
                    (np.r_[pair[turned], pair], np.r_[at_r[turned], at_z]),
                ),
                (pair.size, self.free.size),
            ).tocsc()
            residual = f[self.free] - D.T @ force[on]
            lost = self.compliance[np.ix_(lines, np.flatnonzero(~on))] @ -force[~on]
            size = max(float(force.sum()), 1e-3 * self.F_y)
            error = max(
                np.abs(residual).max() / size,
                np.abs(gap[on]).max(initial=0.0) / delta,
                np.abs(force[~on]).max(initial=0.0) / size,
            )
            if error < 1e-7:
                break
            system = sparse.block_array(
                [[self._matrix(K), -D.T], [D, sparse.csc_array(self.compliance[np.ix_(on, on)])]],
                format="csc",
            )
            try:
                answer = splu(system).solve(np.r_[-residual, -gap[on] - lost])
            except RuntimeError:  # singular
                return False
            du.ravel()[self.free] += answer[: self.free.size]
            force[on] += answer[self.free.size :]
            force[~on] = 0.0
        else:
            return False
        self.rate, self.last = du / step, step
        self.u, self.stress, self.force, self.delta = self.u + du, stress, force, delta
        self.radius = float(r[force > 0].max(initial=0.0))
        return True


def run(args: argparse.Namespace) -> None:
    """Load to the depth and unload from the depths asked for; append rows to the file."""
    solve = Solve(args.modulus, args.depth, args.elements, args.rigid, args.small)
    solve.stress[:, :, [0, 2]] = args.stress
    bodies = "rigid" if args.rigid else "elastic", "small" if args.small else "large"
    kind = *bodies, args.modulus, args.stress
    begun, rows, lifts = time.process_time(), [], []

    def note(x: float, top: float) -> float:
        F, a = solve.move(x * solve.delta_y)
        rows.append((*kind, args.elements, top, f"{x:.6g}", f"{F / solve.F_y:.7g}", f"{a:.5g}"))
        lifts.append((f"{x:.6g}", *(f"{each:.4g}" for each in solve.lift() / solve.delta_y)))
        return F

    tops = {*(args.unload or []), args.depth}
    loading = np.linspace(0.09, 1.0, args.steps)[:-1] ** 2 * args.depth
    for number, x in enumerate(sorted({*loading.tolist(), *tops})):
        if x in tops or number % 4 == 0:
            note(x, f"{x:.6g}")
        else:
            solve.move(x * solve.delta_y)
        if x in tops and x in (args.unload or []):
            kept = solve.u, solve.stress, solve.force, solve.delta
            F_m, depth, step = solve.force.sum(), x, 0.0
            step = 0.1 * F_m / (2.0 * args.modulus * math.sqrt(x * solve.delta_y)) / solve.delta_y
            while note(depth := depth - min(step, 0.9 * depth), f"{x:.6g}") > 0.03 * F_m:
                left, fell = float(rows[-1][6]), float(rows[-2][6]) - float(rows[-1][6])
                step *= min(0.15 * F_m / solve.F_y, 0.45 * left) / fell
            solve.u, solve.stress, solve.force, solve.delta = kept
    new = not Path(args.output).exists()
    with Path(args.output).open("a", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        if new:
            table.writerow(COLUMNS)
        table.writerows(rows)
    if args.axis:
        with Path(args.axis).open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([("x", *AXIS), *lifts])
    print(*kind, args.depth, len(solve.X), f"{time.process_time() - begun:.0f} s", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("output")
    parser.add_argument("--modulus", type=float, default=115e9 / 345e6, help="E*/S_y")
    parser.add_argument("--depth", type=float, required=True, help="largest delta/delta_y")
    parser.add_argument("--unload", type=float, nargs="*", help="unload from these, too")
    parser.add_argument("--elements", type=int, default=60, help="over the largest radius")
    parser.add_argument("--stress", type=float, default=0.0, help="along the surface, over S_y")
    parser.add_argument("--steps", type=int, default=200, help="of loading")
    parser.add_argument("--axis", help="write the displacement of the axis to this file, too")
    parser.add_argument("--rigid", action="store_true")
    parser.add_argument("--small", action="store_true", help="small strains, a paraboloid")
    run(parser.parse_args())
