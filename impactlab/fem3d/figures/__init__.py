"""Figures of the 3-D FE model: those of a study with runs of it, and those of one run."""

from __future__ import annotations

from impactlab.fem3d.figures import witness, witness_parts
from impactlab.figures.catalogue import FigureFile

FIGURES: dict[str, FigureFile] = {"witness": witness, "witness_parts": witness_parts}
"""Figures of a study, by name, in the order of the report."""
