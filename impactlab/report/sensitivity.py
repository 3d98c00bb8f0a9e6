"""Sections on sensitivity, in the order of sensobol (Puy et al. 2022, J. Stat. Softw. 102).

The sentences claim no more than is known. A sentence names a parameter where its whole interval
lies above zero (and above the dummy's, where the method has one) and its index exceeds the
numerical error; it says where only the latter fails. One parameter ranks before another only where
their intervals, with the numerical error, do not overlap.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

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
from impactlab.report.indices import in_units, named, with_margin
from impactlab.report.page import Cell, Row, Section, Table

_COARSE = 0.02
"""Smallest half-width of shares given in whole per cent."""
_SMALL = 0.1
"""Smallest share given in whole per cent."""
_WORTH = 0.02
"""Smallest share of the variance of interactions that are worth a sentence."""
_NAMED = 3
"""Largest number of parameters in a sentence."""
_POOR_FIT = 0.7
"""Share of the variance below which a linear fit says little (Saltelli et al. 2008, chapter 1)."""
_GOOD = 0.9
"""Smallest predictivity of a surrogate that may replace the runs."""
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
    families = [family for family in RANKED if family.given(analysis)]
    found = _of_sobol(runs, analysis)
    for family in families[:1]:
        lead = (
            "The sentences name significant parameters only, with the half-width of the "
            f"{access.confidence(analysis)} interval. A rank is a range where intervals overlap; "
            "they are widened by the numerical error where it is known."
        )
        said, ranked = sentences(runs, analysis, family), [_ranks(runs, analysis, family)]
        files = [file] if file else []
        found.append(Section("ranking", "Ranking", lead, said, ranked, files=files))
    for family in families:
        if family is not SOBOL:
            name, figure = _FIGURES[family.title]
            said = [] if family is families[0] else sentences(runs, analysis, family)
            folded = indices.tables(runs, analysis, family)
            found.append(
                Section(name, family.title, family.meaning, said, figures=[figure], folded=folded)
            )
    return found + ([surrogate(runs, analysis)] if "surrogate_q2" in analysis else [])


def _of_sobol(runs: xr.Dataset, analysis: xr.Dataset) -> list[Section]:
    """Return the sections on the indices, those of second order, and their convergence."""
    found = []
    if SOBOL.given(analysis):
        section = Section(
            "sensitivity",
            "First and total order",
            "A first-order index is the share of the variance that comes from a parameter "
            "alone; a total-order index adds all its interactions. Indices in grey are not "
            "distinguishable from zero.",
            tables=indices.tables(runs, analysis, SOBOL),
            figures=["sobol_indices"],
        )
        found.append(section)
    if "second_order" in analysis:
        section = Section(
            "second-order",
            "Second order",
            "A second-order index is the share of the variance that comes from two parameters "
            "together, beyond what each contributes alone.",
            figures=["sobol_second_order"],
            folded=[indices.second_order(runs, analysis)],
        )
        found.append(section)
    if "total_order_by_samples" in analysis:
        section = Section(
            "index-convergence",
            "Convergence of the indices",
            "The figures show the indices from the first part of the sample alone; no run was "
            "solved again. An index that still drifts at the right end is not known better than "
            "its drift.",
            figures=[f"{measure.name}_convergence" for measure in SOBOL.measures],
        )
        found.append(section)
    return found


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
    return Table(caption, ["Response", *names], rows)


def sentences(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> list[str]:
    """Return one or two sentences per response, on significant indices alone."""
    said = []
    for name in analysed(runs, analysis):
        verdict = access.verdict(analysis, "sensitivity_verdict", name)
        why = f": {verdict.meaning or verdict.words}" if verdict else ""
        index = measures.index(analysis, measures.ranking(family).name, name)
        text = f"The indices of the {labels.response(name)} are undefined{why}."
        if np.isfinite(index.values).any():
            text = " ".join(_WRITERS[family.title](runs, analysis, name, index))
            if verdict and not verdict.sound:
                text += f" Use these indices with caution{why}."
        said.append(text)
    return said


def _sobol(runs: xr.Dataset, analysis: xr.Dataset, name: str, total: Index) -> Iterator[str]:
    """Yield the shares of single parameters, then interactions beyond all errors."""
    response, index = labels.response(name), measures.index(analysis, "first_order", name)
    found = _strongest(analysis, index, index.significant)[:_NAMED]
    lost = _strongest(analysis, index, index.numerically_lost)[:_NAMED]
    if found:
        (first, at), *rest = found
        head = f"{_the(first)} alone explains {share(index, at)} of the variance of the {response}"
        others = [f"{_the(key)} {share(index, at)}" for key, at in rest]
        yield f"Over these ranges, {labels.listing([head, *others])}."
    if lost:
        listed = "; ".join(f"{key}, {share(index, at)}" for key, at in lost)
        yield (
            f"The numerical error leaves open which share of the variance of the {response} these "
            f"parameters explain alone: {listed}."
        )
    if not found and not lost:
        yield f"No parameter alone explains a significant share of the variance of the {response}."
    surplus = total.values - index.values
    reach = index.margins + total.margins + index.numerical + total.numerical
    beyond = total.significant & (surplus > np.maximum(reach, _WORTH))
    if beyond.any():
        at = int(np.argmax(np.where(beyond, surplus, -np.inf)))
        parameter = labels.parameter(measures.parameters(analysis)[at])
        yield f"With all its interactions, {_the(parameter)} contributes to {share(total, at)}."


def _morris(runs: xr.Dataset, analysis: xr.Dataset, name: str, index: Index) -> Iterator[str]:
    """Yield how far the response moves, and whose effects are uneven."""
    found = _strongest(analysis, index, index.significant)
    if not found:
        yield f"No parameter changes the {labels.response(name)} significantly."
        return
    moved: list[str] = []
    for key, at in found[:_NAMED]:
        verb = "" if moved else f" changes the {labels.response(name)}"
        effect = in_units(runs[name], index.values[at], index.margins[at])
        moved.append(f"{_the(key)}{verb} by {effect}")
    yield f"Over its whole range, {labels.listing(moved)} on average."
    spread = analysis["morris_sigma"].sel(response=name).values
    if uneven := [_the(key) for key, at in found if spread[at] > index.values[at]]:
        yield (
            f"The effect of {labels.listing(uneven)} varies with the others or along its range "
            "by more than its mean (σ above µ*)."
        )


def _dependence(
    runs: xr.Dataset, analysis: xr.Dataset, name: str, index: Index, *, label: str
) -> Iterator[str]:
    """Yield the parameters with the largest indices that only measure dependence."""
    listed = [
        f"{_the(key)} ({label} {with_margin(index.values[at], index.margins[at])})"
        for key, at in _strongest(analysis, index, index.significant)[:_NAMED]
    ]
    if not listed:
        yield f"No dependence of the {labels.response(name)} exceeds the noise."
    elif (1, 1) in index.ranks:
        then = f", then on {labels.listing(listed[1:])}" * (len(listed) > 1)
        yield f"The {labels.response(name)} depends most on {listed[0]}{then}."
    else:
        yield f"The {labels.response(name)} depends on {labels.listing(listed)}."


def _regression(runs: xr.Dataset, analysis: xr.Dataset, name: str, index: Index) -> Iterator[str]:
    """Yield the parameters that the response rises or falls with, and how well a line fits."""
    response = labels.response(name)
    listed = []
    for key, at in _strongest(analysis, index, index.significant)[:_NAMED]:
        value, margin = index.values[at], index.margins[at]
        moves = "rises" if value > 0 else "falls"
        listed.append(f"{moves} with {_the(key)} ({with_margin(value, margin)})")
    if listed:
        yield f"The {response} {labels.listing(listed)}."
    else:
        yield f"The {response} neither rises nor falls significantly with any parameter."
    if "regression_r_squared" in analysis:
        share = float(analysis["regression_r_squared"].sel(response=name))
        little = ", so the coefficients do not show what it depends on" * (share < _POOR_FIT)
        yield f"The linear fit explains {100 * share:.0f} % of its variance{little}."


_WRITERS: dict[str, Callable[[xr.Dataset, xr.Dataset, str, Index], Iterator[str]]] = {
    SOBOL.title: _sobol,
    MORRIS.title: _morris,
    DELTA.title: partial(_dependence, label="delta"),
    PAWN.title: partial(_dependence, label="median distance"),
    REGRESSION.title: _regression,
}


def _the(parameter: str) -> str:
    """Return a parameter with its article; a symbol such as x1 has none."""
    return parameter if parameter[-1].isdigit() else f"the {parameter}"


def _strongest(
    analysis: xr.Dataset, index: Index, where: NDArray[np.bool_]
) -> list[tuple[str, int]]:
    """Return parameters in words and their places where a mask holds, by falling magnitude."""
    keys = [labels.parameter(key) for key in measures.parameters(analysis)]
    order = np.argsort(-np.abs(index.values), kind="stable").tolist()
    return [(keys[at], at) for at in order if where[at]]


def share(index: Index, at: int) -> str:
    """Return a share with the half-width of its interval and the numerical error, if known."""
    value, margin, error = (
        float(each[at]) for each in (index.values, index.margins, index.numerical)
    )
    decimals = 0 if margin >= _COARSE and value >= _SMALL else 1
    numerically = f", numerically ± {100 * error:.{decimals}f}" if error else ""
    return f"{100 * value:.{decimals}f} % (± {100 * margin:.{decimals}f}{numerically})"
