"""Figures of a 3-D run on its mesh: the mesh itself, and the plastic strain about the contact."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from numpy.typing import NDArray

from impactlab.figures import labels, scales, style

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

BEAM, SPHERE = 0, 1
"""Values of `body`."""
_FACES = np.array(
    [(0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
)
"""Corners of a hexahedron's faces, in VTK's order."""
_FLAT = 1e-6
"""Distance from the plane, over the element size, that counts as zero."""


def faces(solid: xr.Dataset, axis: int) -> tuple[Floats, Integers]:
    """Return the faces in the plane through the origin across `axis` (0, 1, 2: x, y, z).

    Returns their corners in mm, (faces, 4, 2), in the other two axes, and the number of the
    element that each belongs to, (faces,).
    """
    nodes, elements = solid["node_position"].values, solid["element_nodes"].values
    corners = elements[:, _FACES]
    near = np.abs(nodes[corners, axis]) < _FLAT * float(solid["element_size"])
    element, face = np.nonzero(near.all(axis=2))
    places = nodes[corners[element, face]]
    return 1e3 * np.delete(places, axis, axis=2), element


def _draw_faces(ax: Axes, polygons: Floats, **looks: Any) -> PolyCollection:
    """Draw polygons on axes of equal scale; the caller sets the limits."""
    drawn = PolyCollection(list(polygons), **looks)
    ax.add_collection(drawn)
    ax.set_aspect("equal")
    ax.grid(visible=False)
    return drawn


MESH_TITLE = "Mesh of the 3-D FE model"
_COLOURS = {"beam": "#DCE9F2", "sphere": "#F7E3D4", "fully integrated": "#9CC4DD"}
_EDGE = "0.25"
_ENLARGED = 3.0
"""Sides of the enlarged views over half the side of the matched patch."""


def mesh_caption(solid: xr.Dataset, beams: xr.Dataset) -> str:
    """Return the caption: number and size of elements, and the views."""
    size, patch = 1e3 * float(solid["element_size"]), 1e3 * float(solid["patch"])
    return (
        f"The quarter model: {int(solid['number_of_elements']):,} hexahedra, "
        f"{labels.number(size)} mm about the contact. Above, the plane of symmetry along the beam; "
        "below, the same about the contact, and the beam's top face. Within "
        f"{labels.number(patch)} mm (framed) the nodes of sphere and beam lie above each other; "
        "the elements of the darker colour are fully integrated, the others have one point."
    )


@style.paper
def plot_mesh(solid: xr.Dataset, beams: xr.Dataset) -> Figure:
    """Draw the side view above, and the contact from the side and from above below it."""
    figure = Figure(figsize=(style.DOUBLE * style.MILLIMETRE, 125 * style.MILLIMETRE))
    figure.set_layout_engine("constrained")
    grid = figure.add_gridspec(2, 2, height_ratios=[1.0, 1.5])
    above = figure.add_subplot(grid[0, :])
    side, top = figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1])
    reach = _ENLARGED * 1e3 * float(solid["patch"])
    _draw_mesh(above, solid, 1, width=min(0.15, 0.15e3 * float(solid["element_size"])))
    _draw_mesh(side, solid, 1, width=0.4)
    _draw_mesh(top, solid, 2, width=0.4)
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


def _draw_mesh(ax: Axes, solid: xr.Dataset, axis: int, width: float) -> None:
    """Draw the faces in a plane: of both bodies, or of the beam where they touch."""
    polygons, elements = faces(solid, axis)
    body = solid["body"].values[elements]
    colours = np.where(body == BEAM, _COLOURS["beam"], _COLOURS["sphere"])
    full = solid["fully_integrated"].values[elements]
    colours = np.where(full, _COLOURS["fully integrated"], colours)
    shown = slice(None) if axis == 1 else body == BEAM
    _draw_faces(ax, polygons[shown], facecolors=colours[shown], edgecolors=_EDGE, linewidths=width)


def _frame(ax: Axes, solid: xr.Dataset, sides: tuple[float, float], low: float) -> None:
    """Draw the patch of matched nodes."""
    patch = 1e3 * float(solid["patch"])
    width, height = (patch * side for side in sides)
    ax.add_patch(
        Rectangle((0.0, low * patch), width, height, fill=False, color=style.COLOURS[1], zorder=3)
    )


STRAIN_TITLE = "Plastic strain about the contact"
THRESHOLD = 1e-5
"""PEEQ from which on an element counts as plastic."""
_STRAIN = "equivalent_plastic_strain"
_NONE = "0.94"
_REACH = 1.6
"""Sides of the view over half the side of the matched patch, or the plastic zone below it."""


def strain_caption(solid: xr.Dataset, beams: xr.Dataset) -> str:
    """Return the caption: the extent of the plastic zone, and what does not converge."""
    polygons, elements = faces(solid, 1)
    plastic = _plastic(solid, elements)
    reach = (
        f"In this plane it reaches {labels.number(float(polygons[plastic, :, 0].max()), 3)} mm "
        f"from mid-span and {labels.number(-float(polygons[plastic, :, 1].min()), 3)} mm deep. "
        if plastic.any()
        else "There is none. "
    )
    return (
        "Equivalent plastic strain (PEEQ) of the elements in the plane of symmetry along the beam, "
        "means over each, at the end of the run; grey: below "
        f"{labels.number(100 * THRESHOLD)} %. {reach}The largest strain grows with finer elements."
    )


@style.paper
def plot_strain(solid: xr.Dataset, beams: xr.Dataset) -> Figure:
    """Draw the elements coloured by strain, the sphere above the beam."""
    figure = Figure(figsize=(style.SINGLE * style.MILLIMETRE, 68 * style.MILLIMETRE))
    figure.set_layout_engine("constrained")
    ax = figure.add_subplot()
    polygons, elements = faces(solid, 1)
    strain = 100.0 * solid[_STRAIN].values[elements]
    plastic = _plastic(solid, elements)
    _draw_faces(ax, polygons[~plastic], facecolors=_NONE, edgecolors="0.75", linewidths=0.3)
    reach = _REACH * max(1e3 * float(solid["patch"]), _extent(solid, polygons[plastic]))
    ax.set(xlim=(0.0, reach), ylim=(-0.75 * reach, 0.25 * reach))
    ax.set_title(STRAIN_TITLE, loc="left")
    ax.set(xlabel=labels.axis("from mid-span", "mm"), ylabel=labels.axis("height", "mm"))
    scales.linear(ax, "x")
    scales.linear(ax, "y")
    if plastic.any():
        shown = _draw_faces(ax, polygons[plastic], edgecolors="0.75", linewidths=0.3)
        shown.set(array=strain[plastic], cmap="viridis", norm=Normalize(0.0, strain.max()))
        figure.colorbar(shown, ax=ax, label=labels.axis("PEEQ", "%"), shrink=0.9)
    else:
        ax.text(0.5, 0.05, "no plastic strain", transform=ax.transAxes, ha="center")
    return figure


def _plastic(solid: xr.Dataset, elements: Integers) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    return np.asarray(solid[_STRAIN].values[elements] >= THRESHOLD)


def _extent(solid: xr.Dataset, plastic: Floats) -> float:
    """Return the extent of the plastic zone in mm, at most half the beam's depth."""
    if not plastic.size:
        return 0.0
    return min(float(np.abs(plastic).max()), 0.5e3 * float(solid["beam_depth"]))
