"""Rayleigh's damping of the beam: of its masses, and of its elastic stiffness where it yields, too.

With v at mid-step, the nodes' masses m, and the forces f of elements and springs, a step of dt is

    (1 + h) v_after = (1 - h) v - dt/m (f + g) + I/m,  h = alpha dt/2,  g = beta K v,

where I is the contact's impulse: the mass's damping is central, the stiffness's lags by half a
step, as in the beam models (impactlab/solver/resistance.py). K v is the answer of elements without
stress that do not yield, where the nodes are, and of all springs. Half of a step's impulse of
damping, dt (g + alpha m (v + v_after)/2), works on v and half on v_after, which closes the balance
of energy to round-off. With the largest frequency omega, the steps are stable as long as

    dt (dt + 2 beta) <= 4/omega^2.
"""

import numpy as np

from impactlab.fem3d.solver.compiler import Array, compiled
from impactlab.fem3d.solver.material import Metal
from impactlab.fem3d.solver.mesh import BEAM, Mesh
from impactlab.model.bodies import Beam
from impactlab.types import Floats

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
