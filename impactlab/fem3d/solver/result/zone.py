"""How far plastic flow reaches along the struck surface."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.fem3d.solver.mesh.mesh import BEAM

LIMIT = 0.002
"""PEEQ at the border of the zone: the strain of the usual proof stress."""


def surface_reach(run: xr.Dataset, limit: float = LIMIT) -> float:
    """Distance in m from the centre of the impact, along the beam, to where PEEQ falls to `limit`.

    run: as solve gives it. On the struck surface at mid-width, in the shape before the impact: the
    outermost place where the line through the means of the top elements comes down to the limit; 0
    where none is above it.
    """
    points = run["node_position"].values[run["element_nodes"].values]
    edge = 1e-6 * float(run["element_size"])
    top = (run["body"].values == BEAM) & (points[:, :, 2].max(axis=1) > -edge)
    row = top & (points[:, :, 1].min(axis=1) < edge)
    x = points[row, :, 0].mean(axis=1)
    order = np.argsort(x)
    x, strain = x[order], run["equivalent_plastic_strain"].values[row][order]
    above = np.flatnonzero(strain > limit)
    if not above.size:
        return 0.0
    last = int(above[-1])
    if last + 1 == x.size:
        return float(x[last])
    share = (strain[last] - limit) / (strain[last] - strain[last + 1])
    return float(x[last] + share * (x[last + 1] - x[last]))
