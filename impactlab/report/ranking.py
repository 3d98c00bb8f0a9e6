"""Ranks of the parameters, and sentences that claim no more than is known.

A sentence names a parameter where its whole interval lies above zero and above the dummy
parameter's, and its index exceeds the numerical error; it says where only the latter fails. One
parameter ranks before another only where their intervals, with the numerical error, do not overlap.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.figures import access, labels, measures
from impactlab.figures.measures import (
    DELTA,
    MORRIS,
    PAWN,
    REGRESSION,
    SOBOL,
    Family,
    Index,
    analysed,
)
from impactlab.report.indices import in_units, named, with_margin
from impactlab.report.page import Cell, Table

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


def table(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> Table:
    """Return one row per response: the rank of each parameter, a range where intervals overlap."""
    measure = measures.ranking(family)
    names = measures.parameters(analysis)
    head = ["Response", *(labels.sentence(labels.parameter(name)) for name in names)]
    rows = [
        [named(analysis, name), *_ranks(measures.index(analysis, measure.name, name))]
        for name in analysed(runs, analysis)
    ]
    title = f"Ranks of the parameters by {family.title}, {measure.words}"
    explained = "noise: not distinguishable from zero or the dummy"
    if f"{measure.name}_numerical" in analysis:
        explained += "; numerical: not distinguishable from its numerical error"
    return Table(f"{title} ({explained})", head, rows)


def sentences(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> list[str]:
    """Return one or two sentences per response, on significant indices alone."""
    return [_sentence(runs, analysis, family, name) for name in analysed(runs, analysis)]


def _ranks(index: Index) -> list[Cell]:
    cells = []
    rows = zip(index.ranks, index.values, index.significant, index.numerically_lost, strict=True)
    for (best, worst), value, stands, lost in rows:
        if not np.isfinite(value):
            cells.append(Cell("undefined", "muted"))
        elif stands:
            cells.append(Cell(str(best) if best == worst else f"{best}–{worst}", "number"))
        else:
            cells.append(Cell("numerical" if lost else "noise", "muted"))
    return cells


def _sentence(runs: xr.Dataset, analysis: xr.Dataset, family: Family, name: str) -> str:
    response = labels.response(name)
    verdict = access.verdict(analysis, "sensitivity_verdict", name)
    values = analysis[measures.ranking(family).name].sel(response=name).values
    if not np.isfinite(values).any():
        why = f": {verdict.meaning or verdict.words}" if verdict else ""
        return f"The indices of the {response} are undefined{why}."
    text = " ".join(_WRITERS[family.title](runs, analysis, name))
    if verdict and not verdict.sound:
        text += f" Use these indices with caution: {verdict.meaning or verdict.words}."
    return text


def _sobol(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> Iterator[str]:
    """Yield the shares of single parameters, the largest first; then interactions."""
    response, index = labels.response(name), measures.index(analysis, "first_order", name)
    found = _shares(analysis, index, index.significant)
    lost = _shares(analysis, index, index.numerically_lost)
    if found:
        (first, share), *rest = found
        head = f"{_the(first)} alone explains {share} of the variance of the {response}"
        others = [f"{_the(key)} {share}" for key, share in rest]
        yield f"Over these ranges, {labels.listing([head, *others])}."
    if lost:
        yield (
            f"The numerical error leaves open which share of the variance of the {response} these "
            f"parameters explain alone: {'; '.join(f'{key}, {share}' for key, share in lost)}."
        )
    if not found and not lost:
        yield f"No parameter alone explains a significant share of the variance of the {response}."
    yield from _interactions(analysis, name)


def _interactions(analysis: xr.Dataset, name: str) -> Iterator[str]:
    """Yield a sentence where a total index exceeds its first order by more than their errors."""
    first = measures.index(analysis, "first_order", name)
    total = measures.index(analysis, "total_order", name)
    surplus = total.values - first.values
    reach = first.margins + total.margins + first.numerical + total.numerical
    beyond = total.significant & (surplus > np.maximum(reach, _WORTH))
    if beyond.any():
        at = int(np.argmax(np.where(beyond, surplus, -np.inf)))
        parameter = labels.parameter(measures.parameters(analysis)[at])
        yield f"With all its interactions, {_the(parameter)} contributes to {_share(total, at)}."


def _morris(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> Iterator[str]:
    """Yield how far the response moves, and whose effects are uneven."""
    response, found = labels.response(name), _significant(analysis, "morris_mu_star", name)
    if not found:
        yield f"No parameter changes the {response} significantly."
        return
    (first, value, margin), *rest = found[:_NAMED]
    moved = [f"{_the(first)} changes the {response} by {in_units(runs[name], value, margin)}"]
    moved += [f"{_the(key)} by {in_units(runs[name], v, m)}" for key, v, m in rest]
    yield f"Over its whole range, {labels.listing(moved)} on average."
    spread = analysis["morris_sigma"].sel(response=name).values
    sizes = dict(zip(measures.parameters(analysis), spread, strict=True))
    keys = {labels.parameter(key): float(value) for key, value in sizes.items()}
    if uneven := [_the(key) for key, value, _ in found if keys[key] > value]:
        yield (
            f"The effect of {labels.listing(uneven)} varies with the others or along its range "
            "by more than its mean (σ above µ*)."
        )


def _dependence(measure: str, label: str) -> Callable[..., Iterator[str]]:
    """Return a writer of sentences on indices that only measure dependence."""

    def write(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> Iterator[str]:
        found = _significant(analysis, measure, name)
        if not found:
            yield f"No dependence of the {labels.response(name)} exceeds the noise."
            return
        leads = (1, 1) in measures.index(analysis, measure, name).ranks
        listed = [f"{_the(key)} ({label} {with_margin(v, m)})" for key, v, m in found[:_NAMED]]
        yield f"The {labels.response(name)} depends{' most' * leads} on {_then(listed, leads)}."

    return write


def _regression(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> Iterator[str]:
    """Yield the parameters that the response rises or falls with, and how well a line fits."""
    found = _significant(analysis, "regression", name)
    listed = [
        f"{'rises' if value > 0 else 'falls'} with {_the(key)} ({with_margin(value, margin)})"
        for key, value, margin in found[:_NAMED]
    ]
    if listed:
        yield f"The {labels.response(name)} {labels.listing(listed)}."
    else:
        response = labels.response(name)
        yield f"The {response} neither rises nor falls significantly with any parameter."
    if "regression_r_squared" in analysis:
        share = float(analysis["regression_r_squared"].sel(response=name))
        little = ", so the coefficients do not show what it depends on" * (share < _POOR_FIT)
        yield f"The linear fit explains {100 * share:.0f} % of its variance{little}."


_WRITERS: dict[str, Callable[[xr.Dataset, xr.Dataset, str], Iterator[str]]] = {
    SOBOL.title: _sobol,
    MORRIS.title: _morris,
    DELTA.title: _dependence("delta", "delta"),
    PAWN.title: _dependence("pawn", "median distance"),
    REGRESSION.title: _regression,
}


def _the(parameter: str) -> str:
    """Return a parameter with its article; a symbol such as x1 has none."""
    return parameter if parameter[-1].isdigit() else f"the {parameter}"


def _then(listed: list[str], ordered: bool) -> str:
    """Join the list; the first comes before the others where it leads."""
    first, *rest = listed
    return (
        f"{first}, then on {labels.listing(rest)}" if ordered and rest else labels.listing(listed)
    )


def _significant(analysis: xr.Dataset, measure: str, name: str) -> list[tuple[str, float, float]]:
    """Return tuples (parameter in words, index, half-width), the largest magnitude first."""
    index = measures.index(analysis, measure, name)
    keys = [labels.parameter(key) for key in measures.parameters(analysis)]
    rows = zip(keys, index.values, index.margins, index.significant, strict=True)
    found = [(key, float(v), float(m)) for key, v, m, stands in rows if stands]
    return sorted(found, key=lambda entry: -abs(entry[1]))


def _shares(analysis: xr.Dataset, index: Index, where: NDArray[np.bool_]) -> list[tuple[str, str]]:
    """Return pairs (parameter, share) in words where a mask holds, the largest share first."""
    keys = [labels.parameter(key) for key in measures.parameters(analysis)]
    order = [at for at in np.argsort(-np.abs(index.values)) if where[at]]
    return [(keys[at], _share(index, at)) for at in order[:_NAMED]]


def _share(index: Index, at: int) -> str:
    """Return a share with the half-width of its interval and the numerical error, if known."""
    value, margin, error = (
        float(each[at]) for each in (index.values, index.margins, index.numerical)
    )
    decimals = 0 if margin >= _COARSE and value >= _SMALL else 1
    numerically = f", numerically ± {100 * error:.{decimals}f}" if error else ""
    return f"{100 * value:.{decimals}f} % (± {100 * margin:.{decimals}f}{numerically})"
