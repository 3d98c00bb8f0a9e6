"""The answer to the paper: its figures, claims.html, claims.csv and numbers.csv in one folder."""

import csv
import logging
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.figures import labels
from impactlab.figures.access import count
from impactlab.figures.catalogue import applicable
from impactlab.figures.draw import draw
from impactlab.figures.labels import Display, display
from impactlab.figures.record import Figure
from impactlab.files import check_source, read_netcdf, replaced
from impactlab.paper.statements import judge_all
from impactlab.paper.statements.statement import Assessment, Ruling, Statement, Subject
from impactlab.provenance import provenance as made_now
from impactlab.report.page import Cell, Row, Table, pictures, provenance, write_page

log = logging.getLogger(__name__)

_FIXED = (
    *("velocity", "contact", "beam_model", "load", "sphere_radius", "beam_span", "beam_width"),
    *(
        "beam_depth",
        "beam_yield_stress",
        "nodes",
        "points",
        "rule",
        "scheme",
        "courant",
        "duration",
    ),
)
"""Parameters that captions list, in this order; the paper's tables hold the rest of its case."""
MIXED = "depends on the reading"  # what is said of a statement whose cases differ
SECTIONS = {
    Subject.STATEMENT: ("Statements", "Each entry has a test, and a row per case or reading."),
    Subject.MISPRINT: (
        "Misprints",
        "Each entry has what is printed, what holds instead, and the test that shows it.",
    ),
    Subject.OBSERVATION: (
        "Observations of ours",
        "The paper leaves these open, and does not state them: what a reader who repeats its work "
        "meets.",
    ),
}
"""Title and first paragraph of each section of assessments."""
Judged = Sequence[tuple[Statement, list[Assessment]]]
FIGURES = (
    ("05a", "fig05", "first_contact"),
    ("05b", "fig05", "force_history"),
    ("05c", "fig05", "displacement_history"),
    ("06a", "fig06_nodes", "nodes_convergence"),
    ("06b", "fig06_points", "points_convergence"),
    ("07", "fig07", "force_indentation_by_law"),
    ("08", "fig08", "contact_duration"),
    ("10a", "fig10", "plastic_strain"),
    ("10b", "fig10", "plastic_strain_depth"),
)
"""The number in the paper with a letter of ours, the study, and the name of our figure."""


def write_paper(folders: Sequence[Path], output: Path) -> None:
    """Draw the figures as figure_05a and so on, judge the statements, write both to `output`.

    folders: runs.nc of one study each, which statements need, and analysis.nc, which figures need,
    under the study's name. Raises OSError where a file cannot be read or written.
    """
    runs, stored = {}, {}
    for folder in folders:
        paths = folder / "runs.nc", folder / "analysis.nc"
        if not paths[0].exists():
            log.warning("%s holds no runs.nc: it is left out", folder)
            continue
        runs[folder.name] = solved = read_netcdf(paths[0], "runs")
        if not paths[1].exists():
            log.warning("%s holds no analysis.nc: its figures are left out", folder)
            continue
        analysis = read_netcdf(paths[1], "analysis")
        check_source(analysis, paths[1], solved, paths[0])
        stored[folder.name] = solved, analysis
    judged = judge_all(runs)
    groups = {kind: [entry for entry in judged if entry[0].kind is kind] for kind in Subject}
    statements = groups[Subject.STATEMENT]
    tally = Counter(_summary(assessments) for _, assessments in statements)
    cases = Counter(
        assessment.verdict for _, assessments in statements for assessment in assessments
    )
    drawings = []
    for number, study, name in FIGURES:
        figure = applicable(*stored[study]).get(name) if study in stored else None
        if figure:
            title = f"{number.lstrip('0')}. {figure.title}"
            caption = partial(_caption, study, figure)
            ours = replace(figure, name=f"figure_{number}", title=title, caption=caption)
            drawings.append((ours, stored[study]))
    draw(drawings, output / "figures", study="paper")
    _write_tables(judged, output)
    write_page(
        "statements.html.j2",
        output / "claims.html",
        package="impactlab.paper",
        tally=[(tally[ruling], ruling) for ruling in (*Ruling, MIXED) if tally[ruling]],
        cases=[(cases[ruling], ruling) for ruling in Ruling],
        overviews=[
            _overview(statements),
            _misprints("Misprints", groups[Subject.MISPRINT], "Printed", "Verdict on the print"),
            _misprints("Observations of ours", groups[Subject.OBSERVATION], "Test", "Verdict"),
        ],
        groups=[
            (kind.name.lower(), *text, [(entry, _cases(rows)) for entry, rows in groups[kind]])
            for kind, text in SECTIONS.items()
        ],
        pictures=pictures(output / "figures").values(),
        solved=_solved(runs),
        provenance=provenance(xr.Dataset(attrs=made_now()), "page"),
    )


def _caption(study: str, figure: Figure, runs: xr.Dataset, analysis: xr.Dataset) -> str:
    """Return what is plotted, what all runs share, and why these runs."""
    shown = figure.caption(runs, analysis)
    why = str(runs.attrs.get("description", ""))
    return " ".join(filter(None, (shown, _fixed(runs), why, f"Study: {study}.")))


