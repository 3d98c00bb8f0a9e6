"""Draw every figure that applies, into files."""

from __future__ import annotations

import json
from pathlib import Path

import xarray as xr
from matplotlib.figure import Figure

from impactlab.figures import style
from impactlab.figures.catalogue import CATALOGUE
from impactlab.figures.files import replaced

FORMATS = ("svg", "png")
CAPTIONS = "captions.json"


def draw_all(runs: xr.Dataset, analysis: xr.Dataset, folder: Path) -> list[Path]:
    """Write NAME.svg and NAME.png of each figure that applies, and captions.json.

    captions.json: {NAME: {"title", "caption"}} in the order of the report. Files of figures that
    do not apply any more are removed. The same datasets give the same bytes. Returns the paths
    written. Raises what drawing raises, with the figure's name added.
    """
    folder.mkdir(parents=True, exist_ok=True)
    written: list[Path] = []
    captions: dict[str, dict[str, str]] = {}
    for name, file in CATALOGUE.items():
        if not file.applies(runs, analysis):
            _remove(folder, name)
            continue
        try:
            written += save(file.plot(runs, analysis), folder, name)
            captions[name] = {"title": file.TITLE, "caption": file.caption(runs, analysis)}
        except Exception as error:
            error.add_note(f"while drawing the figure {name} of study {runs.attrs.get('study')}")
            raise
    with replaced(folder / CAPTIONS) as path:
        path.write_text(json.dumps(captions, indent=2, ensure_ascii=False) + "\n", "utf-8")
    return [*written, folder / CAPTIONS]


def save(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write the figure in each format, atomically, without a date inside. Returns the paths."""
    paths = [folder / f"{name}.{kind}" for kind in FORMATS]
    for path in paths:
        metadata = {"Date": None} if path.suffix == ".svg" else {"Software": None}
        with style.applied(), replaced(path) as temporary:
            figure.savefig(temporary, format=path.suffix[1:], metadata=metadata)
    return paths


def _remove(folder: Path, name: str) -> None:
    for kind in FORMATS:
        (folder / f"{name}.{kind}").unlink(missing_ok=True)
