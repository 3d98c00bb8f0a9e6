"""Draw every figure that applies, into files."""

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any

import xarray as xr
from matplotlib import rcParams
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from impactlab.figures import animation, data, findings, labels, record, style
from impactlab.figures.catalogue import applicable
from impactlab.figures.needs import judged_once
from impactlab.files import identity, replaced
from impactlab.verification.finding import gravest_first
from impactlab.verification.outcomes import unpacked

FORMATS = ("svg", "png")
OVERVIEW = "overview"
"""Name of the figure of all comparisons; the others are named for their checks."""


Drawing = tuple[record.Figure, tuple[xr.Dataset, xr.Dataset]]
"""A figure with the datasets that it shows; attributes of the first one name the study."""


def draw_all(
    runs: xr.Dataset,
    analysis: xr.Dataset,
    folder: Path,
    write: Callable[..., list[Path]] | None = None,
) -> list[Path]:
    """Draw each figure of the catalogue that applies to a study of runs; see `draw`.

    A study of one run that stores profiles has an animation, too. write: takes the place of `draw`,
    such as `draw_panels`, which draws no animation.
    """
    drawings = [(figure, (runs, analysis)) for figure in applicable(runs, analysis).values()]
    study = str(runs.attrs.get("study"))
    if write:
        return write(drawings, folder, study, made_from=analysis)
    paths = draw(drawings, folder, study, made_from=analysis)
    if moving := animation.of_study(runs):
        return [*paths, moving.save(folder / animation.FILE)]
    (folder / animation.FILE).unlink(missing_ok=True)
    return paths


def draw_findings(
    stored: xr.Dataset, folder: Path, write: Callable[..., list[Path]] | None = None
) -> list[Path]:
    """Draw the overview of a verification, and the curves of each check; see `draw_all`."""
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
    study = str(stored.attrs.get("study"))
    return (write or draw)(drawings, folder, study, made_from=stored)


@judged_once()
def draw(
    drawings: Iterable[Drawing],
    folder: Path,
    study: str,
    made_from: xr.Dataset | None = None,
    formats: Sequence[str] = FORMATS,
) -> list[Path]:
    """Write NAME.svg, NAME.png, the data behind it (see data.py), and captions.json.

    The metadata of the pictures name the study and the hash of its file. formats: see `save`.

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
            written += save(figure, folder, entry.name, _about(entry, pair[0], study), formats)
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


def draw_panels(
    drawings: Iterable[Drawing],
    folder: Path,
    study: str,
    made_from: xr.Dataset | None = None,
    *,
    width: float,
    look: str,
) -> list[Path]:
    """Write each panel as a file of its own: FIGURE_PANEL_WIDTHmm.svg, .png and .pdf.

    width: of a file, mm. look: a style of `style.SHEETS`. `made_from` is of no use here.
    Returns the paths written. Raises what drawing raises, with the figure's name added.
    """
    folder.mkdir(parents=True, exist_ok=True)
    written: list[Path] = []
    for entry, pair in drawings:
        about, names = _about(entry, pair[0], study), set[str]()
        for number in count():
            try:
                with style.chosen(look), style.alone(number, width) as panel:
                    figure = entry.plot(*pair)
                    name = entry.name if panel.count < 2 else f"{entry.name}_{_slug(figure)}"
                    name += f"_{number + 1}" if name in names else ""
                    names.add(name)
                    name += f"_{labels.number(width)}mm"
                    written += save(figure, folder, name, about, formats=(*FORMATS, "pdf"))
            except Exception as error:
                error.add_note(f"while drawing panel {number + 1} of the figure {entry.name}")
                raise
            if number + 1 >= panel.count:
                break
    return written


def _slug(figure: Figure) -> str:
    """Return the title of a figure's only panel, or the label of its axis, for a file's name."""
    axes = figure.axes[0]
    legend = axes.get_legend()
    titles = axes.get_title(loc="left"), legend.get_title().get_text() if legend else ""
    text = next(filter(None, (*titles, axes.get_xlabel(), axes.get_ylabel())), "panel")
    return re.sub(r"\W+", "_", text.partition(" (")[0].lower(), flags=re.ASCII).strip("_")


def _about(entry: record.Figure, runs: xr.Dataset, study: str) -> dict[str, str]:
    """Return the metadata of the pictures of a figure."""
    source = f"study {runs.attrs.get('study', study)}"
    if digest := runs.attrs.get("study_sha256"):
        source += f", SHA-256 of its file: {digest}"
    return {"Title": entry.title, "Source": source}


def save(
    figure: Figure,
    folder: Path,
    name: str,
    about: Mapping[str, str] | None = None,
    formats: Iterable[str] = FORMATS,
) -> list[Path]:
    """Write the figure in each format, atomically, without a date inside. Returns the paths.

    about: metadata of the files, by the terms of Dublin Core that PNG knows too. formats: among
    "svg", "png" and "pdf".
    """
    about, paths = dict(about or {}), []
    subject = {"Title": about.get("Title"), "Subject": about.get("Source")}
    metadata: dict[str, dict[str, Any]] = {
        "svg": {"Date": None, **about},
        "png": {"Software": None, **about},
        "pdf": {"CreationDate": None, **{key: text for key, text in subject.items() if text}},
    }
    for kind in formats:
        path = folder / f"{name}.{kind}"
        with style.applied(), replaced(path) as unfinished:
            # Figure.savefig would draw each file twice
            canvas: Any = _CANVASES[kind](figure)
            figure.dpi = rcParams["savefig.dpi"]
            getattr(canvas, f"print_{kind}")(unfinished, metadata=metadata[kind])
            figure.set_layout_engine("none")  # laid out once: that takes most of the time
        paths.append(path)
    return paths


_CANVASES = {"svg": FigureCanvasSVG, "png": FigureCanvasAgg, "pdf": FigureCanvasPdf}
