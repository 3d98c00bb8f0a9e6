"""Figures of the 3-D FE model: those of a study with runs of it, and those of one run."""

from __future__ import annotations

from impactlab.fem3d.figures import witness, witness_parts
from impactlab.figures.record import Figure

FIGURES = {
    name: Figure(name, module.TITLE, module.applies, module.plot, module.caption)
    for name, module in (("witness", witness), ("witness_parts", witness_parts))
}
"""Figures of a study, by name, in the order of the report."""
