"""Outcomes of checks as a labelled dataset (findings.nc), and back.

Tables have one row per check on `name`, per comparison, per panel and per curve; each row names the
one it belongs to. The points of all curves follow one another on `point` (contiguous ragged arrays
of the CF conventions).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from impactlab.verification.finding import Comparison, Curve, CurvePanel, Finding, Outcome

Kinds = dict[str, tuple[type, str]]
_CHECKS: Kinds = {
    "name": (str, "name of the check"),
    "title": (str, "title of the check"),
    "source": (str, "where the independent values come from"),
    "verdict": (str, "passed, failed, or error where the check came to no end"),
    "reason": (str, "the error that ended the check"),
    "seconds": (float, "time that the check took"),
    "reference": (str, "kind of the independent values"),
    "basis": (str, "what the uncertainty of the independent values is, and how it is known"),
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
    "uncertainty": (float, "of the independent value, in the same measure; NaN: not known"),
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


_POINTS = {
    axis: {"long_name": f"{axis} of the curves' points, in `{axis}_units` of the panel"}
    for axis in ("x", "y")
}


def packed(outcomes: Sequence[Outcome]) -> xr.Dataset:
    """Return a dataset of all outcomes, without global attributes."""
    checks = [[getattr(outcome, name) for name in _CHECKS] for outcome in outcomes]
    compared: list[list[Any]] = []
    panels: list[list[Any]] = []
    curves: list[list[Any]] = []
    points = {axis: [np.empty(0)] for axis in _POINTS}
    for outcome in outcomes:
        for entry in outcome.finding.comparisons:
            values = (getattr(entry, name) for name in _COMPARISONS if name != "check")
            compared.append([outcome.name, *values])
        for panel in outcome.finding.panels:
            for curve in panel.curves:
                row = [len(panels), curve.label, curve.independent, np.size(curve.x)]
                curves.append(row)
                for axis, parts in points.items():
                    parts.append(np.asarray(getattr(curve, axis), dtype=float))
            panels.append([outcome.name, panel.title, *panel.x, *panel.y, panel.log])
    dataset = xr.Dataset(
        _table("name", _CHECKS, checks)
        | _table("comparison", _COMPARISONS, compared)
        | _table("panel", _PANELS, panels)
        | _table("curve", _CURVES, curves)
        | {axis: ("point", np.concatenate(points[axis]), _POINTS[axis]) for axis in _POINTS}
    )
    dataset["curve_points"].attrs["sample_dimension"] = "point"
    dataset["seconds"].attrs["units"] = "s"
    return dataset.set_coords(["check", "quantity", "where"])


def _table(dim: str, kinds: Kinds, rows: Sequence[Sequence[Any]]) -> dict[str, Any]:
    """Return variables on `dim`, one per column, with the right types even without rows."""
    return {
        name: (dim, np.array([row[column] for row in rows], dtype=kind), {"long_name": long_name})
        for column, (name, (kind, long_name)) in enumerate(kinds.items())
    }


def unpacked(dataset: xr.Dataset) -> list[Outcome]:
    """Return the outcomes that a dataset of `packed` holds, in its order."""
    curves, panels = _read(dataset, _CURVES), list(enumerate(_read(dataset, _PANELS)))
    ends = np.cumsum([points for *_, points in curves], dtype=int)[:-1]
    parts = [np.split(dataset[axis].values, ends) for axis in _POINTS]
    lines: dict[int, list[Curve]] = {panel: [] for panel, _ in panels}
    for (panel, label, independent, _), x, y in zip(curves, *parts, strict=False):
        lines[panel].append(Curve(label, x, y, independent))  # no curve: one empty part
    outcomes = []
    for name, title, source, _, reason, seconds, *reference in _read(dataset, _CHECKS):
        compared = [row for row in _read(dataset, _COMPARISONS) if row[0] == name]
        finding = Finding(
            [Comparison(*values) for _, *values, _ in compared],
            [
                CurvePanel(heading, (x, x_units), (y, y_units), lines[panel], log)
                for panel, (check, heading, x, x_units, y, y_units, log) in panels
                if check == name
            ],
        )
        outcomes.append(Outcome(name, title, source, seconds, finding, reason, *reference))
    return outcomes


def _read(dataset: xr.Dataset, kinds: Kinds) -> list[tuple[Any, ...]]:
    """Return the rows of a table as plain Python values."""
    size = dataset[next(iter(kinds))].size
    lacking = {str: "", float: np.nan}  # of an earlier version
    columns = [
        dataset[name].values.astype(kind).tolist() if name in dataset else [lacking[kind]] * size
        for name, (kind, _) in kinds.items()
    ]
    return list(zip(*columns, strict=True))
