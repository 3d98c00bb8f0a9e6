"""The picture of a design, beside the answer."""

from pathlib import Path
from shutil import copyfile

import xarray as xr

from impactlab.figures import record
from impactlab.figures.draw import draw
from impactlab.figures.sizing import sizing
from impactlab.study import SIZING

_FIGURE = record.Figure(
    "sizing",
    "Designs over the probability",
    lambda *_: True,
    lambda result, _: sizing(result),
    lambda *_: (
        "Line: the best objective for a probability, with its interval of 95 %; dots: designs "
        "whose probability was confirmed by runs; diamond: the design chosen."
    ),
)


def draw_sizing(result: xr.Dataset, folder: Path) -> list[Path]:
    """Draw sizing.svg and .png into a folder; return their paths."""
    drawings = [(_FIGURE, (result, result))]
    paths = draw(drawings, folder / SIZING / "figures", str(result.attrs.get("study")))
    pictures = [path for path in paths if path.suffix in (".svg", ".png")]
    return [Path(copyfile(path, folder / path.name)) for path in pictures]
