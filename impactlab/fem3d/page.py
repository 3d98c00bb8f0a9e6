"""The report of one 3-D run beside the beam models, which the index of all results lists."""

from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.fem3d.plan import RunPlan
from impactlab.fem3d.wing import SOLID, UNLIKE
from impactlab.figures import labels
from impactlab.figures.labels import display
from impactlab.report.page import Cell, Row, Section, Table, write_listed
from impactlab.variables import reasons

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
        sections=[Section("responses", "Responses", tables=[_table(responses)])],
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


def _table(responses: xr.Dataset) -> Table:
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
