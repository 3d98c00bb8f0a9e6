"""How good the surrogate is, and where its indices differ from the sampled ones."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.figures import labels, measures
from impactlab.figures.measures import SURROGATE, asked
from impactlab.report import indices
from impactlab.report.section import Section
from impactlab.report.table import Cell, Table

GOOD = 0.9
"""Predictivity from which on a surrogate stands for the runs."""
_PAIRS = (("first_order", "first-order"), ("total_order", "total-order"))


def given(analysis: xr.Dataset) -> bool:
    """Whether a surrogate was fitted."""
    return "surrogate_q2" in analysis


def section(runs: xr.Dataset, analysis: xr.Dataset) -> Section:
    """Its error on held-out runs, and its indices beside those of the runs."""
    beside = SURROGATE.given(analysis)
    return Section(
        "surrogate",
        "Surrogate",
        "A surrogate was fitted to the runs and tried on runs that it had not seen.",
        _differences(runs, analysis) if beside and "first_order" in analysis else [],
        [_quality(runs, analysis)],
        ["surrogate_validation", "surrogate_indices"],
        indices.tables(runs, analysis, SURROGATE) if beside else [],
    )


def _quality(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    head = ["Response", "Predictivity Q² on held-out runs", "Root mean square error"]
    rows = []
    for name in asked(runs, analysis):
        q2 = float(analysis["surrogate_q2"].sel(response=name))
        cell = Cell("undefined", "muted")
        if np.isfinite(q2):
            poor = q2 < GOOD
            cell = Cell(
                labels.number(q2, 3), "warning" if poor else "number", "poor" if poor else ""
            )
        error = "–"
        if "surrogate_rmse" in analysis:
            rmse = float(analysis["surrogate_rmse"].sel(response=name))
            error = indices.in_units(runs[name], rmse, np.inf)
        rows.append([indices.named(analysis, name), cell, Cell(error, "number")])
    return Table(
        "The surrogate on held-out runs (1: perfect, 0: no better than the mean)", head, rows
    )


def _differences(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """A sentence a response and order whose two estimates do not overlap."""
    found = []
    keys = np.array([labels.parameter(key) for key in measures.parameters(analysis)])
    for name in asked(runs, analysis):
        for order, label in _PAIRS:
            sampled = measures.index(analysis, order, name)
            fitted = measures.index(analysis, f"surrogate_{order}", name)
            apart = np.abs(sampled.values - fitted.values) > sampled.margins + fitted.margins
            if apart.any():
                response, where = (
                    labels.sentence(labels.response(name)),
                    labels.listing(keys[apart].tolist()),
                )
                found.append(
                    f"{response}: the {label} indices of the runs and of the surrogate differ "
                    f"beyond their intervals for {where}."
                )
    return found
