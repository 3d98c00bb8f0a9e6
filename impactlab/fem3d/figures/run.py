"""Figures of a 3-D run: its histories beside those of the beam models, and all figures in files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impactlab.fem3d.figures import fields
from impactlab.figures import labels, scales, style
from impactlab.figures.draw import Drawing, draw
from impactlab.figures.labels import display

_TITLE = "The 3-D FE model beside the beam models"
_PANELS = {
    "contact_force": "contact force",
    "midspan_deflection": "deflection at mid-span",
    "indentation": "indentation",
}
_SOLID = "3-D"


def _caption(solid: xr.Dataset, beams: xr.Dataset) -> str:
    """Return the caption: the quantities, and their meaning in each model."""
    velocity = labels.number(float(solid["velocity"]))
    size = labels.number(1e3 * float(solid["element_size"]))
    law = str(beams["contact"].item())
    return (
        f"Contact force, deflection of the beam's axis at mid-span and indentation (approach of "
        f"the sphere's centre of mass and that axis) at {velocity} m/s: of the 3-D FE model with "
        f"elements of {size} mm about the contact, and of beam models with the contact law "
        f"{law}. Downwards is positive."
    )


@style.paper
def _plot(solid: xr.Dataset, beams: xr.Dataset) -> Figure:
    """Draw one panel per quantity, one curve per model; the 3-D curve is black, at the bottom."""
    figure, axes = style.panels(len(_PANELS), columns=len(_PANELS), height=55)
    for ax, (name, label) in zip(axes, _PANELS.items(), strict=True):
        _draw(ax, solid, beams, name)
        time, unit = display(solid["time"]), display(solid[name])
        ax.set(
            xlabel=labels.axis("time since first touch", time.symbol),
            ylabel=labels.axis(label, unit.symbol),
        )
    style.legend(figure)
    return figure


def _draw(ax: Axes, solid: xr.Dataset, beams: xr.Dataset, name: str) -> None:
    time, unit = display(solid["time"]), display(solid[name])
    ax.plot(
        time(solid["time"]), unit(solid[name]), label=_SOLID, color="black", linewidth=1.8, zorder=2
    )
    for at, model in enumerate(beams["beam_model"].values.tolist()):
        values = beams[name].sel(beam_model=model)
        if np.isfinite(values).any():
            label = labels.values(beams["beam_model"], [at])[0]
            look: dict[str, Any] = {"color": style.COLOURS[at], "linestyle": style.LINES[at]}
            ax.plot(time(beams["time"]), unit(values), label=label, zorder=3, **look)
    scales.linear(ax, "x", ticks=4)
    scales.linear(ax, "y")
    ax.set_xlim(0.0, float(time(solid["time"])[-1]))


@dataclass(frozen=True)
class RunFigure:
    """A figure of one 3-D run; `plot` and `caption` take the datasets of `draw_witness`."""

    title: str
    plot: Callable[[xr.Dataset, xr.Dataset], Figure]
    caption: Callable[[xr.Dataset, xr.Dataset], str]


FIGURES = {
    "mesh": RunFigure(fields.MESH_TITLE, fields.plot_mesh, fields.mesh_caption),
    "plastic_strain": RunFigure(fields.STRAIN_TITLE, fields.plot_strain, fields.strain_caption),
    "histories": RunFigure(_TITLE, _plot, _caption),
}
"""Figures by name, which is also the name of the file."""


def draw_witness(solid: xr.Dataset, beams: xr.Dataset, folder: Path, study: str) -> list[Path]:
    """Draw each figure of a 3-D run into `folder`, see figures.draw.draw.

    solid: a dataset of fem3d.solver. beams: the answers of the beam models to the same impact, on
    `beam_model`.
    """
    pair = solid, beams
    drawings = [
        Drawing(name, figure.title, partial(figure.plot, *pair), partial(figure.caption, *pair))
        for name, figure in FIGURES.items()
    ]
    return draw(drawings, folder, study)
