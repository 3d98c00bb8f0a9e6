"""One impact on one mesh, solved by Kratos and returned as a dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from impactlab.fem3d.kratos.engine import engine
from impactlab.fem3d.kratos.model_part import plastic_strains
from impactlab.fem3d.kratos.run import Progress, Run
from impactlab.fem3d.solver import Mesh, quarter_mesh
from impactlab.fem3d.solver.mesh.mesh import Floats
from impactlab.fem3d.solver.responses import contacts, peak, plastic_responses
from impactlab.model.checks import integer, positive
from impactlab.model.impact import Impact
from impactlab.variables import described, provenance

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


def to_dataset(run: Run, impact: Impact, time_step: float, penalty: float) -> xr.Dataset:
    """Return all answers of a run, as described in solve_on."""
    strain = plastic_strains(run.engine, run.part)
    largest = strain.max(axis=1)
    answers = _responses(run.history.table(), time_step)
    answers |= plastic_responses(run.mesh, impact, largest)
    answers["cpu_seconds"] = run.history.cpu_seconds
    dataset = xr.Dataset(
        {
            **{name: ((), value) for name, value in answers.items()},
            **_histories(run.history.table()),
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
    return _named(dataset)


def _responses(table: Floats, time_step: float) -> dict[str, float]:
    """Return responses by name, NaN where the run ends before they are known.

    A contact that pauses for less than two steps is one.
    """
    time, force, sphere, pole, axis, top, _, _ = table
    touches = contacts(time, force, 2.0 * time_step)
    at, largest = peak(time, force)
    indented_at, indentation = peak(time, sphere - axis)
    deflected_at, deflection = peak(time, axis)
    first = touches[0] if len(touches) else np.full(2, np.nan)
    end = touches[-1, 1] if len(touches) else np.nan
    after = time > end
    dent = (top - axis) + (sphere - pole)
    growing = indented_at >= time[-1]
    return {
        "peak_force": np.nan if growing else largest,
        "time_of_peak_force": np.nan if growing else at,
        "contact_duration": float(first[1] - first[0]),
        "number_of_contacts": float(len(touches)),
        "maximum_indentation": np.nan if growing else indentation,
        "permanent_indentation": float(dent[after].mean()) if after.any() else np.nan,
        "maximum_deflection": np.nan if deflected_at >= time[-1] else deflection,
    }


def _histories(table: Floats) -> dict[str, Any]:
    _, force, sphere, _, axis, _, _, iterations = table
    given = {
        "contact_force": force,
        "midspan_deflection": axis,
        "sphere_displacement": sphere,
        "indentation": sphere - axis,
        "iterations": iterations,
    }
    return {name: ("time", values) for name, values in given.items()}


def _named(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset with attributes on all variables."""
    dataset = described(dataset)
    for name, (units, long_name) in _OWN.items():
        dataset[name].attrs |= {"units": units, "long_name": long_name}
    return dataset
