"""Springs of elastic ends and the foundation, and the damping of the beam.

A spring leads from a node to the ground, along one axis. The resultants are those of the beam
models. At an elastic end, with w the mean deflection of the
line at mid-depth of its face, and theta = integral of z u dA/(integral of z^2 dA) the rotation of
the face, where u is the displacement along the beam:

    force  k_t w       vertical springs on the line at mid-depth, on which pinned ends rest, each by
                       the width around its node
    moment k_r theta   springs along the beam on all of the face, by the area A_i around each node:
                       k_i = k_r A_i/(sum of A z^2)

The second hold the axis along the beam, too, with k_r A/I, as clamped ends do; the sum of A z
vanishes, so a rotation causes no force. A foundation of k per length lies under the bottom face,
where a bed is, with k/B per area; its springs are vertical. Stiff springs let a step be shorter:
they are part of system.critical_step.

Rayleigh's damping of the beam is of its masses, and of its elastic stiffness where it yields, too.
With v at mid-step, the nodes' masses m, and the forces f of elements and springs, a step of dt is

    (1 + h) v_after = (1 - h) v - dt/m (f + g) + I/m,  h = alpha dt/2,  g = beta K v,

where I is the contact's impulse: the mass's damping is central, the stiffness's lags by half a
step, as in the beam models (impactlab/solver/resistance.py). K v is the answer of elements without
stress that do not yield, where the nodes are, and of all springs. Half of a step's impulse of
damping, dt (g + alpha m (v + v_after)/2), works on v and half on v_after, which closes the balance
of energy to round-off. With the largest frequency omega, the steps are stable as long as

    dt (dt + 2 beta) <= 4/omega^2.
"""

from typing import NamedTuple

import numpy as np

from impactlab.fem3d.solver.compiler import Array, compiled
from impactlab.fem3d.solver.estimates import end_springs
from impactlab.fem3d.solver.lattice import Integers
from impactlab.fem3d.solver.material import Metal
from impactlab.fem3d.solver.mesh import BEAM, Mesh, plane_faces
from impactlab.model.bodies import Beam
from impactlab.model.impact import Impact
from impactlab.types import Floats

_X, _Z = 0, 2


class Springs(NamedTuple):
    """Nodes (s,) with springs along axes (s,) of 0, 1, 2; their stiffness (s,) in N/m."""

    nodes: Integers
    axes: Integers
    stiffness: Floats

    def diagonal(self, nodes: int) -> Floats:
        """Return the stiffness in N/m of so many nodes along each axis, (nodes, 3)."""
        total = np.zeros((nodes, 3))
        np.add.at(total, (self.nodes, self.axes), self.stiffness)
        return total

    def energy(self, x: Floats, start: Floats) -> float:
        """Return the energy in J at positions x; start: those without force; both (n, 3) in m."""
        moved = x[self.nodes, self.axes] - start[self.nodes, self.axes]
        return 0.5 * float(np.sum(self.stiffness * moved**2))


def springs_of(mesh: Mesh, impact: Impact) -> Springs:
    """Return the springs of the mesh's part of the beam; none of a stiffness of 0."""
    beam, none = impact.beam, np.empty(0, dtype=np.int32)
    sprung = [(none, _Z, np.empty(0))]
    along = mesh.nodes[mesh.elements[mesh.body == BEAM], _X]
    ends = zip((along.min(), along.max()), end_springs(beam), strict=True)
    for place, (shear, turn) in list(ends)[mesh.copies == 4 :]:
        nodes, areas = _areas(mesh, _X, place)
        height = mesh.nodes[nodes, _Z] + 0.5 * beam.depth
        # The part has half the width, and half of an end's springs.
        squares = float(areas @ height**2)
        sprung.append((nodes, _X, 0.5 * turn / squares * areas))
        line = nodes[np.abs(height) < 1e-6 * mesh.element_size]
        widths = _widths(mesh.nodes[line, 1])
        sprung.append((line, _Z, 0.5 * shear / widths.sum() * widths))
    nodes, areas = _areas(mesh, _Z, -beam.depth)
    sprung.append((nodes, _Z, beam.foundation_stiffness / beam.width * areas))
    axes = [np.full(nodes.size, axis, dtype=np.int32) for nodes, axis, _ in sprung]
    stiffness = np.concatenate([values for *_, values in sprung])
    stiff = stiffness > 0.0
    nodes = np.concatenate([nodes for nodes, *_ in sprung])
    return Springs(nodes[stiff], np.concatenate(axes)[stiff], stiffness[stiff])


