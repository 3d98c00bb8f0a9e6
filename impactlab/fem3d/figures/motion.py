"""Moving picture of a 3-D run: the section through the contact, and the contact force."""

from __future__ import annotations

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from impactlab.fem3d.solver.evaluation import PLASTIC_ZONE_STRAIN
from impactlab.figures import labels, scales, style
from impactlab.figures.animation import DPI, SIZE, Animation, Part, composed, force_panel


@style.paper
def animation(solid: xr.Dataset) -> Animation:
    """Return the moving picture of a 3-D run that kept its section on `field_time`."""
    figure = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    section, contact = figure.subplots(2, 1, height_ratios=[2.4, 1.0])
    return composed(figure, solid, [_section(section, solid), force_panel(contact, solid)])


def _section(ax: Axes, solid: xr.Dataset) -> Part:
    """Draw the elements by the contact in the plane along the beam, on both sides of it."""
    corners, strain = 1e3 * solid["section_position"].values, solid["section_plastic_strain"].values
    plastic = np.abs(corners[-1][strain[-1] >= PLASTIC_ZONE_STRAIN]).max(initial=0.0)
    extent = min(float(plastic), 0.5e3 * float(solid["beam_depth"]))
    reach = 1.6 * max(1e3 * float(solid["patch"]), extent)
    near = np.abs(corners).max(axis=(0, 2, 3)) < 2.0 * reach
    polygons, percent = corners[:, near], 100.0 * strain[:, near]
    if int(solid["copies"]) == 4:
        polygons = np.concatenate([polygons, polygons * [-1.0, 1.0]], axis=1)
        percent = np.tile(percent, 2)
    least = 100.0 * PLASTIC_ZONE_STRAIN
    cells = PolyCollection(
        list(polygons[0]),
        edgecolors="0.75",
        linewidths=0.2,
        cmap=matplotlib.colormaps["viridis"].with_extremes(under="0.94"),
        norm=Normalize(least, max(float(percent.max()), 2.0 * least)),
    )
    ax.add_collection(cells)
    ax.set(xlim=(-reach, reach), ylim=(-0.6 * reach, 0.4 * reach), aspect="equal")
    ax.set(xlabel=labels.axis("from the impact", "mm"), ylabel=labels.axis("height", "mm"))
    ax.set_title(f"Equivalent plastic strain (PEEQ); grey: below {least:g} %", loc="left")
    ax.grid(visible=False)
    scales.linear(ax, "xy")
    cells.set_array(percent[0])
    ax.figure.colorbar(cells, ax=ax, label=labels.axis("PEEQ", "%"), pad=0.01)

    def move(frame: int) -> None:
        cells.set_verts(list(polygons[frame]))
        cells.set_array(percent[frame])

    return [cells], move
