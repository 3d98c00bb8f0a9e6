"""Sections on sensitivity, in the order of sensobol (Puy et al. 2022, J. Stat. Softw. 102)."""

from __future__ import annotations

import numpy as np
import xarray as xr

from impactlab.figures import access, labels, measures
from impactlab.figures.measures import (
    DELTA,
    MORRIS,
    PAWN,
    RANKED,
    REGRESSION,
    SOBOL,
    SURROGATE,
    Family,
    analysed,
)
from impactlab.report import indices, ranking
from impactlab.report.page import Cell, Section, Table

_GOOD = 0.9
"""Smallest predictivity of a surrogate that may replace the runs."""
_PAIRS = (("first_order", "first-order"), ("total_order", "total-order"))
_FIGURES = {
    MORRIS.title: ("morris", "morris_plane"),
    DELTA.title: ("delta", "delta_indices"),
    PAWN.title: ("pawn", "pawn_indices"),
    REGRESSION.title: ("regression", "regression_indices"),
}
"""Anchor and figure of the families other than Sobol's."""


def sections(runs: xr.Dataset, analysis: xr.Dataset, file: str = "") -> list[Section]:
    """Return the sections that the analysis has data for.

    They are: indices, second order, convergence, ranking, other methods, surrogate. file: name of
    the file of all indices beside the page, "" for none.
    """
    if not analysed(runs, analysis):
        return []
    found = [family for family in RANKED if family.given(analysis)]
    return [
        *([_sobol(runs, analysis)] if SOBOL in found else []),
        *([_second(runs, analysis)] if "second_order" in analysis else []),
        *([_convergence()] if "total_order_by_samples" in analysis else []),
        *([_ranking(runs, analysis, found[0], file)] if found else []),
        *(_other(runs, analysis, one, one is found[0]) for one in found if one is not SOBOL),
        *([surrogate(runs, analysis)] if "surrogate_q2" in analysis else []),
    ]


def surrogate(runs: xr.Dataset, analysis: xr.Dataset) -> Section:
    """Return the section on the surrogate: its error on held-out runs, and its indices."""
    fitted = SURROGATE.given(analysis)
    return Section(
        "surrogate",
        "Surrogate",
        "A surrogate was fitted to the runs and tested on runs that it had not seen.",
        _differences(runs, analysis) if fitted and "first_order" in analysis else [],
        [_quality(runs, analysis)],
        ["surrogate_validation", "surrogate_indices"],
        indices.tables(runs, analysis, SURROGATE) if fitted else [],
    )


def _sobol(runs: xr.Dataset, analysis: xr.Dataset) -> Section:
    lead = (
        "A first-order index is the share of the variance that comes from a parameter "
        "alone; a total-order index adds all its interactions. Indices in grey are not "
        "distinguishable from zero, or from the dummy parameter where one was sampled."
    )
    return Section(
        "sensitivity",
        "First and total order",
        lead,
        tables=indices.tables(runs, analysis, SOBOL),
        figures=["sobol_indices"],
    )


def _second(runs: xr.Dataset, analysis: xr.Dataset) -> Section:
    return Section(
        "second-order",
        "Second order",
        "A second-order index is the share of the variance that comes from two parameters "
        "together, beyond what each contributes alone.",
        figures=["sobol_second_order"],
        folded=[indices.second_order(runs, analysis)],
    )


def _convergence() -> Section:
    return Section(
        "index-convergence",
        "Convergence of the indices",
        "The figures show the indices from the first part of the sample alone; no run was solved "
        "again. An index that still drifts at the right end is not known better than its drift.",
        figures=[f"{measure.name}_convergence" for measure in SOBOL.measures],
    )


def _ranking(runs: xr.Dataset, analysis: xr.Dataset, family: Family, file: str) -> Section:
    lead = (
        "The sentences name significant parameters only, with the half-width of the "
        f"{access.confidence(analysis)} interval. A rank is a range where intervals overlap; they "
        "are widened by the numerical error where it is known."
    )
    return Section(
        "ranking",
        "Ranking",
        lead,
        ranking.sentences(runs, analysis, family),
        [ranking.table(runs, analysis, family)],
        files=[file] if file else [],
    )


def _other(runs: xr.Dataset, analysis: xr.Dataset, family: Family, ranked: bool) -> Section:
    """Return the section of one method; its sentences, unless the ranking has them already."""
    name, figure = _FIGURES[family.title]
    return Section(
        name,
        family.title,
        family.meaning,
        [] if ranked else ranking.sentences(runs, analysis, family),
        figures=[figure],
        folded=indices.tables(runs, analysis, family),
    )


def _quality(runs: xr.Dataset, analysis: xr.Dataset) -> Table:
    head = ["Response", "Predictivity Q² on held-out runs", "Root mean square error"]
    rows = []
    for name in analysed(runs, analysis):
        q2 = float(analysis["surrogate_q2"].sel(response=name))
        cell = Cell("undefined", "muted")
        if np.isfinite(q2):
            poor = q2 < _GOOD
            kind, detail = ("warning", "poor") if poor else ("number", "")
            cell = Cell(labels.number(q2, 3), kind, detail)
        error = "–"
        if "surrogate_rmse" in analysis:
            rmse = float(analysis["surrogate_rmse"].sel(response=name))
            error = indices.in_units(runs[name], rmse, np.inf)
        rows.append([indices.named(analysis, name), cell, Cell(error, "number")])
    return Table(
        "The surrogate on held-out runs (1: perfect, 0: no better than the mean)", head, rows
    )


def _differences(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """Return one sentence per response and order whose two estimates do not overlap."""
    found = []
    keys = np.array([labels.parameter(key) for key in measures.parameters(analysis)])
    for name in analysed(runs, analysis):
        for order, label in _PAIRS:
            sampled = measures.index(analysis, order, name)
            fitted = measures.index(analysis, f"surrogate_{order}", name)
            apart = np.abs(sampled.values - fitted.values) > sampled.margins + fitted.margins
            if apart.any():
                where = labels.listing(keys[apart].tolist())
                found.append(
                    f"{labels.sentence(labels.response(name))}: the {label} indices of the runs "
                    f"and of the surrogate differ by more than their intervals for {where}."
                )
    return found
