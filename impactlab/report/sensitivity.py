"""The sections on sensitivity, in the order of sensobol (Puy et al. 2022, J. Stat. Softw. 102)."""

from __future__ import annotations

import xarray as xr

from impactlab.figures import access
from impactlab.figures.measures import (
    DELTA,
    MORRIS,
    PAWN,
    RANKED,
    REGRESSION,
    SOBOL,
    Family,
    asked,
)
from impactlab.report import indices, numerical, ranking, surrogate
from impactlab.report.section import Section

_FIGURES = {
    MORRIS.title: ("morris", "morris_plane"),
    DELTA.title: ("delta", "delta_indices"),
    PAWN.title: ("pawn", "pawn_indices"),
    REGRESSION.title: ("regression", "regression_indices"),
}
"""Anchor and figure of the families beside Sobol's."""


def sections(runs: xr.Dataset, analysis: xr.Dataset, file: str = "") -> list[Section]:
    """Indices, second order, convergence, ranking, other methods, surrogate; what there is.

    file: name of the file of all indices beside the page, "" for none.
    """
    if not asked(runs, analysis):
        return []
    found = [family for family in RANKED if family.given(analysis)]
    others = [family for family in found if family is not SOBOL]
    return [
        *([_sobol(runs, analysis)] if SOBOL in found else []),
        *([_second(runs, analysis)] if "second_order" in analysis else []),
        *([_convergence()] if "total_order_by_samples" in analysis else []),
        *([_ranking(runs, analysis, found[0], file)] if found else []),
        *(_other(runs, analysis, family) for family in others),
        *([surrogate.section(runs, analysis)] if surrogate.given(analysis) else []),
    ]


def last(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """What follows the failures: the numerical uncertainty, where it is known."""
    return [numerical.section(runs, analysis)] if numerical.given(analysis) else []


def _sobol(runs: xr.Dataset, analysis: xr.Dataset) -> Section:
    lead = (
        "A first-order index is the share of the variance that comes from a parameter "
        "alone; a total-order index adds all its interactions. Grey: not told from zero, or from "
        "the dummy parameter where one was sampled."
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
        "The share of the variance that comes from two parameters together, beyond what each "
        "brings alone.",
        figures=["sobol_second_order"],
        folded=[indices.second_order(runs, analysis)],
    )


def _convergence() -> Section:
    return Section(
        "index-convergence",
        "Convergence of the indices",
        "The indices from the first part of the sample alone, with nothing solved anew. An index "
        "that has not settled at the right end is not known better than its drift.",
        figures=[f"{measure.name}_convergence" for measure in SOBOL.measures],
    )


def _ranking(runs: xr.Dataset, analysis: xr.Dataset, first: Family, file: str) -> Section:
    lead = (
        "Sentences name significant parameters only, with the half-width of the "
        f"{access.confidence(analysis)} interval. Ranks are a range where intervals, widened by "
        "the numerical error where that is known, overlap."
    )
    return Section(
        "ranking",
        "Ranking",
        lead,
        ranking.sentences(runs, analysis, first),
        [ranking.table(runs, analysis, first)],
        files=[file] if file else [],
    )


def _other(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> Section:
    name, figure = _FIGURES[family.title]
    return Section(
        name,
        family.title,
        family.says,
        _told(runs, analysis, family),
        figures=[figure],
        folded=indices.tables(runs, analysis, family),
    )


def _told(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> list[str]:
    """Its sentences, unless the ranking has told them."""
    main = next(one for one in RANKED if one.given(analysis))
    return [] if family is main else ranking.sentences(runs, analysis, family)
