"""A 3-D run beside the beam models: solved, compared, written to files and drawn."""

from __future__ import annotations

import csv
import tempfile
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from pyevtk.hl import unstructuredGridToVTK
from pyevtk.vtk import VtkHexahedron

from impactlab.fem3d.comparison.comparison import compared, simulate_beams
from impactlab.fem3d.comparison.plan import Plan
from impactlab.fem3d.figures.run import draw_witness
from impactlab.fem3d.solver import solve_on
from impactlab.files import replaced
from impactlab.study.netcdf import read_netcdf, write_netcdf
from impactlab.variables import reasons

Array = np.ndarray[Any, Any]
Progress = Callable[[float, float], None]
"""Called with the simulated time in s and the share done; see solve_on."""

_NUMBER = 8
"""Bytes of a number."""
_HEAD = ("response", "units", "model", "value", "difference_percent", "missing_because")


@dataclass(frozen=True)
class Comparison:
    """Answers of one case.

    solid: of fem3d.solver. beams: of the beam models. responses: of both, see compared. folder:
    where they lie.
    """

    solid: xr.Dataset
    beams: xr.Dataset
    responses: xr.Dataset
    folder: Path


def compare(
    plan: Plan,
    folder: Path,
    *,
    workers: int = 1,
    watched: AbstractContextManager[Progress | None] | None = None,
) -> Comparison:
    """Solve a planned case by the 3-D FE model and the beam models; write and draw the answers.

    folder: gets witness.nc, witness.vtu, beams.nc, comparison.csv and figures/. If the 3-D run
    stopped before its end, and the folder holds a complete run, FOLDER_stopped gets them instead.
    workers: number of threads. watched: is entered around the 3-D run, and gives its `progress`.
    Answers are on disk before anything is made of them.

    Raises OSError where the folder cannot be written to, before anything is solved.
    """
    check_writable(folder)
    spare = folder.parent / f"{folder.resolve().name}_stopped"
    complete = _is_complete(folder / "witness.nc")
    with watched or nullcontext() as progress:
        solid = solve_on(
            plan.solved_mesh(),
            plan.case.impact,
            duration=plan.duration,
            threads=workers,
            progress=progress,
        )
    if "stopped" in solid.attrs and complete:
        folder = spare
    write_netcdf(solid, folder / "witness.nc")
    write_vtu(solid, folder / "witness.vtu")
    beams = simulate_beams(plan.case.impact, plan.case.discretisation, float(solid["duration"]))
    write_netcdf(beams, folder / "beams.nc")
    responses = compared(solid, beams)
    write_csv(responses, folder / "comparison.csv")
    draw_witness(solid, beams, folder / "figures", plan.case.name)
    return Comparison(solid, beams, responses, folder)


def check_writable(folder: Path) -> None:
    """Make the folder if needed. Raises OSError where answers could not be kept."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise OSError(
            f"--output {folder}: {error.strerror}: nothing was solved; name a folder to write to"
        ) from None


def _is_complete(file: Path) -> bool:
    """Return whether a file holds a run that reached its end; an unreadable one does not."""
    try:
        return "stopped" not in read_netcdf(file).attrs
    except OSError:
        return False


def write_csv(found: xr.Dataset, path: Path) -> None:
    """Write one row per response and model, in SI units; whole or not at all (see whole)."""
    with (
        replaced(path, found["value"].size * len(_HEAD) * _NUMBER) as unfinished,
        unfinished.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(_HEAD)
        for at in np.ndindex(found["value"].shape):
            writer.writerow(_row(found.isel(response=at[0], model=at[1])))


def _row(one: xr.Dataset) -> list[str]:
    value, difference = one["value"].item(), one["difference"].item()
    why = "; ".join(reasons(one["status"].item())) if np.isnan(value) else ""
    name, units, model = (str(one[key].item()) for key in ("response", "units", "model"))
    share = "" if np.isnan(difference) else f"{100.0 * difference:.6g}"
    return [name, units, model, "" if np.isnan(value) else f"{value:.9g}", share, why]


def write_vtu(dataset: xr.Dataset, path: Path) -> None:
    """Write a 3-D FE model's mesh with all its fields; all of it or nothing, under the same names.

    dataset: of fem3d.solver. What lies on `element` becomes cell data, what lies on `node` and
    `axis` vectors of the points, in SI units; points are where they were at first touch.
    Raises OSError: see whole.
    """
    elements = dataset["element_nodes"].values
    cells = {name: _plain(dataset[name].values) for name in _on(dataset, ("element",))}
    points = {name: _columns(dataset[name].values) for name in _on(dataset, ("node", "axis"))}
    place = points.pop("node_position")
    count = len(elements)
    with (
        replaced(path, dataset.nbytes) as unfinished,
        tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder,
    ):
        written = unstructuredGridToVTK(
            f"{folder}/mesh",
            *place,
            connectivity=np.ascontiguousarray(elements.ravel()),
            offsets=8 * np.arange(1, count + 1, dtype=np.int64),
            cell_types=np.full(count, VtkHexahedron.tid, dtype=np.uint8),
            cellData=cells,
            pointData=points,
        )
        Path(written).replace(unfinished)


def _on(dataset: xr.Dataset, dims: tuple[str, ...]) -> list[str]:
    return [str(name) for name, values in dataset.variables.items() if values.dims == dims]


def _columns(vectors: Array) -> tuple[Array, ...]:
    return tuple(np.ascontiguousarray(column) for column in vectors.T)


def _plain(values: Array) -> Array:
    """Return the values without booleans, which VTK does not have."""
    return values.astype(np.int8) if values.dtype == bool else np.ascontiguousarray(values)
