"""One impact on one mesh, solved by Kratos step by step and returned as a dataset."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import xarray as xr

from impactlab.fem3d.kratos.engine import PART, RESIDUAL_RATIO, Engine, engine, settings
from impactlab.fem3d.kratos.model_part import (
    contact_force,
    fill,
    hold,
    launch,
    plastic_strains,
    vectors,
)
from impactlab.fem3d.solver import Mesh, PatchTooSmallError, quarter_mesh
from impactlab.fem3d.solver.march import History, Moment, Progress
from impactlab.fem3d.solver.mesh import SPHERE
from impactlab.fem3d.solver.mesh.mesh import nodal_masses
from impactlab.fem3d.solver.responses import history_responses, plastic_responses
from impactlab.fem3d.solver.solve import histories, named
from impactlab.model.checks import integer, positive
from impactlab.model.impact import Impact
from impactlab.variables import provenance

TIME_STEP, PENALTY = 8e-6, 1e15
"""s, and N/m3 (1e6 N/mm3)."""


def solve(
    impact: Impact, *, element_size: float, patch: float | None = None, **options: Any
) -> xr.Dataset:
    """Solve one impact on the mesh that quarter_mesh makes of element_size and patch (m).

    options, and what is returned and raised, as in solve_on.
    """
    mesh = quarter_mesh(impact, element_size=element_size, patch=patch)
    return solve_on(mesh, impact, **options)


def solve_on(
    mesh: Mesh,
    impact: Impact,
    *,
    duration: float,
    time_step: float = TIME_STEP,
    penalty: float = PENALTY,
    threads: int = 1,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Solve one impact on `mesh` with Kratos Multiphysics; strains and rotations are small.

    duration, time_step: in s. penalty: of the contact in N/m3, pressure over penetration.
    threads: they pay on an idle machine only. progress: called after each step with the simulated
    time (s) and the share done.

    Returns a Dataset with the names of impactlab.fem3d: histories on `time` (one per step),
    responses (NaN where the run ends before they do), and plastic strains on `element`;
    `iterations` are Newton's. A run that was interrupted by Ctrl-C, or in which a step did not
    converge, gives what it has computed until then, and the attribute `stopped` says why.

    Raises KratosMissingError when Kratos is not installed; ValueError when a number is not valid or
    a material has kinematic hardening; and PatchTooSmallError (a ValueError) when the contact
    leaves the patch of matched nodes.
    """
    for name, value in (("duration", duration), ("time_step", time_step), ("penalty", penalty)):
        positive("solve", name, value)
    kratos = engine(integer("solve", "threads", threads, 1))
    run = Run(kratos, mesh, impact, duration=duration, time_step=time_step, penalty=penalty)
    run.go(progress)
    return to_dataset(run, impact, time_step, penalty)


_OWN = {
    "iterations": ("1", "Newton's iterations in a step"),
    "equivalent_plastic_strain": ("1", "equivalent plastic strain (PEEQ), mean of the element"),
    "largest_equivalent_plastic_strain": ("1", "largest PEEQ of an element's integration points"),
    "body": ("1", "0: of the beam, 1: of the sphere"),
    "time_step": ("s", "time step"),
    "penalty": ("N m-3", "pressure over penetration in the contact"),
    "element_size": ("m", "size of the elements about the contact"),
    "cpu_seconds": ("s", "processor time"),
}
"""Units and long_name of variables that impactlab.variables does not have."""
_RESPONSES = (
    *("peak_force", "time_of_peak_force", "contact_duration", "number_of_contacts"),
    *("maximum_indentation", "permanent_indentation", "maximum_deflection"),
)
"""Responses of the histories that take no energies and no forces between the steps."""


