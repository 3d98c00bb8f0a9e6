"""The figures that 3-D runs add to those of a study."""

from __future__ import annotations

from impactlab.fem3d.figures import witness, witness_parts
from impactlab.figures.catalogue import FigureFile

FIGURES: dict[str, FigureFile] = {"witness": witness, "witness_parts": witness_parts}
"""By name, in the order of the report."""
