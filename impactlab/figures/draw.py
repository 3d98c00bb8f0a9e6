"""Draw every figure that applies, into files."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import xarray as xr
from matplotlib import rcParams
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from impactlab.figures import animation, data, findings, record, style
from impactlab.figures.catalogue import applicable
from impactlab.files import identity, replaced
from impactlab.verification.finding import gravest_first
from impactlab.verification.outcomes import unpacked

FORMATS = ("svg", "png")
OVERVIEW = "overview"
"""Name of the figure of all comparisons; the others are named for their checks."""


Drawing = tuple[record.Figure, tuple[xr.Dataset, xr.Dataset]]
"""A figure with the datasets that it shows; attributes of the first one name the study."""


def draw_all(runs: xr.Dataset, analysis: xr.Dataset, folder: Path) -> list[Path]:
    """Draw each figure of the catalogue that applies to a study of runs; see `draw`.

    A study of one run that stores profiles has an animation, too.
    """
    drawings = [(figure, (runs, analysis)) for figure in applicable(runs, analysis).values()]
    paths = draw(drawings, folder, str(runs.attrs.get("study")), made_from=analysis)
    if moving := animation.of_study(runs):
        return [*paths, moving.save(folder / animation.FILE)]
    (folder / animation.FILE).unlink(missing_ok=True)
    return paths


def draw_findings(stored: xr.Dataset, folder: Path) -> list[Path]:
    """Draw the overview of a verification, and the curves of each check; see `draw`."""
    outcomes = gravest_first(unpacked(stored))

    def figure(name: str, title: str, plot: Any, caption: Any, shown: Any) -> Drawing:
        drawer, writer = (lambda *_: plot(shown)), (lambda *_: caption(shown))
        return record.Figure(name, title, lambda *_: True, drawer, writer), (stored, stored)

    overview = findings.plot_overview, findings.overview_caption
    drawings = [figure(OVERVIEW, "All comparisons", *overview, outcomes)]
    drawings += [
        figure(outcome.name, outcome.title, findings.plot_curves, findings.curves_caption, outcome)
        for outcome in outcomes
        if any(panel.curves for panel in outcome.finding.panels)
    ]
    return draw(drawings, folder, study=str(stored.attrs.get("study")), made_from=stored)


def draw(
    drawings: Iterable[Drawing], folder: Path, study: str, made_from: xr.Dataset | None = None
) -> list[Path]:
    """Write NAME.svg, NAME.png, the data behind it (see data.py), and captions.json.

    The metadata of both pictures name the study and the hash of its file.

    captions.json: {NAME: {"title", "caption", "alt", "made_from"}} in the order of the report.
    Files of figures that it named before and that are no longer drawn are removed. The same
    datasets give the same bytes. Returns the paths written. Raises what drawing raises, with the
    figure's name added.
    """
    folder.mkdir(parents=True, exist_ok=True)
    before: set[str] = set()
    with suppress(OSError, ValueError):  # it is written anew
        before.update(record.listed(folder))
    written: list[Path] = []
    captions: dict[str, dict[str, str]] = {}
    for entry, pair in drawings:
        try:
            figure = entry.plot(*pair)
            source = f"study {pair[0].attrs.get('study', study)}"
            if digest := pair[0].attrs.get("study_sha256"):
                source += f", SHA-256 of its file: {digest}"
            written += save(figure, folder, entry.name, {"Title": entry.title, "Source": source})
            written += data.save(figure, folder, entry.name)
            captions[entry.name] = {
                "title": entry.title,
                "caption": entry.caption(*pair),
                "alt": data.alt(figure),
                "made_from": identity(made_from),
            }
        except Exception as error:
            error.add_note(f"while drawing the figure {entry.name} of study {study}")
            raise
    with replaced(folder / record.CAPTIONS) as path:
        path.write_text(json.dumps(captions, indent=2, ensure_ascii=False) + "\n", "utf-8")
    for name in before - captions.keys():
        for kind in (*FORMATS, *data.FORMATS):
            (folder / f"{name}.{kind}").unlink(missing_ok=True)
    return [*written, folder / record.CAPTIONS]


def save(
    figure: Figure, folder: Path, name: str, about: Mapping[str, str] | None = None
) -> list[Path]:
    """Write the figure in each format, atomically, without a date inside. Returns the paths.

    about: metadata of both files, by the terms of Dublin Core that PNG knows too.
    """
    svg, png = (folder / f"{name}.{kind}" for kind in FORMATS)
    with style.applied(), replaced(svg) as vectors, replaced(png) as pixels:
        # Figure.savefig would draw each file twice
        vector: Any = FigureCanvasSVG(figure)
        figure.dpi = rcParams["savefig.dpi"]
        vector.print_svg(vectors, metadata={"Date": None, **(about or {})})
        figure.set_layout_engine("none")  # laid out once: that takes most of the time
        bitmap: Any = FigureCanvasAgg(figure)
        figure.dpi = rcParams["savefig.dpi"]
        bitmap.print_png(pixels, metadata={"Software": None, **(about or {})})
    return [svg, png]
