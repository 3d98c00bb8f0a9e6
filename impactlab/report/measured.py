"""Measurements beside a study's models: a line of the answer, and a table."""

import json
from collections import Counter

import numpy as np
import xarray as xr

from impactlab.analysis.measurements import Agreement
from impactlab.figures import labels
from impactlab.report.page import Cell, Entry, Row, Section, Table
from impactlab.variables import attributes

_LEAD = (
    "Compatible: model and measurement differ by no more than the root sum of squares of the "
    "measurement's expanded uncertainty (k = 2) and the numerical uncertainty of the run. The "
    "uncertainty of the study's own parameters is not in it."
)
_MOST = 200  # largest number of rows of the table; those that are incompatible come first


def entries(analysis: xr.Dataset) -> list[Entry]:
    """Return the line of the answer: the verdicts, and the worst differences; [] without any."""
    if "compared_verdict" not in analysis:
        return []
    verdicts = analysis["compared_verdict"].values
    counted = Counter(verdicts.tolist())
    total = labels.counted(len(verdicts), "comparison")
    texts = [f"{counted[Agreement.COMPATIBLE]} of {total} compatible"]
    bad = analysis.isel(comparison=np.flatnonzero(verdicts == Agreement.INCOMPATIBLE))
    ratio = abs(bad["compared_difference"] / bad["compared_combined"]).values
    worst = [
        _difference(bad.isel(comparison=number)) for number in np.argsort(-ratio, kind="stable")[:3]
    ]
    if worst:
        which = "" if len(ratio) <= len(worst) else "the worst of the others: "
        texts.append(which + ", ".join(worst))
    excluded = {Agreement.NOT_JUDGED: "not judged", Agreement.OTHER_IMPACT: "of another impact"}
    texts += [f"{counted[kind]} {text}" for kind, text in excluded.items() if counted[kind]]
    models = all(analysis["compared_simulated"].values)
    return [("Beside another model" if models else "Beside measurements", "; ".join(texts))]


def _difference(row: xr.Dataset) -> str:
    """Return by how much the model is off: "peak force +2.5 % (± 0.6, stronge)"."""
    difference, width = _signed(row), _relative(row, "combined")
    case = str(row["compared_case"].item()).replace("_", " ")
    inside = ", ".join(filter(None, (f"± {width.removesuffix(' %')}", case)))
    name = labels.response(str(row["compared_quantity"].item()))
    return f"{name} {difference} ({inside})"


def _signed(row: xr.Dataset) -> str:
    sign = "+" if float(row["compared_difference"]) > 0 else ""
    return f"{sign}{_relative(row, 'difference')}"


def _relative(row: xr.Dataset, key: str) -> str:
    """Return a difference in per cent of the measured value, of zero in the quantity's unit."""
    number, measured = (float(row[f"compared_{name}"]) for name in (key, "measured"))
    if measured:
        return f"{labels.number(100 * number / abs(measured), 2)} %"
    quantity, units = (str(row[f"compared_{name}"].item()) for name in ("quantity", "units"))
    unit = labels.display(xr.DataArray([number], name=quantity, attrs=row.attrs | {"units": units}))
    return f"{labels.number(float(unit(number)), 2)} {unit.symbol}".rstrip()


def sections(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the section on measurements, or none."""
    if "compared_verdict" not in analysis or not analysis.sizes["comparison"]:
        return []
    verdicts = analysis["compared_verdict"].values
    order = np.argsort((verdicts - 1) % len(Agreement), kind="stable")  # those that agree last
    rows = [_row(runs, analysis.isel(comparison=number)) for number in order[:_MOST]]
    head = ["Measured", "Conditions", "Model", "Measured value", "Model's value", "Difference"]
    sources = (analysis[f"compared_{key}"].values.tolist() for key in ("source", "simulated"))
    remarks = [
        f"Source: {source}{' (values of another model, not measured)' if simulated else ''}"
        for source, simulated in dict(zip(*sources, strict=True)).items()
    ]
    if (left := verdicts.size - _MOST) > 0:
        remarks.append(f"{left} further rows are in analysis.nc.")
    meanings = [
        (_verdict(agreement), agreement.meaning) for agreement in Agreement if agreement in verdicts
    ]
    caption = "Each measurement beside each model"
    table = Table(caption, [*head, "Verdict"], rows, remarks, meanings)
    return [Section("measurements", "Beside measurements", _LEAD, tables=[table])]


def _verdict(verdict: Agreement) -> str:
    return verdict.name.lower().replace("_", " ")


def _row(runs: xr.Dataset, row: xr.Dataset) -> Row:
    verdict = list(Agreement)[int(row["compared_verdict"])]
    keys = "quantity", "units", "conditions", "case", "reason"
    quantity, units, conditions, case, reason = (str(row[f"compared_{key}"].item()) for key in keys)
    of_numbers = "measured", "uncertainty", "model", "numerical"
    numbers = [row[f"compared_{key}"].item() for key in of_numbers]
    attrs = row.attrs | {"units": units}
    unit = labels.display(xr.DataArray(numbers[:1], name=quantity, attrs=attrs))
    measured, uncertainty, model, numerical = unit(numbers).tolist()
    stated = [_condition(runs, *condition) for condition in json.loads(conditions).items()]
    difference = _signed(row) if np.isfinite(model) else "–"
    kind = "" if verdict.sound else "warning"
    return [
        Cell(labels.title(quantity)),
        ", ".join(stated) or "–",
        case.replace("_", " ") or "–",
        Cell(f"{labels.number(measured)} ± {labels.number(uncertainty, 2)} {unit.symbol}".rstrip()),
        Cell("–" if np.isnan(model) else _value(model, numerical, unit.symbol)),
        Cell(difference, "number"),
        Cell(_verdict(verdict), kind, reason),
    ]


def _value(model: float, numerical: float, symbol: str) -> str:
    width = f" ± {labels.number(numerical, 2)}" if np.isfinite(numerical) else ""
    return f"{labels.number(model)}{width} {symbol}".rstrip()


def _condition(runs: xr.Dataset, name: str, value: float | str) -> str:
    """Return one condition in words: "impact velocity = 0.99 m/s"."""
    attrs = runs[name].attrs if name in runs.coords else attributes(name)
    single = xr.DataArray(np.array([value]), dims=name, name=name, attrs=attrs)
    return labels.setting(single, [0])
