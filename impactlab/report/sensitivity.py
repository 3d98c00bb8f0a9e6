"""Sections on sensitivity, in the order of sensobol (Puy et al. 2022, J. Stat. Softw. 102).

One parameter ranks before another only where their intervals, with the numerical error, do not
overlap.
"""

from __future__ import annotations

from collections.abc import Iterator

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
    Index,
    analysed,
)
from impactlab.report import indices
from impactlab.report.indices import in_units, named, uncertainty
from impactlab.report.page import Cell, Row, Section, Table

_COARSE = 0.02
"""Smallest half-width of shares given in whole per cent."""
_SMALL = 0.1
"""Smallest share given in whole per cent."""
_GOOD = 0.9
"""Smallest predictivity of a surrogate that may replace the runs."""
_FIGURES = {
    MORRIS.title: ("morris", "morris_plane"),
    DELTA.title: ("delta", "delta_indices"),
    PAWN.title: ("pawn", "pawn_indices"),
    REGRESSION.title: ("regression", "regression_indices"),
}
"""Anchor and figure of the families other than Sobol's."""


def sections(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the sections that the analysis has data for.

    They are: ranking, indices, second order, convergence, other methods, surrogate.
    """
    if not analysed(runs, analysis):
        return []
    families = [family for family in RANKED if family.given(analysis)]
    lead = (
        "A rank is a range where intervals overlap; they are widened by the numerical error where "
        "it is known."
    )
    found = list(_of_sobol(runs, analysis))
    if families:
        ranks = [_ranks(runs, analysis, families[0])]
        found.insert(0, Section("ranking", "Ranking", lead, tables=ranks, file="indices.csv"))
    for family in families:
        if family is not SOBOL:
            name, figure = _FIGURES[family.title]
            folded = indices.tables(runs, analysis, family)
            found.append(
                Section(name, family.title, family.meaning, figures=[figure], folded=folded)
            )
    return found + ([surrogate(runs, analysis)] if "surrogate_q2" in analysis else [])


def _of_sobol(runs: xr.Dataset, analysis: xr.Dataset) -> Iterator[Section]:
    """Yield the sections on the indices, those of second order, and their convergence."""
    if SOBOL.given(analysis):
        yield Section(
            "sensitivity",
            "First and total order",
            "A first-order index is the share of the variance that comes from a parameter "
            "alone; a total-order index adds all its interactions. Indices in grey are not "
            "distinguishable from zero.",
            tables=indices.tables(runs, analysis, SOBOL),
            figures=["sobol_indices"],
        )
    if "second_order" in analysis:
        yield Section(
            "second-order",
            "Second order",
            "A second-order index is the share of the variance that comes from two parameters "
            "together, beyond what each contributes alone.",
            figures=["sobol_second_order"],
            folded=[indices.second_order(runs, analysis)],
        )
    if "total_order_by_samples" in analysis:
        yield Section(
            "index-convergence",
            "Convergence of the indices",
            "The figures show the indices from the first part of the sample alone; no run was "
            "solved again. An index that still drifts at the right end is not known better than "
            "its drift.",
            figures=[f"{measure.name}_convergence" for measure in SOBOL.measures],
        )


def surrogate(runs: xr.Dataset, analysis: xr.Dataset) -> Section:
    """Return the section on the surrogate: its error on held-out runs, and its indices."""
    rows: list[Row] = []
    for name in analysed(runs, analysis):
        found = analysis.sel(response=name)
        q2 = float(found["surrogate_q2"])
        quality = Cell("undefined", "muted")
        if np.isfinite(q2):
            kind, detail = ("number", "") if q2 >= _GOOD else ("warning", "poor")
            quality = Cell(labels.number(q2, 3), kind, detail)
        error = "–"
        if "surrogate_rmse" in found:
            error = in_units(runs[name], float(found["surrogate_rmse"]))
        rows.append([named(analysis, name), quality, Cell(error, "number")])
    caption = "The surrogate on held-out runs (1: perfect, 0: no better than the mean)"
    head = ["Response", "Predictivity Q² on held-out runs", "Root mean square error"]
    fitted = SURROGATE.given(analysis)
    return Section(
        "surrogate",
        "Surrogate",
        "A surrogate was fitted to the runs and tested on runs that it had not seen.",
        _differences(runs, analysis) if fitted and "first_order" in analysis else [],
        [Table(caption, head, rows)],
        ["surrogate_validation", "surrogate_indices"],
        indices.tables(runs, analysis, SURROGATE) if fitted else [],
    )


def _differences(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """Return one sentence per response and order whose two estimates do not overlap."""
    found = []
    keys = np.array([labels.parameter(key) for key in measures.parameters(analysis)])
    for name in analysed(runs, analysis):
        for order in SOBOL.measures:
            sampled = measures.index(analysis, order.name, name)
            fitted = measures.index(analysis, f"surrogate_{order.name}", name)
            apart = np.abs(sampled.values - fitted.values) > sampled.margins + fitted.margins
            if apart.any():
                response = labels.sentence(labels.response(name))
                found.append(
                    f"{response}: the {order.words.replace(' ', '-')} indices of the runs and of "
                    "the surrogate differ by more than their intervals for "
                    f"{labels.listing(keys[apart].tolist())}."
                )
    return found


def _ranks(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> Table:
    """Return one row per response: the rank of each parameter, a range where intervals overlap."""
    measure = measures.ranking(family)
    rows: list[Row] = []
    for name in analysed(runs, analysis):
        index, row = measures.index(analysis, measure.name, name), [named(analysis, name)]
        for at, (best, worst) in enumerate(index.ranks):
            if not np.isfinite(index.values[at]):
                row.append(Cell("undefined", "muted"))
            elif index.significant[at]:
                row.append(Cell(str(best) if best == worst else f"{best}–{worst}", "number"))
            else:
                row.append(Cell("numerical" if index.numerically_lost[at] else "noise", "muted"))
        rows.append(row)
    dummy = " or the dummy" * (f"dummy_{measure.name}" in analysis)
    explained = f"noise: not distinguishable from zero{dummy}"
    if f"{measure.name}_numerical" in analysis:
        explained += "; numerical: not distinguishable from its numerical error"
    caption = f"Ranks of the parameters by {family.title}, {measure.words} ({explained})"
    names = [labels.sentence(labels.parameter(name)) for name in measures.parameters(analysis)]
    flags: list[access.Verdict] = []
    if "sensitivity_verdict" in analysis:
        flags = access.occurring(analysis["sensitivity_verdict"])
    meanings = [(flag.words, flag.meaning) for flag in flags if flag.meaning]
    return Table(caption, ["Response", *names], rows, meanings=meanings)


def share(index: Index, at: int) -> str:
    """Return a share with the half-width of its interval and the numerical error, if known."""
    value, margin, error = (
        float(each[at]) for each in (index.values, index.margins, index.numerical)
    )
    decimals = 0 if margin >= _COARSE and value >= _SMALL else 1
    numerically = f", numerically {uncertainty(error)}" if error else ""
    within = f"± {100 * margin:.{decimals}f}" if margin >= 0.0005 else uncertainty(margin)
    return f"{100 * value:.{decimals}f} % ({within}{numerically})"
