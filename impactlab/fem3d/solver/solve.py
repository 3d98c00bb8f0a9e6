"""The door to the 3-D model: one impact on one mesh, and everything that it answers."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from impactlab.fem3d.solver.mesh import Mesh, quarter_mesh
from impactlab.fem3d.solver.result.dataset import to_dataset
from impactlab.fem3d.solver.stepping.march import March
from impactlab.fem3d.solver.stepping.parts import Parts
from impactlab.fem3d.solver.stepping.system import System
from impactlab.model.checks import integer, positive
from impactlab.model.impact import Impact

if TYPE_CHECKING:
    import xarray as xr


def solve(
    impact: Impact,
    *,
    element_size: float,
    duration: float,
    patch: float | None = None,
    samples: int = 2001,
    threads: int = 1,
    progress: Callable[[float, float], None] | None = None,
) -> xr.Dataset:
    """Solve one impact on the mesh that quarter_mesh makes of element_size and patch (m).

    The rest, and what is returned and raised, as in solve_on.
    """
    mesh = quarter_mesh(impact, element_size=element_size, patch=patch)
    return solve_on(
        mesh, impact, duration=duration, samples=samples, threads=threads, progress=progress
    )


def solve_on(
    mesh: Mesh,
    impact: Impact,
    *,
    duration: float,
    samples: int = 2001,
    threads: int = 1,
    progress: Callable[[float, float], None] | None = None,
) -> xr.Dataset:
    """Solve one impact on `mesh`; contact law and model of the beam in `impact` play no part.

    duration: simulated time in s. samples: length of `time`, equally spaced. threads: the answers
    are the same to the last bit for any number. progress: called a hundred times a run with the
    simulated time (s) and the share done.

    Returns a Dataset with the histories and responses of impactlab.variables that a 3-D model has
    (`status` says why one is NaN), energies on `checkpoint`, plastic strains and von Mises stress
    on `element`, displacements on `node`, and the mesh as coordinates. A run interrupted by
    Ctrl-C, or stopped because it diverged, its elements were squeezed flat, or the contact left the
    patch of matched nodes, gives what it has computed until then, and the attribute `stopped` says
    why; `patch_needed` is the patch to take, in m.

    Raises ValueError when a number is not valid or the duration below a time step.
    """
    positive("solve", "duration", duration)
    samples = integer("solve", "samples", samples, 2)
    with Parts(integer("solve", "threads", threads, 1)) as parts:
        system = System(mesh, impact, parts)
        history = March(system, impact).run(duration, progress)
    return to_dataset(system, impact, history, samples)
