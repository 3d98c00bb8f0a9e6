"""The figures that answer the paper's: which study and which figure of it each one is."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from impactlab.figures import labels
from impactlab.figures.catalogue import FigureFile, applicable
from impactlab.figures.draw import Drawing, draw

Stored = Mapping[str, tuple[xr.Dataset, xr.Dataset]]
"""runs and analysis of each study by its name."""


class Answer(NamedTuple):
    """One figure: its number in the paper and a letter of ours, study, name in the catalogue."""

    number: str
    study: str
    figure: str


ANSWERS = (
    Answer("5a", "fig05", "first_contact"),
    Answer("5b", "fig05", "force_history"),
    Answer("5c", "fig05", "displacement_history"),
    Answer("6a", "fig06_nodes", "nodes_convergence"),
    Answer("6b", "fig06_points", "points_convergence"),
    Answer("7", "fig07", "force_indentation_by_law"),
    Answer("8", "fig08", "contact_duration"),
    Answer("10a", "fig10", "plastic_strain"),
    Answer("10b", "fig10", "plastic_strain_depth"),
)


def draw_paper(stored: Stored, folder: Path) -> list[Path]:
    """Draw the figures whose studies there are, as figure_05a and so on; see `draw`."""
    drawings = [
        _drawing(answer, *stored[answer.study])
        for answer in ANSWERS
        if answer.study in stored and answer.figure in applicable(*stored[answer.study])
    ]
    return draw(drawings, folder, study="paper")


def _drawing(answer: Answer, runs: xr.Dataset, analysis: xr.Dataset) -> Drawing:
    file = applicable(runs, analysis)[answer.figure]
    digits = answer.number.rstrip("abc")
    return Drawing(
        f"figure_{int(digits):02d}{answer.number.removeprefix(digits)}",
        f"{answer.number}. {file.TITLE}",
        partial(file.plot, runs, analysis),
        partial(_caption, answer, file, runs, analysis),
    )


def _caption(answer: Answer, file: FigureFile, runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """What is plotted, then what is the same in all runs, then why these runs."""
    shown = file.caption(runs, analysis)
    why = str(runs.attrs.get("description", ""))
    return " ".join(filter(None, (shown, labels.fixed(runs), why, f"Study: {answer.study}.")))
