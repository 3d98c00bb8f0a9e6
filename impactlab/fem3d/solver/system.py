"""The 3-D model in motion: elements in SIMD blocks, one step on threads, bounds.

Each node has one row of forces per piece of a group of elements that it belongs to. Two threads
never add to the same row, and the order of all sums is that of the mesh: a group is cut into the
same pieces for any number of threads, so the number of threads changes no bit of the results.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from impactlab.fem3d.solver.compiler import Array, compiled, inlined
from impactlab.fem3d.solver.elements import FULL_ROWS, ROWS, add_forces, blocks_of
from impactlab.fem3d.solver.hexahedron import SCRATCH, Vector, W, cross, dot
from impactlab.fem3d.solver.impulses import RULE, close_gaps
from impactlab.fem3d.solver.material import PAST_ROWS, STRESS_ROWS, Metal, Rate
from impactlab.fem3d.solver.mesh import BEAM, NEIGHBOURS, SPHERE, Mesh, nodal_masses
from impactlab.fem3d.solver.springs import add_spring_forces, damping_of, springs_of, sum_rows
from impactlab.model.impact import Impact
from impactlab.model.material import Material
from impactlab.types import Floats

MOST_THREADS = 24  # pieces of a group, each the work of one thread


class Group:
    """Elements of one body with the same number of integration points.

    elements: (g,) numbers in the mesh. nodes: (blocks, 8 W), the last element repeated to fill.
    state, past, works: see elements.add_forces, works of each piece: (MOST_THREADS, 3 W).
    """

    def __init__(self, elements: Array, numbers: Array, full: bool, material: Material) -> None:
        """Take the elements of these numbers, at rest; elements: the mesh's, (e, 8)."""
        blocks = -(-numbers.size // W)
        filled = np.append(numbers, np.repeat(numbers[-1], blocks * W - numbers.size))
        nodes = elements[filled].reshape(blocks, W, 8).transpose(0, 2, 1).reshape(blocks, 8 * W)
        self.elements, self.points = numbers, 8 if full else 1
        self.metal, self.rate = metal(material), rate_law(material)
        # Signed ones may count from the end.
        self.nodes = np.ascontiguousarray(nodes, dtype=np.uint32)
        self.state = np.zeros((blocks, (FULL_ROWS if full else ROWS) * W))
        self.past = np.zeros((blocks, self.points * PAST_ROWS * W))
        self.works = np.zeros((MOST_THREADS, 3 * W))

    @property
    def deviators(self) -> Array:
        """Return the deviator at every integration point in Pa, (points, 6, g)."""
        rows = self._rows(self.state)[: self.points * STRESS_ROWS]
        return rows.reshape(self.points, STRESS_ROWS, -1)

    def of_points(self, row: int) -> Array:
        """Return a row of the past of every integration point, (points, g)."""
        return self._rows(self.past)[row::PAST_ROWS]

    def energies(self) -> Array:
        """Return the sums over the elements of the rows of `works` in J, (3,)."""
        return np.asarray(self.works.reshape(MOST_THREADS, 3, W).sum(axis=(0, 2)))

    def _rows(self, held: Array) -> Array:
        rows = held.reshape(len(held), -1, W).transpose(1, 0, 2)
        return rows.reshape(len(rows), -1)[:, : self.elements.size]


def refuse_flow_law(material: Material) -> None:
    """Raise ValueError where the metal has a flow law, which no 3-D model has."""
    if material.flow_law != "linear":
        raise ValueError(
            f"Material.flow_law = {material.flow_law!r}: the 3-D model and its decks harden "
            'linearly: set flow_law="linear"'
        )


def refuse_rate(material: Material) -> None:
    """Raise ValueError where the yield stress depends on the strain rate, which decks leave out."""
    refuse_flow_law(material)
    for field in ("rate_coefficient", "rate_sensitivity"):
        if (value := getattr(material, field)) > 0.0:
            raise ValueError(
                f"Material.{field} = {value!r}: decks for other programs leave the strain rate "
                "out: set it to 0"
            )


def rate_law(material: Material) -> Rate | None:
    """Return the law of the strain rate; None for a yield stress that does not depend on it."""
    if material.rate_sensitivity > 0.0:
        return material.reference_rate, 0.0, material.rate_sensitivity
    if material.rate_coefficient > 0.0:
        return material.rate_coefficient, material.rate_exponent, 0.0
    return None


def metal(material: Material) -> Metal:
    """Return E, nu, G, K, sigma_y, H_i, H_k. Raises ValueError for a flow law."""
    refuse_flow_law(material)
    E, nu = material.youngs_modulus, material.poissons_ratio
    return (
        E,
        nu,
        E / (2.0 * (1.0 + nu)),
        E / (3.0 * (1.0 - 2.0 * nu)),
        material.yield_stress,
        material.isotropic_hardening_modulus,
        material.kinematic_hardening_modulus,
    )


class ForceAssembly:
    """Rows of forces, (count, 3), for the elements of all groups.

    of_groups: like Group.nodes, the rows in place of the nodes. starts: (n + 1,);
    slots[starts[i]:starts[i + 1]]: the rows of node i.
    """

    def __init__(self, groups: Sequence[Group], nodes: int) -> None:
        """Assign the rows of force to elements and nodes; nodes: their number."""
        self.of_groups, self.count, owners = [], 0, []
        for group in groups:
            rows = np.empty_like(group.nodes)
            for piece in range(MOST_THREADS):
                blocks = slice(*blocks_of(len(group.nodes), piece, MOST_THREADS))
                distinct, place = np.unique(group.nodes[blocks], return_inverse=True)
                rows[blocks] = self.count + place.reshape(rows[blocks].shape)
                owners.append(distinct)
                self.count += distinct.size
            spare = len(group.nodes) * W - group.elements.size
            rows.reshape(-1, 8, W)[-1, :, W - spare :] = self.count  # fills the block, adds nothing
            owners.append(np.array([nodes]))
            self.count += 1
            self.of_groups.append(rows)
        every = np.concatenate(owners)
        starts = np.concatenate([[0], np.cumsum(np.bincount(every, minlength=nodes)[:nodes])])
        slots = np.argsort(every, kind="stable")[: starts[-1]]
        self.starts, self.slots = starts.astype(np.int32), slots.astype(np.uint32)


class ThreadPool(ThreadPoolExecutor):
    """A pool for compiled functions over ranges of numbers; one of its threads is the caller's."""

    def __init__(self, threads: int) -> None:
        """Start that many threads, at least 1."""
        super().__init__(max(threads - 1, 1))
        self.threads = threads

    def run(self, work: Callable[[int, int, int], Any], count: int) -> None:
        """Call work(thread, first, end) for parts of `count` numbers; wait for all.

        Each thread takes the next part when it is done with its last one. The parts get smaller, so
        that none waits long for another, be it slower.
        """
        if self.threads == 1:
            work(0, 0, count)
            return
        ends = [0]
        while (rest := count - ends[-1]) > 0:
            ends.append(ends[-1] + max(rest // (2 * self.threads), count // MOST_THREADS, 1))
        ends[-1] = count
        parts = iter(list(pairwise(ends)))  # a list's gives each item to one thread

        def take(thread: int) -> None:
            for part in parts:
                work(thread, *part)

        started = [self.submit(take, thread) for thread in range(1, self.threads)]
        take(0)
        for other in started:
            other.result()


@compiled
def integrate(
    nodes: tuple[int, int],
    starts: Array,
    slots: Array,
    forces: Array,
    inverse_mass: Array,
    pull: Array,
    x: Array,
    v: Array,
    velocity_dt: float,
    dt: float,
) -> None:
    """Move the nodes from the first to before the last of `nodes`.

    starts: (n + 1,); slots[starts[i]:starts[i + 1]]: node i's rows of forces (., 3) in N, which are
    left at 0.
    inverse_mass: (n, 3) in 1/kg, 0 where a node is held. pull: (n,) downward acceleration in m/s2.
    velocity_dt, dt: seconds between the velocities and between the positions.
    """
    for node in range(nodes[0], nodes[1]):
        f0, f1, f2 = 0.0, 0.0, 0.0
        for position in range(starts[node], starts[node + 1]):
            slot = slots[position]
            f0 += forces[slot, 0]
            f1 += forces[slot, 1]
            f2 += forces[slot, 2]
            forces[slot, 0], forces[slot, 1], forces[slot, 2] = 0.0, 0.0, 0.0
        v[node, 0] -= velocity_dt * inverse_mass[node, 0] * f0
        v[node, 1] -= velocity_dt * inverse_mass[node, 1] * f1
        v[node, 2] -= velocity_dt * (inverse_mass[node, 2] * f2 + pull[node])
        x[node, 0] += dt * v[node, 0]
        x[node, 1] += dt * v[node, 1]
        x[node, 2] += dt * v[node, 2]


class System:
    """Nodes with positions x (n, 3) in m and velocities v (n, 3) in m/s, half a step apart.

    groups: the elements. springs: see springs.py. mass: (n,) in kg. closing: (p,) distances in m by
    which the last step parted pairs, 0 where they do not touch. damping: of the beam, None without.
    All arrays are changed in place.
    """

    def __init__(self, mesh: Mesh, impact: Impact, pool: ThreadPool) -> None:
        """Start at first touch: the sphere moves at the impact's velocity, the beam is at rest."""
        self.mesh, self.pool = mesh, pool
        self.x, self.v = mesh.nodes.copy(), np.zeros_like(mesh.nodes)
        materials = {BEAM: impact.beam.material, SPHERE: impact.sphere.material}
        self.groups = [
            Group(mesh.elements, numbers, full, materials[body])
            for body, full, numbers in mesh.groups()
        ]
        self.assembly = ForceAssembly(self.groups, len(mesh.nodes))
        self.forces = np.zeros((self.assembly.count, 3))
        self.springs = springs_of(mesh, impact)
        self._spring_rows = self.assembly.slots[self.assembly.starts[self.springs.nodes]]
        self.mass = nodal_masses(mesh, impact)
        self.inverse_mass = np.repeat(1.0 / self.mass[:, None], 3, axis=1)
        for axis, held in enumerate((mesh.symmetry_x, mesh.symmetry_y, mesh.support)):
            self.inverse_mass[held, axis] = 0.0
        self.inverse_mass[mesh.clamped] = 0.0
        self.damping = damping_of(mesh, impact.beam, self.mass, self.inverse_mass)
        if self.damping is not None:
            self._first_rows = self.assembly.slots[self.assembly.starts[:-1]]
            self._drag_rows = np.zeros_like(self.forces)
            parts = zip(mesh.groups(), self.groups, self.assembly.of_groups, strict=True)
            self._dragged = [
                (group, rows, np.zeros_like(group.state), np.zeros_like(group.works))
                for (body, *_), group, rows in parts
                if body == BEAM
            ]
        sphere = np.unique(mesh.elements[mesh.body == SPHERE])
        self.v[sphere, 2] = -impact.velocity
        self.pull = np.zeros(len(mesh.nodes))
        self.pull[sphere] = impact.gravity
        self.approach = np.full(len(mesh.pairs), impact.velocity, dtype=float)
        self.closing = np.zeros(len(mesh.pairs))
        self._share = 1.0 / np.bincount(mesh.faces.ravel())
        self._scratch = [np.zeros(SCRATCH * W) for _ in range(pool.threads)]

    def strain(self, dt: float) -> None:
        """Strain the elements by a motion of dt (s) with v, which has led to x."""

        def work(thread: int, first: int, end: int) -> None:
            scratch = self._scratch[thread]
            for group, rows in zip(self.groups, self.assembly.of_groups, strict=True):
                metal = (group.metal, group.rate)
                arrays = (group.elements.size, group.points == 8, *metal, group.nodes, rows)
                held = (group.state, group.past, group.works)
                moved = (self.x, self.v, dt)
                add_forces((first, end), *arrays, *held, *moved, self.forces, scratch)

        self.pool.run(work, MOST_THREADS)

    def drag(self, dt: float) -> None:
        """Set what the stiffness's damping takes of v, which has led to x in dt (s)."""
        damping = self.damping
        if damping is None or damping.beta == 0.0:
            return

        def work(thread: int, first: int, end: int) -> None:
            scratch = self._scratch[thread]
            for group, rows, *held in self._dragged:
                metal = (damping.metal(group.metal, dt), None)
                arrays = (group.elements.size, group.points == 8, *metal, group.nodes, rows)
                state, works = held
                moved = (self.x, self.v, dt, self._drag_rows)
                add_forces((first, end), *arrays, state, group.past, works, *moved, scratch)

        for _, _, state, _ in self._dragged:
            state[:] = 0.0
        self.pool.run(work, MOST_THREADS)
        sum_rows(self.assembly.starts, self.assembly.slots, self._drag_rows, damping.drag)
        place = self.springs.nodes, self.springs.axes
        np.add.at(damping.drag, place, damping.beta * self.springs.stiffness * self.v[place])

    def move(self, velocity_dt: float, dt: float) -> tuple[float, float, float, bool]:
        """Apply all forces for velocity_dt (s), the contact's included, move the nodes by dt (s).

        Returns what close_gaps does.
        """
        damping, inverse_mass = self.damping, self.inverse_mass
        if damping is not None:
            self.forces[self._first_rows] += damping.drag
            damping.begin(self.v, velocity_dt)
            inverse_mass = damping.inverse_mass
        if self.springs.nodes.size:
            places = self._spring_rows, self.mesh.nodes, self.x
            add_spring_forces(*self.springs, *places, self.forces)
        rows = (self.assembly.starts, self.assembly.slots, self.forces)
        moved = (*rows, inverse_mass, self.pull, self.x, self.v, velocity_dt, dt)
        self.pool.run(lambda _, first, end: integrate((first, end), *moved), len(self.x))
        mesh = self.mesh
        contact = (mesh.faces, mesh.bulge, self._share, mesh.pairs, mesh.rim, mesh.normals)
        answer: tuple[float, float, float, bool] = close_gaps(
            RULE, *contact, inverse_mass, self.x, self.v, dt, self.approach, self.closing
        )
        if damping is not None:
            damping.end(self.v, velocity_dt)
        return answer


_TINY = 1e-12  # seconds of motion at about 1 m/s: strains stay far below 1


def critical_step(system: System) -> float:
    """Return 2/omega of the fastest mode in s, by Lanczos, of a system that is not yet strained.

    The elements' own forces are what the eigenvalue is taken of, so no estimate stands between; the
    springs' matrix is diagonal.
    """
    root = np.sqrt(system.inverse_mass)
    sprung = (system.springs.diagonal(len(root)) * system.inverse_mass).ravel()
    rows, rest = system.assembly, system.v.copy()

    def product(vector: Floats) -> Floats:
        system.v[:] = root * vector.reshape(root.shape)
        system.strain(_TINY)
        answer = root * np.add.reduceat(system.forces[rows.slots], rows.starts[:-1], axis=0)
        system.forces[:] = 0.0
        for group in system.groups:
            group.state[:], group.works[:] = 0.0, 0.0
        return np.asarray(answer.ravel() / _TINY + sprung * vector)

    operator = LinearOperator((root.size, root.size), matvec=product, dtype=np.float64)
    start = np.random.default_rng(0).standard_normal(root.size)
    (largest,) = eigsh(
        operator, k=1, which="LA", tol=1e-2, ncv=20, v0=start, return_eigenvectors=False
    )
    system.v[:] = rest
    return float(2.0 / np.sqrt(largest))


@inlined
def _edge(x: Array, start: int, end: int) -> Vector:
    return (x[end, 0] - x[start, 0], x[end, 1] - x[start, 1], x[end, 2] - x[start, 2])


@compiled
def corner_volumes(elements: Array, x: Array, volumes: Array) -> float:
    """Store triple products of the edges at each corner in volumes (e, 8), in m3; inverted: < 0.

    elements: (e, 8). x: (n, 3) in m. Returns the shortest edge in m.
    """
    shortest = np.inf
    for e in range(elements.shape[0]):
        for corner in range(8):
            start = elements[e, corner]
            a = _edge(x, start, elements[e, NEIGHBOURS[corner, 0]])
            b = _edge(x, start, elements[e, NEIGHBOURS[corner, 1]])
            c = _edge(x, start, elements[e, NEIGHBOURS[corner, 2]])
            volumes[e, corner] = dot(a, cross(b, c))
            shortest = min(shortest, dot(a, a), dot(b, b), dot(c, c))
    return float(np.sqrt(shortest))
