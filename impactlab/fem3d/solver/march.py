"""The march through time: steps, checkpoints, reasons to stop, and the history it leaves."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from impactlab.fem3d.solver.elements import DISSIPATED, HOURGLASS_WORK, WORK
from impactlab.fem3d.solver.estimates import damped_step, largest_patch
from impactlab.fem3d.solver.impulses import PARTS
from impactlab.fem3d.solver.system import System, corner_volumes, critical_step
from impactlab.model.impact import Impact
from impactlab.types import Floats


class Moment(NamedTuple):
    """At the beginning of a step: time in s, contact force of all copies of the mesh in N.

    Displacements in m, positive downwards: of the sphere's centre of mass and of its pole (from as
    high as its faces bulge), of the beam's axis and of its top below the impact. velocity: of the
    sphere's centre of mass in m/s, downwards, at the middle of the step that begins.
    """

    time: float
    force: float
    sphere: float
    pole: float
    axis: float
    top: float
    velocity: float


class Energies(NamedTuple):
    """At a checkpoint, of all copies of the mesh, in J (time in s), by the names in datasets.

    strain_work: of the stresses in the elements, kept and dissipated. plastic_work: dissipated of
    it. hourglass_work: against hourglassing. contact_work: on pairs that overlap, kept and lost.
    spring_energy: kept by elastic ends and foundation. damping_work: that the beam's damping took.
    """

    time: float
    kinetic_energy: float
    strain_work: float
    plastic_work: float
    hourglass_work: float
    contact_work: float
    gravity_work: float
    spring_energy: float
    damping_work: float

    @property
    def balance(self) -> float:
        """Return the energy that stays constant."""
        energy = self.kinetic_energy + self.strain_work + self.hourglass_work
        energy = energy + self.contact_work + self.spring_energy - self.gravity_work
        return energy + self.damping_work


@dataclass
class History:
    """moments: one per step. energies: one per checkpoint. stopped: the reason for an early stop.

    offset: largest distance by which matched nodes that touched had slid, over the element size.
    patch_needed: of matched nodes in m, where the contact outgrew its own; else 0.
    """

    moments: list[Moment] = field(default_factory=list)
    energies: list[Energies] = field(default_factory=list)
    stopped: str = ""
    offset: float = 0.0
    patch_needed: float = 0.0

    def table(self) -> Floats:
        """Return the moments, (7, steps)."""
        return np.array(self.moments).T


Progress = Callable[[float], None]  # called with the share done

SAFETY = 0.9  # time step over the largest stable one
CHECKPOINTS = 100  # checks on energies and elements in a run
_SLID = 1.0  # slide of nodes that touch, over the element size, beyond which they are no pairs
_FLAT = 0.1  # volume at a corner over that at the start, below which an element is too distorted


class PatchTooSmallError(ValueError):
    """Contact where nodes are not matched."""


class March:
    """A march of a system through time. history: of the steps so far."""

    def __init__(self, system: System, impact: Impact) -> None:
        """Start at first touch."""
        self.system, self.impact, self.history = system, impact, History()
        self._beta = impact.beam.stiffness_damping
        self._undamped = SAFETY * critical_step(system)
        self._step = damped_step(self._undamped, self._beta)
        self._volumes = np.empty(system.mesh.elements.shape)
        self._shortest = corner_volumes(system.mesh.elements, system.x, self._volumes)
        self._dt = self._step
        self._velocity_dt = 0.5 * self._step  # from rest at time 0 to the middle of the first step
        self._time, self._pushed, self._pushing = 0.0, 0.0, 0.0
        self._sphere, self._velocity = 0.0, impact.velocity
        # Where beam and sphere touch, the sphere's node is above by this.
        self._bulge = float(PARTS[:, 0] @ system.mesh.bulge[0])

    def run(self, duration: float, progress: Progress | None = None) -> History:
        """March on to `duration` (s), or until something is wrong or Ctrl-C is pressed.

        Raises ValueError where that is less than a step.
        """
        if duration <= self._dt:
            raise ValueError(
                f"solve.duration = {duration!r} s: must be longer than a step of {self._dt:.3g} s"
            )
        try:
            for checkpoint in range(1, CHECKPOINTS + 1):
                self._advance(duration * checkpoint / CHECKPOINTS)
                if self.history.stopped:
                    break
                if progress:
                    progress(checkpoint / CHECKPOINTS)
        except (PatchTooSmallError, KeyboardInterrupt) as reason:
            if len(self.history.moments) < 2:
                raise  # there is nothing to keep
            self.history.stopped = str(reason) or f"interrupted at {self._time:.4g} s"
        return self.history

    def _advance(self, end: float) -> None:
        """Take steps until `end` (s), then a checkpoint: energies, slide, and reasons to stop."""
        steps = math.ceil((end - self._time) / self._dt)
        if steps <= 0:
            return
        for _ in range(steps - 1):
            self._take()
        system, mesh, history = self.system, self.system.mesh, self.history
        before = system.v.copy()
        worked = mesh.copies * np.sum([group.energies() for group in system.groups], axis=0)
        springs = mesh.copies * system.springs.energy(system.x, mesh.nodes)
        self._take()
        # Energies at the start of this step, kinetic by the velocities around it.
        moment = history.moments[-1]
        kinetic = 0.5 * mesh.copies * float(np.sum(system.mass[:, None] * before * system.v))
        gravity = self.impact.sphere.total_mass * self.impact.gravity * moment.sphere
        work, plastic, hourglass = worked[[WORK, DISSIPATED, HOURGLASS_WORK]].tolist()
        contact = mesh.copies * self._pushed
        damped = 0.0 if system.damping is None else mesh.copies * system.damping.work
        worked = work, plastic, hourglass, contact, gravity, springs, damped
        history.energies.append(Energies(moment.time, kinetic, *worked))
        apart = system.x[mesh.pairs[:, 0]] - system.x[mesh.pairs[:, 1]]
        slid = np.hypot(*apart[system.closing > 0.0, :2].T)
        slide = float(np.max(slid, initial=0.0)) / mesh.element_size
        history.offset = max(history.offset, slide)
        history.stopped = self._wrong()

    def _take(self) -> None:
        """Take one step, from positions at its beginning to those at its end."""
        system, mesh = self.system, self.system.mesh
        tracked = (mesh.pole, mesh.axis_node, mesh.top_node)
        pole, axis, top = mesh.nodes[tracked, 2] - system.x[tracked, 2]
        pole += self._bulge
        impulse, before, after, beyond = system.move(self._velocity_dt, self._dt)
        if beyond:  # for the patch needed, work grows with radius**4 at least (plastic)
            first = self.impact.velocity**2
            left = min(self._velocity, 0.999 * first**0.5) ** 2
            needed = 1.1 * mesh.patch * (first / (first - left)) ** 0.25
            message = (
                f"at {self._time:.4g} s the contact has grown beyond the matched patch of "
                f"{1e3 * mesh.patch:.4g} mm: take patch = {needed:.4g} m or more"
            )
            if needed > (room := largest_patch(self.impact)):
                message += f"; beam and sphere have room for {room:.4g} m"
            self.history.patch_needed = needed
            raise PatchTooSmallError(message)
        force = mesh.copies * impulse / self._velocity_dt
        mass = self.impact.sphere.total_mass
        self._velocity += self._velocity_dt * (self.impact.gravity - force / mass)
        moment = Moment(self._time, force, self._sphere, pole, axis, top, self._velocity)
        self.history.moments.append(moment)
        self._pushed, self._pushing = self._pushed + self._pushing + before, after
        self._sphere += self._dt * self._velocity
        self._time += self._dt
        system.strain(self._dt)
        system.drag(self._dt)
        self._velocity_dt = self._dt

    def _wrong(self) -> str:
        """Return a reason to stop here, or ""; shorten the steps with the elements."""
        system = self.system
        if not math.isfinite(self.history.energies[-1].balance):
            return f"diverged before {self._time:.4g} s"
        if self.history.offset > _SLID:
            return (
                f"nodes that touch had slid by an element on each other at {self._time:.4g} s: "
                "take larger elements or a lower velocity"
            )
        volumes = np.empty_like(self._volumes)
        shortest = corner_volumes(system.mesh.elements, system.x, volumes)
        ratio = np.min(volumes / self._volumes, axis=1)
        worst = int(np.argmin(ratio))
        if ratio[worst] < _FLAT:
            place = 1e3 * system.mesh.nodes[system.mesh.elements[worst]].mean(axis=0)
            return (
                f"an element at x, y, z = {place.round(2).tolist()} mm was squeezed to "
                f"{ratio[worst]:.2g} of its corner volume at {self._time:.4g} s: take larger "
                "elements or a lower velocity"
            )
        ratio = min(1.0, shortest / self._shortest)
        shorter = damped_step(self._undamped * ratio, self._beta)
        self._velocity_dt, self._dt = 0.5 * (self._dt + shorter), shorter
        return ""
