"""Equivalent plastic strain about the contact in the plane of symmetry (the paper's figure 9)."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from impactlab.fem3d.figures import planes
from impactlab.figures import labels, scales, style

TITLE = "Plastic strain about the contact"
THRESHOLD = 1e-5
"""PEEQ from which on an element counts as plastic."""
_STRAIN = "equivalent_plastic_strain"
_NONE = "0.94"
_REACH = 1.6
"""Sides of the view over half the side of the matched patch, or the plastic zone below it."""


def caption(solid: xr.Dataset, beams: xr.Dataset) -> str:
    """What is shown, how far it reaches, and what does not converge."""
    polygons, elements = planes.faces(solid, 1)
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
def plot(solid: xr.Dataset, beams: xr.Dataset) -> Figure:
    """Colours of elements, the sphere above the beam."""
    figure = Figure(figsize=(style.SINGLE * style.MILLIMETRE, 68 * style.MILLIMETRE))
    figure.set_layout_engine("constrained")
    ax = figure.add_subplot()
    polygons, elements = planes.faces(solid, 1)
    strain = 100.0 * solid[_STRAIN].values[elements]
    plastic = _plastic(solid, elements)
    planes.draw(ax, polygons[~plastic], facecolors=_NONE, edgecolors="0.75", linewidths=0.3)
    reach = _REACH * max(1e3 * float(solid["patch"]), _extent(solid, polygons[plastic]))
    ax.set(xlim=(0.0, reach), ylim=(-0.75 * reach, 0.25 * reach))
    ax.set_title(TITLE, loc="left")
    ax.set(xlabel=labels.axis("from mid-span", "mm"), ylabel=labels.axis("height", "mm"))
    scales.linear(ax, "x")
    scales.linear(ax, "y")
    if plastic.any():
        shown = planes.draw(ax, polygons[plastic], edgecolors="0.75", linewidths=0.3)
        shown.set(array=strain[plastic], cmap="viridis", norm=Normalize(0.0, strain.max()))
        figure.colorbar(shown, ax=ax, label=labels.axis("PEEQ", "%"), shrink=0.9)
    else:
        ax.text(0.5, 0.05, "no plastic strain", transform=ax.transAxes, ha="center")
    return figure


def _plastic(
    solid: xr.Dataset, elements: planes.Integers
) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    return np.asarray(solid[_STRAIN].values[elements] >= THRESHOLD)


def _extent(solid: xr.Dataset, plastic: planes.Floats) -> float:
    """How far the plastic zone reaches in mm, up to half the beam's depth."""
    if not plastic.size:
        return 0.0
    return min(float(np.abs(plastic).max()), 0.5e3 * float(solid["beam_depth"]))