def _areas(mesh: Mesh, axis: int, place: float) -> tuple[Integers, Floats]:
    """Return the beam's nodes in the plane at `place` (m) on this axis, and the area of each."""
    moved = mesh.nodes - place * np.eye(3)[axis]
    _, faces = plane_faces(moved, mesh.elements[mesh.body == BEAM], axis, mesh.element_size)
    a, b, c, d = np.moveaxis(mesh.nodes[faces], 1, 0)
    areas = 0.5 * np.linalg.norm(np.cross(c - a, d - b), axis=1)
    nodes, corners = np.unique(faces, return_inverse=True)
    around = np.bincount(corners.ravel(), weights=np.repeat(0.25 * areas, 4))
    return nodes, np.asarray(around, dtype=float)


def _widths(y: Floats) -> Floats:
    """Return the width around each node of a line, in the unit of y."""
    order = np.argsort(y)
    halves = 0.5 * np.diff(y[order])
    widths = np.empty_like(y)
    widths[order] = np.append(halves, 0.0) + np.append(0.0, halves)
    return widths


@compiled
def add_spring_forces(
    nodes: Array, axes: Array, stiffness: Array, rows: Array, start: Array, x: Array, forces: Array
) -> None:
    """Add the springs' forces to rows (s,) of forces in N; others: see Springs."""
    for spring in range(nodes.size):
        node, axis = nodes[spring], axes[spring]
        forces[rows[spring], axis] += stiffness[spring] * (x[node, axis] - start[node, axis])


_ENDLESS = 1e300  # yield stress in Pa


@compiled
def sum_rows(starts: Array, slots: Array, rows: Array, sums: Array) -> None:
    """Store the sums of each node's rows (., 3) in sums (n, 3), and leave rows at 0."""
    for node in range(sums.shape[0]):
        for axis in range(3):
            total = 0.0
            for position in range(starts[node], starts[node + 1]):
                total += rows[slots[position], axis]
                rows[slots[position], axis] = 0.0
            sums[node, axis] = total


@compiled
def work_halves(
    impulse_dt: float, drag: Array, mass_rate: Array, before: Array, after: Array
) -> tuple[float, float]:
    """Return the work in J of a step's impulse of damping on velocities before and after it.

    impulse_dt: in s. drag: g in N, (n, 3). mass_rate: alpha m in N s/m, (n,).
    """
    first, second = 0.0, 0.0
    for node in range(before.shape[0]):
        for axis in range(3):
            force = 0.5 * mass_rate[node] * (before[node, axis] + after[node, axis])
            force += drag[node, axis]
            first += force * before[node, axis]
            second += force * after[node, axis]
    return 0.5 * impulse_dt * first, 0.5 * impulse_dt * second


class Damping:
    """Record of what a step takes from the beam.

    work: in J, until the velocity that a step begins with. drag: g in N, (n, 3). inverse_mass:
    1/(m (1 + h)) in 1/kg, (n, 3), of the present step.
    """

    def __init__(self, mesh: Mesh, beam: Beam, mass: Floats, inverse_mass: Floats) -> None:
        """Start with a beam at rest; mass: (n,) in kg. inverse_mass: see system.integrate."""
        self.alpha, self.beta = beam.mass_damping, beam.stiffness_damping
        damped = np.zeros(len(mass))
        damped[np.unique(mesh.elements[mesh.body == BEAM])] = 1.0
        self._rate, self._plain = self.alpha * damped, inverse_mass
        self._mass_rate = self._rate * mass
        self.drag, self.inverse_mass = np.zeros((len(mass), 3)), inverse_mass
        self.work, self._pending = 0.0, 0.0
        self._before = np.zeros_like(self.drag)

    def metal(self, elastic: Metal, dt: float) -> Metal:
        """Return a metal whose stresses after a step of dt (s) are those of damping by beta.

        elastic: see material.Metal.
        """
        E, nu, G, K, *_ = elastic
        share = self.beta / dt
        return (share * E, nu, share * G, share * K, _ENDLESS, 0.0, 0.0)

    def begin(self, v: Floats, velocity_dt: float) -> None:
        """Take what the mass's damping takes of v (n, 3) before the step's other forces."""
        self._before[:] = v
        half = 0.5 * velocity_dt * self._rate[:, np.newaxis]
        self.inverse_mass = self._plain / (1.0 + half)
        v *= (1.0 - half) / (1.0 + half)

    def end(self, v: Floats, velocity_dt: float) -> None:
        """Count the work of the step that has led to v."""
        arrays = (self.drag, self._mass_rate, self._before, v)
        before, after = work_halves(velocity_dt, *arrays)
        self.work, self._pending = self.work + self._pending + before, after


def damping_of(mesh: Mesh, beam: Beam, mass: Floats, inverse_mass: Floats) -> Damping | None:
    """Return the damping of a beam, None where nothing damps it; others: see Damping."""
    if beam.mass_damping == 0.0 and beam.stiffness_damping == 0.0:
        return None
    return Damping(mesh, beam, mass, inverse_mass)
