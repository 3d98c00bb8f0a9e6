"""From solved runs to their analysis, predictions, inference, figures, animations and reports."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from impactlab.cli import stop_solving
from impactlab.cli.options import (
    RESULTS,
    RunsFile,
    StudyFile,
    all_stored,
    argument,
    assigned,
    chosen,
    given,
    new_file,
    new_folder,
)

if TYPE_CHECKING:
    import xarray as xr


_STORED = "A study's runs.nc and analysis.nc, a verification's findings.nc, or results/NAME."
StoredFiles = Annotated[
    list[Path], typer.Argument(metavar="STORED...", help=_STORED, callback=all_stored)
]
Pictures = Annotated[Path | None, new_folder(help="Default: figures/ beside the first of them.")]


def analyse(
    runs: RunsFile,
    resolution: Annotated[
        Path | None, typer.Option(help="Output of `recommend`: numerical uncertainty.")
    ] = None,
    refinement: Annotated[
        Path | None,
        typer.Option(help="Output of `refine`: measured numerical error of Sobol indices."),
    ] = None,
    output: Annotated[Path | None, new_file(".nc", help="Default: beside the runs.")] = None,
) -> None:
    """Compute convergence and sensitivity from solved runs.

    For a sample, also write, beside the output: every index with its interval (indices.csv,
    indices.nc), the distribution of each response (distribution.csv), and surrogate.nc for
    `impactlab predict`.
    """
    from impactlab.files import opened
    from impactlab.report.answer import answers
    from impactlab.study.steps import analyse_runs

    path = output or runs.with_name("analysis.nc")
    analysis = analyse_runs(runs, path, resolution, refinement)
    with opened(runs, "runs") as solved:
        lines = answers(solved, analysis)
        print(f"{path}: {lines[0]}", *lines[1:] if "limits" in analysis.attrs else (), sep="\n")


def predict(
    surrogate: Annotated[
        Path, argument("SURROGATE", "results/NAME/surrogate.nc, or results/NAME.", "surrogate.nc")
    ],
    values: Annotated[
        list[str],
        typer.Argument(metavar="NAME=VALUE...", help="Such as velocity=2 beam_depth='27 mm'."),
    ],
) -> None:
    """Predict the responses of one run without solving it.

    Give all parameters that the study varied. Each response is printed with the half-width of its
    95 % interval, from the errors on runs left out of the fit, which grow towards the ends of the
    ranges.
    """
    from impactlab.analysis.surrogate import load_surrogate
    from impactlab.report.console import print_predictions

    model = load_surrogate(surrogate)
    texts = assigned(values)
    numbers = {name: given(name, text, model.units(name)) for name, text in texts.items()}
    print_predictions(model.predict(**numbers))


def figures(
    stored: Annotated[
        list[Path],
        typer.Argument(metavar="STORED...", help=f"{_STORED} Or NAME.", callback=all_stored),
    ],
    output: Annotated[
        Path | None, new_folder(help="Default: figures/ (or panels/) beside the first of them.")
    ] = None,
    width: Annotated[
        str | None, typer.Option(help="Draw each panel as a file of this width, such as 89mm.")
    ] = None,
    style: Annotated[
        str | None, typer.Option(help="Of these panels: nature, science or plain (default).")
    ] = None,
) -> None:
    """Draw all figures of a study's results or findings.

    With --width or --style, draw each panel as a file of its own instead, as SVG, PDF and PNG:
    FIGURE_PANEL_89mm.pdf. NAME is a study whose results are in results/NAME.
    """
    from impactlab.figures.labels import counted
    from impactlab.report.results import open_stored, stored_files
    from impactlab.study.steps import results_folder

    if len(stored) == 1 and not stored[0].suffix:
        stored = stored_files(results_folder(str(stored[0])))
    alone = width is not None or style is not None
    write = _panels(width or "89mm", style or "plain") if alone else None
    folder = output or stored[0].with_name("panels" if alone else "figures")
    with open_stored(stored) as (kind, datasets):
        count = sum(path.suffix == ".svg" for path in kind.draw(*datasets, folder, write))
        print(f"{folder}: {counted(count, 'panel' if alone else 'figure')}")


def _panels(width: str, style: str) -> Callable[..., list[Path]]:
    """Return what draws panels of a width and a style. Raises ValueError naming the option."""
    from functools import partial

    from impactlab.figures.draw import draw_panels
    from impactlab.figures.style import DOUBLE, SHEETS
    from impactlab.validation.errors import unknown

    millimetres = round(1e3 * given("--width", width, "m"), 6)
    if not _NARROWEST <= millimetres <= DOUBLE:
        expected = f"{_NARROWEST:g} to {DOUBLE:g} mm (the columns of a paper)"
        raise ValueError(f"--width = {width!r}: expected {expected}")
    if style not in SHEETS:
        raise ValueError(f"--style = {style!r}: {unknown('style', style, SHEETS)}")
    return partial(draw_panels, width=millimetres, look=style)


_NARROWEST = 80.0
"""Least width of a panel that has room for its labels at 8 pt, mm."""


def report(
    stored: StoredFiles,
    figures: Pictures = None,
    output: Annotated[
        Path | None, new_file(".html", help="Default: report.html beside the first of them.")
    ] = None,
) -> None:
    """Write a study's report, and the provenance of its files.

    The provenance is ro-crate-metadata.json, beside the runs.
    """
    from impactlab.report.crate import write_crate
    from impactlab.report.results import open_stored

    path = output or stored[0].with_name("report.html")
    pictures = figures or stored[0].with_name("figures")
    with open_stored(stored) as (kind, datasets):
        kind.write(*datasets, pictures, path)
        write_crate(datasets[0], stored[0].parent, pictures, path)
        print(path)


def export(
    study: Annotated[
        str, typer.Argument(metavar="NAME", help="A study whose results are in results/NAME.")
    ],
    to: Annotated[str, typer.Option(help="csv, xlsx, parquet or latex.")] = "csv",
    responses: Annotated[
        str, typer.Option(help="Responses, such as peak_force,impulse. Default: the study's.")
    ] = "",
    output: Annotated[Path | None, new_folder(help="Default: results/NAME/tables.")] = None,
) -> None:
    """Write tables of a study's runs, indices and answers.

    One file per table, or one Excel workbook. Heads state the units: SI, as in runs.nc. LaTeX has
    the names, units and digits of the figures, for booktabs and siunitx. Excel and Parquet need
    pip install 'impactlab[tables]'.
    """
    from impactlab.figures.access import responses as known
    from impactlab.report.results import open_stored, stored_files
    from impactlab.report.tables import SUFFIXES
    from impactlab.report.tables import export as write_tables
    from impactlab.study.steps import results_folder
    from impactlab.validation.errors import unknown

    if to not in SUFFIXES:
        raise ValueError(f"--to = {to!r}: {unknown('format', to, SUFFIXES)}")
    folder = results_folder(study)
    with open_stored(stored_files(folder)) as (_, (runs, *analyses)):
        names = chosen("--responses", responses, known(runs))
        analysis = next(iter(analyses), None)
        for path in write_tables(runs, analysis, output or folder / "tables", to, names):
            print(path)


def index(
    results: Annotated[Path, typer.Argument(help="Folder of results.")] = RESULTS,
    output: Annotated[Path | None, new_file(".html", help="Default: index.html in it.")] = None,
) -> None:
    """Write the index over all reports."""
    from impactlab.report.results import write_index

    path = output or results / "index.html"
    write_index(results, path)
    print(f"{path}: the list of all reports")


def compare(
    studies: Annotated[
        list[str],
        typer.Argument(metavar="STUDY...", help="Two or more studies with results, by name."),
    ],
    results: Annotated[Path, typer.Option(help="Folder of results.")] = RESULTS,
    output: Annotated[
        Path | None, new_folder(help="Default: compare-A-B, beside their results.")
    ] = None,
) -> None:
    """Compare the results of studies side by side, on one page.

    It shows what differs in their files, each response that all of them have on common axes, and
    the sensitivity indices of samples with the differences that chance does not explain. (To
    compare a study with measurements, list these under `measurements` in its file.)
    """
    from impactlab.report.comparison import compare_results, study_folder

    comparison = compare_results([study_folder(name, results) for name in studies], output)
    folder = output or results / str(comparison.attrs["study"])
    headline, *lines = str(comparison.attrs["answer"]).splitlines()
    print(f"{folder / 'report.html'}: {headline}", *lines, sep="\n")


def calibrate(
    study: StudyFile,
    measurements: Annotated[
        Path, typer.Argument(metavar="MEASUREMENTS", help="A file, measurements/NAME.yaml.")
    ],
    contact: Annotated[
        str, typer.Option(help="Contact laws to weigh, such as stronge,mjg. Default: the study's.")
    ] = "",
    model_error: Annotated[
        str, typer.Option(help="Standard error of the model itself, such as '3 %'.")
    ] = "0",
    workers: Annotated[int, typer.Option(min=1, help="Threads.")] = os.cpu_count() or 1,
) -> None:
    """Infer parameters, and weights of laws, from measurements.

    Solves the sample where it is not solved, calibrates its surrogate, and solves runs at the
    posterior to confirm it. Writes calibration.nc and its report, calibration.html, to
    results/NAME.
    """
    stop_solving()
    from impactlab.report.calibration import draw_and_tell
    from impactlab.study import steps
    from impactlab.study.calibration import calibrate as calibration
    from impactlab.study.engine import Engine
    from impactlab.study.schema.readers import read_study

    declared = read_study(study)
    folder = steps.results_folder(declared.name)
    laws = contact.replace(",", " ").split()
    error = given("--model-error", model_error, "1")
    posterior = calibration(declared, folder, measurements, Engine("threads", workers), laws, error)
    for line in draw_and_tell(posterior, folder):
        print(line)


def animate(
    stored: Annotated[
        Path,
        argument(
            "STORED",
            "Output of `impactlab simulate`, a study's runs.nc, or results/NAME.",
            "runs.nc",
        ),
    ],
    values: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME=VALUE...]", help="A run of the study, such as velocity=5 contact=mjg."
        ),
    ] = None,
    frames: Annotated[int, typer.Option(min=2, help="Frames, 25 per second.")] = 200,
    output: Annotated[
        Path | None,
        new_file(".html", ".gif", ".mp4", help="Default: animation.html beside STORED."),
    ] = None,
) -> None:
    """Animate one impact: beam, plastic zone and force.

    The HTML file needs no other one. MP4 needs ffmpeg, or pip install 'impactlab[video]'.
    """
    from impactlab.figures.animation import animation, with_fields
    from impactlab.files import opened

    path = output or stored.with_name("animation.html")
    with opened(stored, "impact", "runs") as runs:
        run = with_fields(_selected(runs, assigned(values or [])), frames)
        print(animation(run).save(path))


def _selected(runs: xr.Dataset, texts: dict[str, str]) -> xr.Dataset:
    """Return the runs with these values. Raises ValueError where there are none, naming all."""
    import numpy as np

    from impactlab.figures.access import design_dims
    from impactlab.figures.labels import listing
    from impactlab.validation.errors import unknown

    dims = {*design_dims(runs)}
    parameters = [str(name) for name, array in runs.coords.items() if dims.intersection(array.dims)]
    for name, text in texts.items():
        if name not in parameters:
            raise ValueError(f"{name}: {unknown('parameter', name, parameters)}")
        array = runs[name]
        if array.dtype.kind in "if":
            matches = np.isclose(array, given(name, text, array.attrs.get("units", "1")), atol=0.0)
        else:
            matches = array.values == text
        if not matches.any():
            present = listing([str(value) for value in np.unique(array.values)])
            raise ValueError(f"{name} = {text!r}: no run has it: choose from {present}")
        runs = runs.isel({array.dims[0]: matches.nonzero()[0]})
    return runs.squeeze([dim for dim in design_dims(runs) if runs.sizes[dim] == 1])
