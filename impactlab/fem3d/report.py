"""The beam models beside the 3-D FE model: sections of a study, and the report of one run."""

from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.fem3d.figures import witness
from impactlab.fem3d.plan import RunPlan
from impactlab.fem3d.wing import SOLID, UNLIKE
from impactlab.figures import labels
from impactlab.figures.access import responses, usable
from impactlab.figures.labels import Display, display
from impactlab.report.page import Cell, Row, Section, Table, write_listed
from impactlab.variables import reasons

_LEAD = (
    "Each model on its finest grid, with its numerical uncertainty (± of the value itself; none "
    "where a finer grid changes nothing), and its difference from the 3-D finite-element model."
)
_PARTS = (
    "The answer of the paper's beam is turned into that of the 3-D FE model one effect after the "
    "other: (1 + shear)(1 + elasticity)(1 + law) = 1 + all."
)


def sections(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the sections of a study with 3-D runs beside others, else none."""
    parts = []
    if witness.differ(runs):
        names = [name for name in responses(runs) if name != "energy_error"]
        tables = [_table(runs, analysis, name) for name in names]
        title = "Model by model"
        parts.append(Section("witness", title, _LEAD, tables=tables, figures=["witness"]))
    if witness.separable(runs):
        title = "Where the difference comes from"
        tables = [_effects(runs, analysis)]
        parts.append(Section("parts", title, _PARTS, tables=tables, figures=["witness_parts"]))
    return parts


def _table(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> Table:
    """Return one row per velocity and one column per model, the 3-D FE model first."""
    models = witness.models(runs)
    unit = display(usable(runs, name))
    sides = [witness.side(runs, analysis, name, model) for model in models]
    rows = []
    for position, speed in enumerate(runs["velocity"].values):
        cells = [_cell(unit, side, sides[0], position, name not in UNLIKE) for side in sides]
        rows.append([Cell(f"{labels.number(float(speed))} m/s", "number"), *cells])
    caption = labels.axis(labels.response(name), unit.symbol)
    if name in UNLIKE:
        caption = f"{caption}: not compared, {UNLIKE[name]}"
    return Table(caption, ["Impact velocity", *map(labels.beam_model, models)], rows)


def _cell(
    unit: Display, side: witness.Side, against: witness.Side, position: int, alike: bool
) -> Cell:
    value = float(side.value[position])
    if not np.isfinite(value):
        return Cell("missing", "warning")
    text = labels.number(float(unit(value)))
    width = float(side.uncertainty[position])
    if value and not width <= 1e-8 * abs(value):  # more than round-off
        text = f"{text} ± {_bound(100.0 * width / abs(value))}"
    gap = float(witness.difference([side], [against]).value[position])
    shown = alike and side is not against and np.isfinite(gap)
    detail = f"{labels.signed(gap)} against the 3-D FE model" if shown else ""
    return Cell(text, "number", detail)


def _effects(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    """Return one row per effect and one column per response."""
    effects = {name: witness.effects(runs, analysis, name) for name in witness.NAMES}
    rows = []
    for key, text in witness.EFFECTS.items():
        cells = [Cell(labels.sentence(text))]
        for side in (effects[name][key] for name in witness.NAMES):
            value, width = float(side.value), float(side.uncertainty)
            cell = Cell(f"{labels.signed(value)} ± {_bound(100.0 * width)}", "number")
            cells.append(cell if np.isfinite(value) else Cell("missing", "warning"))
        rows.append(cells)
    head = ["Effect", *(labels.title(name) for name in witness.NAMES)]
    return Table("Change of the answer of the paper's beam by each effect", head, rows)


def _bound(percent: float) -> str:
    return f"{labels.number(percent, 2)} %" if np.isfinite(percent) else "?"


_JUDGED = ("peak_force", "contact_duration", "maximum_indentation", "maximum_deflection")
"""Responses by which the models are ranked, and which the answer names."""


def write_comparison(
    responses: xr.Dataset, solid: xr.Dataset, plan: RunPlan, folder: Path, path: Path
) -> None:
    """Write the report of a 3-D run. Raises OSError where it cannot be written.

    responses: see comparison.compared. solid: a dataset of fem3d.solver. folder: of the figures.
    """
    case, file = plan.case, Path(plan.case.file)
    about = {
        "study": case.name,
        "study_file": str(file) if file.is_file() else "",
        "study_text": file.read_text("utf-8") if file.is_file() else "",
        "title": f"3-D finite elements beside the beam models: {case.name}",
        "content": "3-D run",
    }
    headline, answers = _answer(responses)
    elements = labels.counted(int(solid["number_of_elements"]), "element")
    write_listed(
        path,
        solid.assign_attrs(about),
        folder,
        headline=headline,
        answers=answers,
        sections=[Section("responses", "Responses", tables=[_run_table(responses)])],
        size=f"{elements}, {labels.counted(responses.sizes['model'] - 1, 'beam model')}",
        note="One mesh does not tell the numerical error of the 3-D FE model: a finer one does.",
        failed=str(solid.attrs.get("stopped", "")),
        reproduce=[(_command(plan), "solves it again")],
        index=path.parent / "../../index.html",
    )


def _answer(responses: xr.Dataset) -> tuple[str, list[tuple[str, str]]]:
    """Return the closest beam model with its differences, and those of the others, as entries."""
    shares = responses["difference"].sel(
        response=[n for n in _JUDGED if n in responses["response"]]
    )
    texts, distances = {}, {}
    for name in responses["model"].values.tolist():
        row = shares.sel(model=name).dropna("response")
        if name != SOLID and row.size:
            pairs = zip(row["response"].values.tolist(), row.values.tolist(), strict=True)
            texts[name] = ", ".join(
                f"{labels.response(key)} {labels.signed(x)}" for key, x in pairs
            )
            distances[name] = float(np.abs(row).mean())
    if not texts:
        return "No response of the beam models can be compared with the 3-D FE model", []
    closest, *others = sorted(texts, key=lambda name: distances[name])
    headline = f"The {labels.beam_model(closest)} model is closest to the 3-D FE model"
    entries = [(labels.beam_model(name), texts[name]) for name in others]
    return f"{headline}: {texts[closest]}", entries


def _run_table(responses: xr.Dataset) -> Table:
    """Return one row per response, one column per model."""
    models = responses["model"].values.tolist()
    rows: list[Row] = []
    for name in responses["response"].values.tolist():
        row = responses.sel(response=name)
        unit = display(row["value"].rename(name).assign_attrs(units=row["units"].item()))
        cells = []
        for value, share in zip(unit(row["value"].values), row["difference"].values, strict=True):
            if np.isnan(value):
                cells.append(Cell("missing", "warning"))
            else:
                detail = "" if np.isnan(share) else labels.signed(float(share))
                cells.append(Cell(labels.number(float(value)), "number", detail))
        rows.append(
            [Cell(labels.title(name), "", UNLIKE.get(name, "")), unit.symbol or "–", *cells]
        )
    status = zip(models, responses["status"].values.tolist(), strict=True)
    remarks = [
        f"Missing for {labels.beam_model(model)}: {reason}."
        for model, bits in status
        for reason in reasons(bits)
    ]
    caption = "Responses, with the difference from the 3-D FE model"
    return Table(caption, ["Response", "Unit", *map(labels.beam_model, models)], rows, remarks)


def _command(plan: RunPlan) -> str:
    """Return the command that solves this case again."""
    impact, file = plan.case.impact, Path(plan.case.file)
    lengths = {"element-size": plan.element_size, "patch": plan.patch}
    options = [f"--velocity '{impact.velocity:g} m/s' --contact {impact.contact}"]
    options += [f"--{name} '{1e3 * length:g} mm'" for name, length in lengths.items()]
    options.append(f"--duration '{1e3 * plan.duration:g} ms'")
    return " ".join(["impactlab witness", *([str(file)] if file.is_file() else []), *options])