def _fixed(runs: xr.Dataset) -> str:
    """Return a sentence on the parameters, numerics included, that are the same in all runs."""
    same = [runs[name] for name in _FIXED if name in runs and runs[name].size == 1]
    listed = [labels.setting(parameter, [0]) for parameter in same]
    return f"In all runs: {'; '.join(listed)}." if listed else ""


def _summary(assessments: Sequence[Assessment]) -> str:
    """Return the verdict of all cases; that of the first where others need a reading.

    MIXED where some hold and some do not. Cases that cannot be judged count where all are such.
    """
    verdicts = [
        assessment.verdict for assessment in assessments if assessment.verdict != Ruling.UNKNOWN
    ]
    if not verdicts:
        return str(Ruling.UNKNOWN)
    stand = {verdict != Ruling.FAILS for verdict in verdicts}
    return MIXED if len(stand) > 1 else str(verdicts[0])


def _overview(judged: Judged) -> Table:
    """Return one row per statement: the verdict, its first case, and the numbers of its cases."""
    rows: list[Row] = []
    for statement, assessments in judged:
        counts = Counter(assessment.verdict for assessment in assessments)
        first, verdict = assessments[0], _summary(assessments)
        stands = verdict in (Ruling.HOLDS, Ruling.READING)
        cells = [Cell(str(counts[ruling] or "–"), "number") for ruling in Ruling]
        answer = f"{labels.sentence(first.case)}: {first.why}"
        rows.append([statement.text, Cell(verdict, "" if stands else "warning"), answer, *cells])
    head = ["Statement of the paper", "Verdict", "First case or reading"]
    head += ["Cases: hold", "under a reading", "do not", "unknown"]
    return Table(
        "Statements: the verdict, and the number of cases or readings with each", head, rows
    )


def _misprints(caption: str, judged: Judged, heading: str, verdict: str) -> Table:
    """Return one row per misprint or observation: what is tested, what holds, and the verdict."""
    rows: list[Row] = [
        [statement.text, statement.holds, Cell(first.verdict, detail=statement.name)]
        for statement, (first, *_) in judged
    ]
    return Table(caption, [heading, "What holds", verdict], rows)


def _cases(assessments: Iterable[Assessment]) -> Table:
    """Return one row per case."""
    wrong = Ruling.FAILS, Ruling.UNKNOWN
    rows: list[Row] = [
        [
            assessment.case,
            _numbers(assessment) or "–",
            Cell(assessment.verdict, "warning" if assessment.verdict in wrong else ""),
            assessment.why,
        ]
        for assessment in assessments
    ]
    return Table("Judged cases", ["Case or reading", "Our number", "Verdict", "Why"], rows)


def _solved(data: Mapping[str, xr.Dataset]) -> Table:
    """Return one row per study: its runs, and where they come from."""
    rows: list[Row] = []
    for name, runs in data.items():
        keys = "title", "created", "source_revision"
        title, *origin = (str(runs.attrs.get(key, "")) for key in keys)
        rows.append([name, title, Cell(str(count(runs)), "number"), *origin])
    head = ["Study", "Title", "Runs", "Solved", "Source revision"]
    return Table("Studies that the verdicts are computed from", head, rows)


def _write_tables(judged: Judged, output: Path) -> None:
    """Write one row per assessment, and one row per number in SI units."""
    claims = [["claim", "kind", "statement", "case", "test", "numbers", "verdict", "why"]]
    numbers = [["claim", "case", "number", "value", "uncertainty", "units"]]
    for statement, assessments in judged:
        for assessment in assessments:
            about = [statement.name, statement.kind.name.lower(), statement.text]
            about += [assessment.case, statement.test]
            claims.append([*about, _numbers(assessment), str(assessment.verdict), assessment.why])
            for number in assessment.numbers:
                values = [f"{number.value:.9g}", f"{number.uncertainty:.3g}"]
                numbers.append(
                    [statement.name, assessment.case, number.name, *values, number.units]
                )
    output.mkdir(parents=True, exist_ok=True)
    for name, rows in (("claims.csv", claims), ("numbers.csv", numbers)):
        with replaced(output / name) as path, path.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)


def _numbers(assessment: Assessment) -> str:
    """Return "peak force: 12.34 ± 0.11 kN", with the digits that the uncertainty leaves."""
    texts = []
    for number in assessment.numbers:
        unit = display(xr.DataArray([number.value], attrs={"units": number.units}))
        if number.percent:
            unit = Display(100.0, "%")
        value, width = float(unit(number.value)), float(unit(number.uncertainty))
        digits = 5
        if value and width and np.isfinite(value) and np.isfinite(width):
            value_power, width_power = np.floor(np.log10([abs(value), width]))
            digits = int(np.clip(value_power - width_power + 2, 2, 5))
        text = labels.number(value, digits)
        if not width <= 0.5e-5 * abs(value):  # else it is below the fifth digit
            text = f"{text} ± {labels.number(width, 2) if np.isfinite(width) else 'unknown'}"
        texts.append(f"{number.name}: {text} {unit.symbol}".strip())
    return "; ".join(texts)
