"""Kratos' steps, one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from impactlab.model.impact import Impact
from impactlab.reference.kratos import readings
from impactlab.reference.kratos.engine import Engine
from impactlab.reference.kratos.history import History, Moment
from impactlab.reference.kratos.model_part import fill, hold, launch
from impactlab.reference.kratos.settings import PART, RESIDUAL_RATIO, settings
from impactlab.reference.solid import Mesh, PatchTooSmallError
from impactlab.reference.solid.mesh import SPHERE
from impactlab.reference.solid.mesh.mesh import Floats
from impactlab.reference.solid.stepping.masses import nodal_masses

Progress = Callable[[float, float], None]


class Run:
    """An impact on a mesh in Kratos, ready to go. history: what it has left so far."""

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
        told = engine.core.Parameters(settings(duration, time_step, penalty))
        self._analysis = engine.analysis(model, told)
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
        """One step; it is kept if it converged."""
        analysis = self._analysis
        analysis.time = analysis._GetSolver().AdvanceInTime(analysis.time)
        analysis.InitializeSolutionStep()
        if not (analysis.SolveSolutionStep() or self._balanced()):
            self.history.stopped = f"Newton's iterations did not converge at {analysis.time:.4g} s"
            return
        analysis.FinalizeSolutionStep()
        self.history.moments.append(self._moment(analysis.time))

    def _balanced(self) -> bool:
        """Whether forces balance, though Kratos' set of touching nodes does not settle.

        A node that barely touches may change sides with each iteration, and no force with it.
        """
        ratio = self.part.ProcessInfo[self.engine.variable("CONVERGENCE_RATIO")]
        return bool(ratio <= RESIDUAL_RATIO)

    def _moment(self, now: float) -> Moment:
        down = -readings.vectors(self.engine, self.part, "DISPLACEMENT")[:, 2]
        speed = -readings.vectors(self.engine, self.part, "VELOCITY")[:, 2]
        mesh = self.mesh
        self._check_patch(down)
        return Moment(
            now,
            readings.contact_force(self.engine, self.part),
            float(self._sphere @ down),
            *(float(down[node]) for node in (mesh.pole, mesh.axis_node, mesh.top_node)),
            float(self._sphere @ speed),
            float(self.part.ProcessInfo[self.engine.variable("NL_ITERATION_NUMBER")]),
        )

    def _check_patch(self, down: Floats) -> None:
        upper, lower = self.mesh.pairs[self.mesh.rim].T
        if np.any(self.mesh.gaps[self.mesh.rim] < down[upper] - down[lower]):
            raise PatchTooSmallError(
                f"the contact reaches the rim of the patch of matched nodes: patch must be above "
                f"{self.mesh.patch:.4g} m"
            )


def _shares(mesh: Mesh, impact: Impact) -> Any:
    """Each node's share of the sphere's mass, (n,): 0 in the beam."""
    mass = nodal_masses(mesh, impact)
    mass[np.setdiff1d(np.arange(mass.size), mesh.elements[mesh.body == SPHERE])] = 0.0
    return mass / mass.sum()
