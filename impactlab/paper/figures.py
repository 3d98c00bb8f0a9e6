"""The figures that answer the paper's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import xarray as xr

from impactlab.figures import labels
from impactlab.figures.catalogue import applicable
from impactlab.figures.draw import Drawing, draw
from impactlab.figures.record import Figure

Stored = Mapping[str, tuple[xr.Dataset, xr.Dataset]]
"""Runs and analysis of each study by its name."""


@dataclass(frozen=True)
class PaperFigure:
    """One figure: its number in the paper with a letter of ours, the study, our figure's name."""

    number: str
    study: str
    figure: str


FIGURES = (
    PaperFigure("5a", "fig05", "first_contact"),
    PaperFigure("5b", "fig05", "force_history"),
    PaperFigure("5c", "fig05", "displacement_history"),
    PaperFigure("6a", "fig06_nodes", "nodes_convergence"),
    PaperFigure("6b", "fig06_points", "points_convergence"),
    PaperFigure("7", "fig07", "force_indentation_by_law"),
    PaperFigure("8", "fig08", "contact_duration"),
    PaperFigure("10a", "fig10", "plastic_strain"),
    PaperFigure("10b", "fig10", "plastic_strain_depth"),
)


def draw_paper(stored: Stored, folder: Path) -> list[Path]:
    """Draw the figures whose studies are stored, as figure_05a and so on; see `draw`."""
    drawings = [
        _drawing(entry, *stored[entry.study])
        for entry in FIGURES
        if entry.study in stored and entry.figure in applicable(*stored[entry.study])
    ]
    return draw(drawings, folder, study="paper")


def _drawing(entry: PaperFigure, runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
    figure = applicable(runs, analysis)[entry.figure]
    digits = entry.number.rstrip("abc")
    return Drawing(
        f"figure_{int(digits):02d}{entry.number.removeprefix(digits)}",
        f"{entry.number}. {figure.title}",
        partial(figure.plot, runs, analysis),
        partial(_caption, entry, figure, runs, analysis),
    )


def _caption(entry: PaperFigure, figure: Figure, runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """Return what is plotted, what all runs share, and why these runs."""
    shown = figure.caption(runs, analysis)
    why = str(runs.attrs.get("description", ""))
    return " ".join(filter(None, (shown, labels.fixed(runs), why, f"Study: {entry.study}.")))