def to_dataset(run: Run, impact: Impact, time_step: float, penalty: float) -> xr.Dataset:
    """Return all answers of a run, as described in solve_on."""
    strain = plastic_strains(run.engine, run.part)
    largest = strain.max(axis=1)
    # A contact that pauses for less than two steps is one.
    answers, _ = history_responses(run.history, 2.0 * time_step)
    dataset = xr.Dataset(
        {
            **{name: answers[name] for name in _RESPONSES},
            **plastic_responses(run.mesh, impact, largest),
            "cpu_seconds": run.cpu_seconds,
            **{name: ("time", values) for name, values in histories(run.history).items()},
            "iterations": ("time", run.iterations),
            "equivalent_plastic_strain": ("element", strain.mean(axis=1)),
            "largest_equivalent_plastic_strain": ("element", largest),
        },
        coords={
            "time": run.history.table()[0],
            "body": ("element", run.mesh.body),
            "velocity": impact.velocity,
            "time_step": time_step,
            "penalty": penalty,
            "element_size": run.mesh.element_size,
        },
        attrs=provenance() | {"model": f"Kratos Multiphysics {run.engine.version}"},
    )
    if run.history.stopped:
        dataset.attrs["stopped"] = run.history.stopped
    return named(dataset, _OWN)


_HALVINGS = 5
"""Number of times that a step is cut in half if it does not converge."""


class Run:
    """An impact on a mesh in Kratos.

    history: at the start and at the end of each step so far, velocities included. iterations:
    Newton's, in each.
    """

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
        self.history = History([Moment(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, impact.velocity)])
        self.iterations, self.cpu_seconds = [0.0], 0.0
        model = engine.core.Model()
        self.part = model.CreateModelPart(PART)
        self.part.ProcessInfo[engine.variable("DOMAIN_SIZE")] = 3
        parameters = engine.core.Parameters(settings(duration, time_step, penalty))
        self._analysis = engine.analysis(model, parameters)
        fill(engine, self.part, mesh, impact)
        self._analysis.Initialize()
        hold(engine, self.part, mesh)
        launch(engine, self.part, mesh, impact)
        mass = nodal_masses(mesh, impact)
        mass[np.setdiff1d(np.arange(mass.size), mesh.elements[mesh.body == SPHERE])] = 0.0
        self._sphere = mass / mass.sum()  # each node's share

    def go(self, progress: Progress | None) -> None:
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
        self.cpu_seconds = time.process_time() - self._started

    def _take(self) -> None:
        """Take one step, or as much of it as converges; the following steps take the rest."""
        analysis, before = self._analysis, self._analysis.time
        analysis.time = analysis._GetSolver().AdvanceInTime(before)
        for _ in range(1 + _HALVINGS):
            analysis.InitializeSolutionStep()
            if analysis.SolveSolutionStep() or self._balanced():
                analysis.FinalizeSolutionStep()
                self._keep()
                return
            analysis.time = 0.5 * (before + analysis.time)
            # Back to where the step began.
            self.part.OverwriteSolutionStepData(1, 0)
            self.part.ReduceTimeStep(self.part, analysis.time)
            displacement = self.engine.variable("DISPLACEMENT")
            self.engine.core.VariableUtils().UpdateCurrentPosition(self.part.Nodes, displacement)
        self.history.stopped = f"Newton's iterations did not converge after {before:.4g} s"

    def _balanced(self) -> bool:
        """Return whether forces balance although Kratos' set of touching nodes does not settle.

        A node that barely touches may change sides with each iteration, and no force with it.
        """
        ratio = self.part.ProcessInfo[self.engine.variable("CONVERGENCE_RATIO")]
        return bool(ratio <= RESIDUAL_RATIO)

    def _keep(self) -> None:
        """Add this step to the history, unless its contact has left the patch."""
        mesh = self.mesh
        down = -vectors(self.engine, self.part, "DISPLACEMENT")[:, 2]
        speed = -vectors(self.engine, self.part, "VELOCITY")[:, 2]
        upper, lower = mesh.pairs[mesh.rim].T
        if np.any(mesh.gaps[mesh.rim] < down[upper] - down[lower]):
            raise PatchTooSmallError(
                f"the contact reaches the rim of the patch of matched nodes: patch must be above "
                f"{mesh.patch:.4g} m",
                mesh.patch,
            )
        moment = Moment(
            time=self._analysis.time,
            force=contact_force(self.engine, self.part),
            sphere=float(self._sphere @ down),
            pole=float(down[mesh.pole]),
            axis=float(down[mesh.axis_node]),
            top=float(down[mesh.top_node]),
            velocity=float(self._sphere @ speed),
        )
        self.history.moments.append(moment)
        iterations = self.engine.variable("NL_ITERATION_NUMBER")
        self.iterations.append(float(self.part.ProcessInfo[iterations]))
