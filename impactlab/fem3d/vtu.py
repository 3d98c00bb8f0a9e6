"""Fields on a mesh as VTU, which ParaView, PyVista and meshio open."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import xarray as xr
from pyevtk.hl import unstructuredGridToVTK
from pyevtk.vtk import VtkHexahedron

from impactlab.study.netcdf import whole

Array = np.ndarray[Any, Any]


def write_vtu(dataset: xr.Dataset, path: Path) -> None:
    """Write a 3-D model's mesh with all its fields; all of it or nothing, under the same names.

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
        whole(path, dataset.nbytes) as unfinished,
        TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder,
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
    """VTK has no truth values."""
    return values.astype(np.int8) if values.dtype == bool else np.ascontiguousarray(values)
