"""Figures of a 3-D run: mesh, plastic strain about the contact, histories, and a moving picture."""

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from numpy.typing import NDArray

from impactlab.fem3d.solver.evaluation import PLASTIC_ZONE_STRAIN
from impactlab.fem3d.solver.mesh import BEAM, plane_faces
from impactlab.figures import labels, record, scales, style
from impactlab.figures.animation import DPI, SIZE, Animation, Part, composed, force_panel
from impactlab.figures.draw import draw
from impactlab.figures.labels import display
from impactlab.solver.contact import CONTACT_LAWS
from impactlab.types import Floats


def faces(solid: xr.Dataset, axis: int) -> tuple[Floats, NDArray[np.int64]]:
    """Return the faces in the plane through the origin across `axis` (0, 1, 2: x, y, z).

    Returns their corners in mm, (faces, 4, 2), in the other two axes, and the number of the
    element that each belongs to, (faces,).
    """
    nodes, elements = solid["node_position"].values, solid["element_nodes"].values
    element, corners = plane_faces(nodes, elements, axis, float(solid["element_size"]))
    return 1e3 * np.delete(nodes[corners], axis, axis=2), element


def _draw_faces(ax: Axes, polygons: Floats, across: str = "height", **looks: Any) -> PolyCollection:
    """Draw polygons on axes of equal scale in mm; the caller sets the limits."""
    collection = PolyCollection(list(polygons), **looks)
    ax.add_collection(collection)
    ax.set_aspect("equal")
    ax.grid(visible=False)
    ax.set(xlabel=labels.axis("from the impact", "mm"), ylabel=labels.axis(across, "mm"))
    scales.linear(ax, "xy")
    return collection


def _left(solid: xr.Dataset, reach: float) -> float:
    """Return where a picture of the contact begins that ends at `reach`."""
    return 0.0 if int(solid["copies"]) == 4 else -reach


_COLOURS = {"beam": "#DCE9F2", "sphere": "#F7E3D4", "fully integrated": "#9CC4DD"}
_EDGE = "0.25"


def _mesh_sentences(solid: xr.Dataset, beams: xr.Dataset) -> tuple[str]:
    size, patch = 1e3 * float(solid["element_size"]), 1e3 * float(solid["patch"])
    part = "quarter" if int(solid["copies"]) == 4 else "half"
    return (
        f"The {part} model: {int(solid['number_of_elements']):,} hexahedra, "
        f"{labels.number(size)} mm about the contact. Above, the plane of symmetry along the beam; "
        "below, the same about the contact, and the beam's top face. Within "
        f"{labels.number(patch)} mm (framed) the nodes of sphere and beam lie above each other; "
        "the elements of the darker colour are fully integrated, the others have one point.",
    )


@record.figure("Mesh of the 3-D FE model", "", lambda solid, beams: True, _mesh_sentences)
def mesh(solid: xr.Dataset, beams: xr.Dataset) -> Figure:
    """Draw the side view above, and the contact from the side and from above below it."""
    size = style.DOUBLE * style.MILLIMETRE, 125 * style.MILLIMETRE
    figure = Figure(figsize=size, layout="constrained")
    grid = figure.add_gridspec(2, 2, height_ratios=[1.0, 1.5])
    patch = 1e3 * float(solid["patch"])
    thin, reach = min(0.15, 0.15e3 * float(solid["element_size"])), 3.0 * patch
    axes = []
    for place, axis, width, title, label in (
        (grid[0, :], 1, thin, "Plane of symmetry along the beam", "height"),
        (grid[1, 0], 1, 0.4, "The same at the contact", "height"),
        (grid[1, 1], 2, 0.4, "Top of the beam", "from mid-width"),
    ):
        ax = figure.add_subplot(place)
        polygons, elements = faces(solid, axis)
        body = solid["body"].values[elements]
        colours = np.where(body == BEAM, _COLOURS["beam"], _COLOURS["sphere"])
        full = solid["fully_integrated"].values[elements]
        colours = np.where(full, _COLOURS["fully integrated"], colours)
        shown = slice(None) if axis == 1 else body == BEAM
        look: dict[str, Any] = {"edgecolors": _EDGE, "linewidths": width}
        _draw_faces(ax, polygons[shown], label, facecolors=colours[shown], **look)
        ax.set_title(title, loc="left")
        axes.append(ax)
    above, side, top = axes
    above.autoscale_view()
    above.margins(0.01)
    side.set_anchor("E")  # close to each other, though squares
    top.set_anchor("W")
    left = _left(solid, reach)
    side.set(xlim=(left, reach), ylim=(-0.6 * reach, 0.4 * reach))
    top.set(xlim=(left, reach), ylim=(0.0, reach))
    for ax, low in ((side, -patch), (top, 0.0)):  # the patch of matched nodes
        look = {"fill": False, "color": style.COLOURS[1], "zorder": 3}
        start = _left(solid, patch)
        ax.add_patch(Rectangle((start, low), patch - start, patch - low, **look))
    figure.legend(
        handles=[Patch(facecolor=c, edgecolor=_EDGE, label=n) for n, c in _COLOURS.items()],
        loc="outside upper center",
        ncols=len(_COLOURS),
    )
    return figure


