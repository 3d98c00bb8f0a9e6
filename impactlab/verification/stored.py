"""Outcomes of checks as a labelled dataset (findings.nc), and back.

Tables have one row per check on `name`, per comparison, per panel and per curve; each row names the
one it belongs to. The points of all curves follow one another on `point` (contiguous ragged arrays
of the CF conventions).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from impactlab.verification.finding import Comparison, Curve, Finding, Outcome, Panel

Row = dict[str, Any]
Kinds = dict[str, tuple[type, str]]
_CHECKS: Kinds = {
    "name": (str, "name of the check"),
    "title": (str, "title of the check"),
    "source": (str, "where the independent values come from"),
    "verdict": (str, "passed, failed, or error where the check came to no end"),
    "reason": (str, "the error that ended the check"),
    "seconds": (float, "time that the check took"),
}
_COMPARISONS: Kinds = {
    "check": (str, "check that the comparison belongs to"),
    "quantity": (str, "what is compared"),
    "where": (str, "the case"),
    "units": (str, "units of ours and independent"),
    "ours": (float, "value from the solver, in `units`"),
    "independent": (float, "value from the independent solution, in `units`"),
    "error": (float, "how far apart the two are, in the measure of `measure`"),
    "tolerance": (float, "largest error that passes, in the same measure"),
    "measure": (str, "what the error is relative to"),
    "passed": (bool, "whether the error is within the tolerance"),
}
_PANELS: Kinds = {
    "panel_check": (str, "check that the panel belongs to"),
    "panel_title": (str, "title of the panel"),
    "x_name": (str, "quantity on the x axis"),
    "x_units": (str, "units of x in this panel"),
    "y_name": (str, "quantity on the y axis"),
    "y_units": (str, "units of y in this panel"),
    "log": (bool, "whether both axes are logarithmic"),
}
_CURVES: Kinds = {
    "curve_panel": (int, "position on `panel` that the curve belongs to"),
    "curve_label": (str, "label of the curve"),
    "curve_independent": (bool, "whether the curve is from the independent solution"),
    "curve_points": (int, "number of points of the curve"),
}


def packed(outcomes: Sequence[Outcome]) -> xr.Dataset:
    """Return a dataset of all outcomes, without global attributes."""
    panels = [(outcome, panel) for outcome in outcomes for panel in outcome.finding.panels]
    curves = [(at, curve) for at, (_, panel) in enumerate(panels) for curve in panel.curves]
    checks = _table("name", _CHECKS, [_check_row(outcome) for outcome in outcomes])
    compared = _table("comparison", _COMPARISONS, [row for o in outcomes for row in _rows(o)])
    drawn = _table("panel", _PANELS, [_panel_row(*entry) for entry in panels])
    lines = _table("curve", _CURVES, [_curve_row(*entry) for entry in curves])
    points = {axis: ("point", _joined(curves, axis), _AXES[axis]) for axis in _AXES}
    dataset = xr.Dataset(checks | compared | drawn | lines | points)
    dataset["curve_points"].attrs["sample_dimension"] = "point"
    dataset["seconds"].attrs["units"] = "s"
    return dataset.set_coords([name for name in ("check", "quantity", "where") if name in dataset])


def unpacked(dataset: xr.Dataset) -> list[Outcome]:
    """Return the outcomes that a dataset of `packed` holds, in its order."""
    return [_outcome(dataset, row) for row in _read(dataset, _CHECKS)]


_AXES: dict[str, dict[str, str]] = {
    axis: {"long_name": f"{axis} of the curves' points, in `{axis}_units` of the panel"}
    for axis in ("x", "y")
}


def _table(dim: str, kinds: Kinds, rows: list[Row]) -> Row:
    """Return variables on `dim`, one per column, with the right types even without rows."""
    return {
        name: (dim, np.array([row[name] for row in rows], dtype=kind), {"long_name": words})
        for name, (kind, words) in kinds.items()
    }


def _check_row(outcome: Outcome) -> Row:
    return {name: getattr(outcome, name) for name in _CHECKS}


def _rows(outcome: Outcome) -> list[Row]:
    names = _COMPARISONS.keys() - {"check"}
    return [
        {"check": outcome.name} | {name: getattr(entry, name) for name in names}
        for entry in outcome.finding.comparisons
    ]


def _panel_row(outcome: Outcome, panel: Panel) -> Row:
    values = (outcome.name, panel.title, *panel.x, *panel.y, panel.log)
    return dict(zip(_PANELS, values, strict=True))


def _curve_row(panel: int, curve: Curve) -> Row:
    values = (panel, curve.label, curve.independent, np.size(curve.x))
    return dict(zip(_CURVES, values, strict=True))


def _joined(curves: list[tuple[int, Curve]], axis: str) -> np.ndarray[Any, Any]:
    parts = [np.asarray(getattr(curve, axis), dtype=float) for _, curve in curves]
    return np.concatenate([np.empty(0), *parts])


def _read(dataset: xr.Dataset, kinds: Kinds) -> list[Row]:
    """Return the rows of a table as plain Python values."""
    columns = [dataset[name].values.astype(kind).tolist() for name, (kind, _) in kinds.items()]
    return [dict(zip(kinds, row, strict=True)) for row in zip(*columns, strict=True)]


def _outcome(dataset: xr.Dataset, row: Row) -> Outcome:
    comparisons = [
        Comparison(**{key: entry[key] for key in entry.keys() - {"check", "passed"}})
        for entry in _read(dataset, _COMPARISONS)
        if entry["check"] == row["name"]
    ]
    finding = Finding(comparisons, _panels(dataset, row["name"]))
    given = {key: row[key] for key in row.keys() - {"verdict"}}
    return Outcome(finding=finding, **given)


def _panels(dataset: xr.Dataset, check: str) -> list[Panel]:
    curves = _curves(dataset)
    return [
        Panel(
            row["panel_title"],
            (row["x_name"], row["x_units"]),
            (row["y_name"], row["y_units"]),
            [curve for panel, curve in curves if panel == at],
            row["log"],
        )
        for at, row in enumerate(_read(dataset, _PANELS))
        if row["panel_check"] == check
    ]


def _curves(dataset: xr.Dataset) -> list[tuple[int, Curve]]:
    rows = _read(dataset, _CURVES)
    ends = np.cumsum([row["curve_points"] for row in rows], dtype=int)[:-1]
    parts = [np.split(dataset[axis].values, ends) for axis in _AXES]
    return [
        (row["curve_panel"], Curve(row["curve_label"], x, y, row["curve_independent"]))
        for row, x, y in zip(rows, *parts, strict=False)  # no curve: one empty part
    ]
