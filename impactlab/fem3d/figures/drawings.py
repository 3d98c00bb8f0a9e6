"""The figures of a 3-D run into files."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import xarray as xr

from impactlab.fem3d.figures import histories, mesh, plastic_strain
from impactlab.figures.draw import Drawing, draw

_FILES = {"mesh": mesh, "plastic_strain": plastic_strain, "histories": histories}


def draw_witness(solid: xr.Dataset, beams: xr.Dataset, folder: Path, study: str) -> list[Path]:
    """Draw each figure, see figures.draw.draw."""
    drawings = [
        Drawing(
            name, file.TITLE, partial(file.plot, solid, beams), partial(file.caption, solid, beams)
        )
        for name, file in _FILES.items()
    ]
    return draw(drawings, folder, study)