_STRAIN = "equivalent_plastic_strain"


def _strain_sentences(solid: xr.Dataset, beams: xr.Dataset) -> tuple[str]:
    polygons, elements = faces(solid, 1)
    plastic = solid[_STRAIN].values[elements] >= PLASTIC_ZONE_STRAIN
    along = float(np.abs(polygons[plastic, :, 0]).max(initial=0.0))
    reach = (
        f"In this plane it reaches {labels.number(along, 3)} mm "
        f"from the impact and {labels.number(-float(polygons[plastic, :, 1].min()), 3)} mm deep. "
        if plastic.any()
        else "There is none. "
    )
    return (
        "Equivalent plastic strain (PEEQ) of the elements in the plane of symmetry along the beam, "
        "means over each, at the end of the run; grey: below "
        f"{labels.number(100 * PLASTIC_ZONE_STRAIN)} %. {reach}The largest strain grows with finer "
        "elements.",
    )


@record.figure("Plastic strain about the contact", "", lambda solid, beams: True, _strain_sentences)
def plastic_strain(solid: xr.Dataset, beams: xr.Dataset) -> Figure:
    """Draw the elements coloured by strain, the sphere above the beam."""
    figure, (ax,) = style.panels(1, columns=1, height=68)
    polygons, elements = faces(solid, 1)
    strain = solid[_STRAIN].values[elements]
    plastic = strain >= PLASTIC_ZONE_STRAIN
    _draw_faces(ax, polygons[~plastic], facecolors="0.94", edgecolors="0.75", linewidths=0.3)
    extent = np.abs(polygons[plastic]).max(initial=0.0)  # at most half the beam's depth
    extent = min(float(extent), 0.5e3 * float(solid["beam_depth"]))
    reach = 1.6 * max(1e3 * float(solid["patch"]), extent)
    ax.set(xlim=(_left(solid, reach), reach), ylim=(-0.75 * reach, 0.25 * reach))
    ax.set_title(plastic_strain.title, loc="left")
    if plastic.any():
        shown = _draw_faces(ax, polygons[plastic], edgecolors="0.75", linewidths=0.3)
        percent = 100.0 * strain[plastic]
        shown.set(array=percent, cmap="viridis", norm=Normalize(0.0, percent.max()))
        figure.colorbar(shown, ax=ax, label=labels.axis("PEEQ", "%"), shrink=0.9)
    else:
        ax.text(0.5, 0.05, "no plastic strain", transform=ax.transAxes, ha="center")
    return figure


_PANELS = {
    "contact_force": "contact force",
    "midspan_deflection": "deflection under the sphere",
    "indentation": "indentation",
}


def _histories_sentences(solid: xr.Dataset, beams: xr.Dataset) -> tuple[str]:
    velocity = labels.number(float(solid["velocity"]))
    size = labels.number(1e3 * float(solid["element_size"]))
    law = CONTACT_LAWS[str(beams["contact"].item())].title
    return (
        "Contact force, deflection of the beam's axis under the sphere and indentation (approach "
        f"of the sphere's centre of mass and that axis) at {velocity} m/s: of the 3-D FE model "
        f"with elements of {size} mm about the contact, and of beam models with the contact law "
        f"{law}. Downwards is positive.",
    )


@record.figure(
    "The 3-D FE model beside the beam models", "", lambda solid, beams: True, _histories_sentences
)
def histories(solid: xr.Dataset, beams: xr.Dataset) -> Figure:
    """Draw one panel per quantity, one curve per model; the 3-D curve is black, at the bottom."""
    figure, axes = style.panels(len(_PANELS), columns=len(_PANELS), height=55)
    for ax, (name, label) in zip(axes, _PANELS.items(), strict=True):
        time, unit = display(solid["time"]), display(solid[name])
        times = time(solid["time"])
        ax.plot(times, unit(solid[name]), label="3-D", color="black", linewidth=1.8, zorder=2)
        for position, values in enumerate(beams[name].transpose("beam_model", ...)):
            if np.isfinite(values).any():
                ax.plot(
                    time(beams["time"]),
                    unit(values),
                    label=labels.values(beams["beam_model"], [position])[0],
                    zorder=3,
                    color=style.COLOURS[position],
                    linestyle=style.LINES[position],
                )
        scales.linear(ax, "x", ticks=4)
        scales.linear(ax, "y")
        ax.set_xlim(0.0, float(times[-1]))
        ax.set_xlabel(labels.axis("time since first touch", time.symbol))
        ax.set_ylabel(labels.axis(label, unit.symbol))
    style.legend(figure)
    return figure


def draw_witness(solid: xr.Dataset, beams: xr.Dataset, folder: Path, study: str) -> list[Path]:
    """Draw each figure of a 3-D run into `folder`, see figures.draw.draw.

    solid: a dataset of fem3d.solver. beams: the answers of the beam models to the same impact, on
    `beam_model`.
    """
    figures = (histories, plastic_strain, mesh)
    return draw([(figure, (solid, beams)) for figure in figures], folder, study)


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
