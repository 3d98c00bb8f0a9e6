"""The door to Kratos: one impact on one mesh, and what it answers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from impactlab.fem3d.kratos.engine import engine
from impactlab.fem3d.kratos.result import to_dataset
from impactlab.fem3d.kratos.run import Progress, Run
from impactlab.fem3d.solver import Mesh, quarter_mesh
from impactlab.model.checks import integer, positive
from impactlab.model.impact import Impact

if TYPE_CHECKING:
    import xarray as xr

TIME_STEP, PENALTY = 8e-6, 1e15
"""s, and N/m3 (1e6 N/mm3)."""


def solve(
    impact: Impact,
    *,
    element_size: float,
    duration: float,
    patch: float | None = None,
    time_step: float = TIME_STEP,
    penalty: float = PENALTY,
    threads: int = 1,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Solve one impact on the mesh that quarter_mesh makes of element_size and patch (m).

    The rest, and what is returned and raised, as in solve_on.
    """
    return solve_on(
        quarter_mesh(impact, element_size=element_size, patch=patch),
        impact,
        duration=duration,
        time_step=time_step,
        penalty=penalty,
        threads=threads,
        progress=progress,
    )


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

    Returns a Dataset with the names of impactlab.fem3d: histories on `time` (one a step),
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
