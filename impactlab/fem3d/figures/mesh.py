"""The mesh: the whole quarter from the side, and the contact enlarged."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from impactlab.fem3d.figures import planes
from impactlab.figures import labels, scales, style

TITLE = "Mesh of the 3-D model"
_COLOURS = {"beam": "#DCE9F2", "sphere": "#F7E3D4", "fully integrated": "#9CC4DD"}
_EDGE = "0.25"
_ENLARGED = 3.0
"""Sides of the enlarged views over half the side of the matched patch."""


def caption(solid: xr.Dataset, beams: xr.Dataset) -> str:
    """How many elements, how large, and which views."""
    size, patch = 1e3 * float(solid["element_size"]), 1e3 * float(solid["patch"])
    return (
        f"The quarter model: {int(solid['number_of_elements']):,} hexahedra, "
        f"{labels.number(size)} mm about the contact. Above, the plane of symmetry along the beam; "
        "below, the same about the contact, and the beam's top face. Within "
        f"{labels.number(patch)} mm (framed) the nodes of sphere and beam lie above each other; the "
        "elements of the darker colour are fully integrated, the others have one point."
    )


@style.paper
def plot(solid: xr.Dataset, beams: xr.Dataset) -> Figure:
    """Side view above, the contact from the side and from above below."""
    figure = Figure(figsize=(style.DOUBLE * style.MILLIMETRE, 125 * style.MILLIMETRE))
    figure.set_layout_engine("constrained")
    grid = figure.add_gridspec(2, 2, height_ratios=[1.0, 1.5])
    above = figure.add_subplot(grid[0, :])
    side, top = figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1])
    reach = _ENLARGED * 1e3 * float(solid["patch"])
    _draw(above, solid, 1, width=min(0.15, 0.15e3 * float(solid["element_size"])))
    _draw(side, solid, 1, width=0.4)
    _draw(top, solid, 2, width=0.4)
    above.autoscale_view()
    above.margins(0.01)
    side.set_anchor("E")  # close to each other, though squares
    top.set_anchor("W")
    side.set(xlim=(0.0, reach), ylim=(-0.6 * reach, 0.4 * reach))
    top.set(xlim=(0.0, reach), ylim=(0.0, reach))
    _frame(side, solid, (1.0, 2.0), -1.0)
    _frame(top, solid, (1.0, 1.0), 0.0)
    for ax, title, label in (
        (above, "Plane of symmetry along the beam", "height"),
        (side, "The same at the contact", "height"),
        (top, "Top of the beam", "from mid-width"),
    ):
        ax.set(xlabel=labels.axis("from mid-span", "mm"), ylabel=labels.axis(label, "mm"))
        ax.set_title(title, loc="left")
        scales.linear(ax, "x")
        scales.linear(ax, "y")
    figure.legend(
        handles=[Patch(facecolor=c, edgecolor=_EDGE, label=n) for n, c in _COLOURS.items()],
        loc="outside upper center",
        ncols=len(_COLOURS),
    )
    return figure


def _draw(ax: Axes, solid: xr.Dataset, axis: int, width: float) -> None:
    """The faces in a plane: both bodies' where it cuts them, the beam's alone where they touch."""
    polygons, elements = planes.faces(solid, axis)
    body = solid["body"].values[elements]
    colours = np.where(body == planes.BEAM, _COLOURS["beam"], _COLOURS["sphere"])
    full = solid["fully_integrated"].values[elements]
    colours = np.where(full, _COLOURS["fully integrated"], colours)
    shown = slice(None) if axis == 1 else body == planes.BEAM
    planes.draw(ax, polygons[shown], facecolors=colours[shown], edgecolors=_EDGE, linewidths=width)


def _frame(ax: Axes, solid: xr.Dataset, sides: tuple[float, float], low: float) -> None:
    """The patch of matched nodes."""
    patch = 1e3 * float(solid["patch"])
    width, height = (patch * side for side in sides)
    ax.add_patch(
        Rectangle((0.0, low * patch), width, height, fill=False, color=style.COLOURS[1], zorder=3)
    )
