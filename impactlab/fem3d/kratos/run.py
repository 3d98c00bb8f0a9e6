"""Kratos' steps, one after the other, and the history they leave."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from impactlab.fem3d.kratos.engine import PART, RESIDUAL_RATIO, Engine, settings
from impactlab.fem3d.kratos.model_part import contact_force, fill, hold, launch, vectors
from impactlab.fem3d.solver import Mesh, PatchTooSmallError
from impactlab.fem3d.solver.mesh import SPHERE
from impactlab.fem3d.solver.mesh.mesh import Floats, nodal_masses
from impactlab.model.impact import Impact


class Moment(NamedTuple):
    """At the end of a step: time in s, contact force of all four quarters in N.

    Displacements in m, positive downwards: of the sphere's centre of mass and of its pole, of the
    beam's axis and of its top below the impact. velocity: of the sphere's centre of mass in m/s,
    downwards. iterations: Newton's, in this step.
    """

    time: float
    force: float
    sphere: float
    pole: float
    axis: float
    top: float
    velocity: float
    iterations: float


@dataclass
class History:
    """moments: one per step and one before. stopped: the reason for an early stop, else ""."""

    moments: list[Moment] = field(default_factory=list)
    stopped: str = ""
    cpu_seconds: float = 0.0

    def table(self) -> Floats:
        """Return the moments, (8, steps + 1)."""
        return np.array(self.moments).T


Progress = Callable[[float, float], None]

_HALVINGS = 5
"""Number of times that a step is cut in half if it does not converge."""


class Run:
    """An impact on a mesh in Kratos. history: of the steps so far."""

    def __init__(
        self,
        engine: Engine,
        mesh: Mesh,
        impact: Impact,
        *,
        duration: float,
        time_step: float,
        penalty: float,
    ) -> None:
        """Take s, s and N/m3; raises ValueError for a material that Kratos' law cannot follow."""
        self._started = time.process_time()
        self.engine, self.mesh, self.duration = engine, mesh, duration
        self.history = History([Moment(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, impact.velocity, 0.0)])
        model = engine.core.Model()
        self.part = model.CreateModelPart(PART)
        self.part.ProcessInfo[engine.variable("DOMAIN_SIZE")] = 3
        parameters = engine.core.Parameters(settings(duration, time_step, penalty))
        self._analysis = engine.analysis(model, parameters)
        fill(engine, self.part, mesh, impact)
        self._analysis.Initialize()
        hold(engine, self.part, mesh)
        launch(engine, self.part, mesh, impact)
        self._sphere = _shares(mesh, impact)

    def go(self, progress: Progress | None = None) -> History:
        """Step on to the end, or until a step does not converge or Ctrl-C is pressed.

        Raises PatchTooSmallError when the contact leaves the matched patch.
        """
        analysis = self._analysis
        try:
            while analysis.KeepAdvancingSolutionLoop() and not self.history.stopped:
                self._take()
                if progress:
                    progress(analysis.time, min(analysis.time / self.duration, 1.0))
        except KeyboardInterrupt:
            self.history.stopped = f"interrupted at {analysis.time:.4g} s"
        self.history.cpu_seconds = time.process_time() - self._started
        return self.history

    def _take(self) -> None:
        """Take one step, or as much of it as converges; the following steps take the rest."""
        analysis, before = self._analysis, self._analysis.time
        analysis.time = analysis._GetSolver().AdvanceInTime(before)
        for _ in range(1 + _HALVINGS):
            analysis.InitializeSolutionStep()
            if analysis.SolveSolutionStep() or self._balanced():
                analysis.FinalizeSolutionStep()
                self.history.moments.append(self._moment(analysis.time))
                return
            analysis.time = 0.5 * (before + analysis.time)
            self._begin_again()
        self.history.stopped = f"Newton's iterations did not converge after {before:.4g} s"

    def _begin_again(self) -> None:
        """Go back to where the step began, to end at the analysis' time."""
        part = self.part
        part.OverwriteSolutionStepData(1, 0)
        part.ReduceTimeStep(part, self._analysis.time)
        displacement = self.engine.variable("DISPLACEMENT")
        self.engine.core.VariableUtils().UpdateCurrentPosition(part.Nodes, displacement)

    def _balanced(self) -> bool:
        """Return whether forces balance although Kratos' set of touching nodes does not settle.

        A node that barely touches may change sides with each iteration, and no force with it.
        """
        ratio = self.part.ProcessInfo[self.engine.variable("CONVERGENCE_RATIO")]
        return bool(ratio <= RESIDUAL_RATIO)

    def _moment(self, now: float) -> Moment:
        down = -vectors(self.engine, self.part, "DISPLACEMENT")[:, 2]
        speed = -vectors(self.engine, self.part, "VELOCITY")[:, 2]
        iterations = self.engine.variable("NL_ITERATION_NUMBER")
        mesh = self.mesh
        self._check_patch(down)
        return Moment(
            time=now,
            force=contact_force(self.engine, self.part),
            sphere=float(self._sphere @ down),
            pole=float(down[mesh.pole]),
            axis=float(down[mesh.axis_node]),
            top=float(down[mesh.top_node]),
            velocity=float(self._sphere @ speed),
            iterations=float(self.part.ProcessInfo[iterations]),
        )

    def _check_patch(self, down: Floats) -> None:
        upper, lower = self.mesh.pairs[self.mesh.rim].T
        if np.any(self.mesh.gaps[self.mesh.rim] < down[upper] - down[lower]):
            raise PatchTooSmallError(
                f"the contact reaches the rim of the patch of matched nodes: patch must be above "
                f"{self.mesh.patch:.4g} m",
                self.mesh.patch,
            )


def _shares(mesh: Mesh, impact: Impact) -> Floats:
    """Return each node's share of the sphere's mass, (n,): 0 in the beam."""
    mass = nodal_masses(mesh, impact)
    mass[np.setdiff1d(np.arange(mass.size), mesh.elements[mesh.body == SPHERE])] = 0.0
    return np.asarray(mass / mass.sum())
