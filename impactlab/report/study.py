"""The report of a study: one HTML file that needs nothing else."""

import os
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr

from impactlab.figures import access, labels
from impactlab.figures.access import count, design_dims, is_sample, names, responses, usable, varied
from impactlab.figures.labels import display
from impactlab.figures.measures import analysed
from impactlab.figures.needs import judged_once
from impactlab.figures.samples import scatter
from impactlab.methods import NO_DISTRIBUTION
from impactlab.methods.distributions import distribution_of
from impactlab.methods.runs import correlations
from impactlab.report import distribution, measured, sensitivity, strikes
from impactlab.report.answer import entries
from impactlab.report.cautions import beside, cautions, endings, notes
from impactlab.report.convergence import convergence
from impactlab.report.distribution import regime_entries
from impactlab.report.explorer import write_explorer
from impactlab.report.page import Cell, Row, Section, Table, described, motion, pictures, write_page
from impactlab.report.questions import answers_beside, slow_model_sections
from impactlab.variables import of_table

_GRID_VALUES = 12  # a longer list of values of a grid is replaced by its range
_FAILED_RUNS = 20  # largest number of failed runs listed one by one
_EACH = "Each response against each parameter"
_SCATTER = (
    "A line that bends or tilts shows a parameter that matters by itself; points that fan out "
    "around a flat line hint at a parameter that matters together with others."
)


def counts(runs: xr.Dataset) -> tuple[str, str]:
    """Return how many runs there are, of which method, and how many failed ("": none)."""
    method = labels.method(str(runs.attrs.get("method", "grid")))
    return f"{labels.counted(count(runs), 'run')} ({method})", endings(runs)


@judged_once()
def write_report(runs: xr.Dataset, analysis: xr.Dataset, figures_folder: Path, path: Path) -> None:
    """Write the report of a study from its stored datasets and figures.

    runs: runs.nc; analysis: analysis.nc; figures_folder: what draw_all wrote. The report
    of a sample links indices.csv, which lies beside its analysis, and the page of sliders that is
    written beside the report where a surrogate is usable. Raises FileNotFoundError when a
    figure is missing, OSError when `path` cannot be written.
    """
    sections = [*slow_model_sections(runs, path.parent), *_sections(runs, analysis)]
    headline, answer, note = entries(runs, analysis)
    placed = [name for section in sections for name in section.figures]
    figures = pictures(figures_folder, placed, analysis)
    total, first = len(figures), next(iter(figures), "")
    rest = [name for name in figures if name not in (*placed, first)]
    if rest or not figures:
        lead = "" if rest else "This study stores no data that a figure could show."
        sections.append(Section("figures", "Figures", lead, figures=rest))
    if warnings := list(cautions(runs)):
        title = "Before using these numbers"
        sections.insert(0, Section("cautions", title, sentences=warnings, grave=True))
    if remarks := list(notes(runs)):
        title = "Notes on the model"
        sections.append(Section("notes", title, sentences=remarks, closed=True))
    size, ending = counts(runs)
    write_page(
        "report.html.j2",
        path,
        **described(runs),
        headline=headline,
        answers=answer,
        beside=answers_beside(runs, path.parent),
        note=note,
        bad=bool(regime_entries(runs)),
        leading=figures.pop(first, None),
        facts=[
            size if ending else f"{size}, none failed",
            labels.counted(len(varied(runs)), "varied parameter"),
            labels.counted(total, "figure"),
        ],
        ending=ending,
        pictures=figures,
        files=os.path.relpath(figures_folder, path.parent),
        sections=sections,
        explorer=write_explorer(runs, analysis, path),
        animation=motion(figures_folder),
    )


def _sections(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the sections on results, inputs and runs, in the order of the page."""
    inputs, ranges = _inputs(runs), _ranges(runs, analysis)
    if not is_sample(runs):
        further = access.further_models(runs)
        return [
            *convergence(runs, analysis),
            *measured.sections(runs, analysis),
            *(section for model in further for section in model.part("sections")(runs, analysis)),
            *strikes.sections(runs, _place),
            Section("results", "Results", tables=[ranges]),
            _outcome(runs, analysis),
            inputs,
        ]
    scattered = [scatter(name).name for name in responses(runs)]
    lead = NO_DISTRIBUTION.get(str(runs.attrs.get("method")), "")
    lead = lead and f"There are no moments and percentiles: {lead}."
    by_word = [_by_word(runs, name) for name in varied(runs) if labels.words(runs[name])]
    figures = ("response_distributions", "cumulative_distributions")
    return [
        *distribution.limit_sections(runs, analysis),
        *sensitivity.sections(runs, analysis),
        *sensitivity.numerical_sections(runs, analysis),
        *measured.sections(runs, analysis),
        *strikes.sections(runs, _place),
        Section(
            "results",
            "Distribution of each response",
            lead,
            tables=[ranges, *by_word],
            figures=figures,
        ),
        _outcome(runs, analysis, ["failure_shares", "failure_map"]),
        inputs,
        Section("scatter", _EACH, _SCATTER, figures=scattered, closed=True),
    ]


def _inputs(runs: xr.Dataset) -> Section:
    """Return the section on the parameters: varied ones with values or distribution, fixed ones."""
    groups = dict(zip(names(runs, "varied"), names(runs, "groups"), strict=False))
    changed: list[Row] = []
    for name in varied(runs):
        values = _values(runs[name], "rows" if of_table(runs) else "draws")
        group = [groups[name].replace("_", " ")] if groups else []
        label = labels.sentence(labels.parameter(runs[name]))
        changed.append([label, *values, *group, Cell(name, "muted")])
    fixed: list[Row] = []
    for key, coordinate in runs.coords.items():
        if coordinate.ndim == 0 and key not in varied(runs):
            label = labels.sentence(labels.parameter(coordinate))
            text = labels.values(coordinate, [0])[0] + labels.unit(coordinate)
            fixed.append([label, text, Cell(str(key), "muted")])
    head = ["Parameter", "Values", "Number", *(["Group"] if groups else []), "Key"]
    tables = (
        [Table("Parameters" if of_table(runs) else "Varied parameters", head, changed)]
        if changed
        else []
    )
    tables += [_correlations(runs, pairs)] if (pairs := correlations(runs)) else []
    caption = "Parameters that are the same in every run"
    folded = [Table(caption, ["Parameter", "Value", "Key"], fixed)] if fixed else []
    title = "Inputs" if of_table(runs) else "What was varied"
    return Section("runs", title, tables=tables, folded=folded)


def _correlations(runs: xr.Dataset, pairs: list[tuple[str, str, float]]) -> Table:
    """Return one row per pair of correlated parameters: as stated, and as found in the sample."""
    rows: list[Row] = []
    for first, second, stated in pairs:
        observed = float(scipy.stats.spearmanr(runs[first].values, runs[second].values).statistic)
        pair = labels.sentence(
            f"{labels.parameter(runs[first])} and {labels.parameter(runs[second])}"
        )
        rows.append([pair, *(Cell(f"{rank:.2f}", "number") for rank in (stated, observed))])
    if of_table(runs):  # which states none
        caption = "Rank correlations that chance does not explain"
        return Table(caption, ["Parameters", "In the table"], [[row[0], row[2]] for row in rows])
    caption = "Rank correlations, by a Gaussian copula; all other pairs vary independently"
    return Table(caption, ["Parameters", "As stated", "In the sample"], rows)


def _values(coordinate: xr.DataArray, noun: str) -> Row:
    """Return values and their number, or a distribution: "uniform: low 250 MPa, high 450 MPa"."""
    unit, size, attrs, texts = labels.unit(coordinate), coordinate.size, coordinate.attrs, []
    if listed := labels.words(coordinate):
        weights = np.atleast_1d(attrs["weights"]).tolist()
        for word, weight in zip(listed, weights, strict=True):
            texts.append(f"{word} {labels.percent(weight, 3)}")
    elif "distribution" in attrs:
        scale = display(coordinate).scale
        arguments = distribution_of(attrs).arguments().items()
        for key, value in (pair for pair in arguments if pair[0] != "distribution"):
            ratio = "geometric" in key  # without the parameter's unit
            text = labels.number(float(value) * (1.0 if ratio else scale))
            texts.append(f"{key.replace('_', ' ')} {text}{'' if ratio else unit}")
    if texts:
        name = str(attrs["distribution"]).replace("_", "-")
        return [f"{name}: {', '.join(texts)}", Cell(f"{size} {noun}", "number")]
    where, between = list(range(size)), ", "
    if size > _GRID_VALUES and coordinate.dtype.kind in "if":
        numbers, between = coordinate.values, " to "
        where = [int(np.argmin(numbers)), int(np.argmax(numbers))]
    return [between.join(labels.values(coordinate, where)) + unit, str(size)]


def _by_word(runs: xr.Dataset, name: str) -> Table:
    """Return one row per response: its mean over the runs of each word that a parameter takes."""
    rows: list[Row] = []
    for response in responses(runs):
        unit, cells = display(runs[response]), []
        for mean, half in access.means_by_word(runs, name, response).values():
            text = labels.number(float(unit(mean)), 3)
            if np.isfinite(half):
                text += f" ± {labels.number(float(unit(half)), 2)}"
            cells.append(Cell(text, "number"))
        rows.append([labels.axis(labels.response(response), unit.symbol), *cells])
    caption = (
        f"Mean of each response by {labels.parameter(runs[name])}, over the runs that have it, "
        "with the half-width of its interval"
    )
    return Table(caption, ["Response", *labels.words(runs[name])], rows)


def _outcome(runs: xr.Dataset, analysis: xr.Dataset, figures: list[str] | None = None) -> Section:
    """Return the section on failed runs, and on values that a surrogate supplied."""
    failed, total = access.failed(runs), count(runs)
    imputed = []
    for name in analysed(runs, analysis, "imputed_share"):
        if (share := float(analysis["imputed_share"].sel(response=name))) > 0:
            text = f"For the indices of the {labels.response(name)}, a surrogate supplied the value"
            imputed.append(f"{text} of {labels.percent(share)} of the runs.")
    title = "How the runs ended"
    if not failed.any():
        return Section("outcome", title, f"All {total} runs gave every response.", imputed)
    lead = f"Of {total} runs, {endings(runs)}."
    causes = access.causes(runs, failed)
    rows: list[Row] = [[labels.sentence(why), Cell(str(n), "number")] for why, n in causes.items()]
    reasons = Table("Reasons for what is missing", ["Reason", "Runs"], rows)
    tables = [reasons, _failed_runs(runs, failed)]
    return Section("outcome", title, lead, imputed, tables, figures or [])


def _failed_runs(runs: xr.Dataset, failed: xr.DataArray) -> Table:
    dims = design_dims(runs, failed.dims)
    positions = np.argwhere(failed.transpose(*dims).values).tolist()
    rows: list[Row] = []
    for position in positions[:_FAILED_RUNS]:
        where = dict(zip(dims, position, strict=True))
        why = access.causes(runs.isel(where), xr.DataArray(True))
        absent = [name for name in responses(runs) if access.absent(runs.isel(where), name)]
        listed = labels.listing([labels.response(name) for name in absent])
        listed = "all" if len(absent) == len(responses(runs)) else listed
        rows.append([_place(runs, where), Cell("; ".join(why), "warning"), listed])
    caption = "Runs without an answer"
    if len(positions) > _FAILED_RUNS:
        caption += f" (the first {_FAILED_RUNS} of {len(positions)})"
    return Table(caption, ["Run", "Reason", "Missing responses"], rows)


def _place(runs: xr.Dataset, where: dict[str, int]) -> str:
    """Return the run's number in a sample and its varied parameters, in words."""
    named = [f"run {where['run']}"] if "run" in where else []
    if of_table(runs):
        named = [f"row {int(runs['row'][where['run']]) + 1}"]
    columns = (runs[name] for name in varied(runs) if runs[name].ndim)
    named += [labels.setting(column, [where[str(column.dims[0])]]) for column in columns]
    return ", ".join(named) or "the only run"


def _ranges(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    """Return one row per response; a grid names runs, a sample has moments and percentiles."""
    sample = is_sample(runs)
    heads = distribution.HEADS if "quantile" in analysis else ()
    rows: list[Row] = []
    for name in responses(runs):
        unit, array = display(runs[name]), usable(runs, name)
        array = array.where(np.isfinite(array))
        shown = unit(array.values)
        gaps = int(np.isnan(shown).sum())
        cells = [Cell("missing", "warning")] * 2
        if gaps < shown.size:
            numbers = np.nanmin(shown), np.nanmax(shown)
            details = [""] * 2 if sample else ["in every run"] * 2
            if not sample and array.min() < array.max():
                ends: Any = (array.argmin(...), array.argmax(...))
                details = [
                    _place(runs, {dim: int(i) for dim, i in position.items()}) for position in ends
                ]
            texts = (labels.number(float(number)) for number in numbers)
            cells = [
                Cell(text, "number", place) for text, place in zip(texts, details, strict=True)
            ]
        if heads:
            cells = [*distribution.summary(analysis, name, unit), *cells]
        doubt = beside(runs, analysis, name)
        detail = "; ".join(filter(None, (runs[name].attrs.get("long_name"), doubt)))
        response = Cell(labels.title(name), "warning" if doubt else "", detail)
        missing = Cell(str(gaps), "warning" if gaps else "number")
        rows.append([response, unit.symbol or "–", *cells, missing])
    head = ["Response", "Unit", *heads, "Smallest", "Largest", "Runs missing"]
    remarks = distribution.remarks(runs, analysis) if heads else []
    return Table("Range of each response", head, rows, remarks)
