"""Which parameters matter most: ranks and plain sentences that claim no more than is known.

A parameter is named where its whole interval lies above zero and above the dummy parameter's, and
its index above what the numerical error could make of it; where only the latter fails, it is said.
One comes before another only where their intervals, with the numerical error, do not overlap.
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
    asked,
)
from impactlab.report.indices import in_units, named, told
from impactlab.report.table import Cell, Table

_COARSE = 0.02
"""Half-width from which on shares are told in whole per cent."""
_SMALL = 0.1
"""Share below which they never are."""
_WORTH = 0.02
"""Share of the variance from which on interactions are worth a sentence."""
_NAMED = 3
"""At most so many parameters are named in a sentence."""
POOR_FIT = 0.7
"""Share of the variance below which a linear fit says little (Saltelli et al. 2008, chapter 1)."""
Named = list[tuple[str, float, float]]
"""(parameter in words, index, half-width), the largest magnitude first."""


def table(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> Table:
    """A row a response: the rank of each parameter, a range where intervals overlap."""
    measure = measures.ranking(family)
    names = measures.parameters(analysis)
    head = ["Response", *(labels.sentence(labels.parameter(name)) for name in names)]
    rows = [
        [named(analysis, name), *_ranks(measures.index(analysis, measure.name, name))]
        for name in asked(runs, analysis)
    ]
    title = f"Ranks of the parameters by {family.title}, {measure.words}"
    explained = "noise: not told from zero or the dummy"
    if f"{measure.name}_numerical" in analysis:
        explained += "; numerical: not told from its numerical error"
    return Table(f"{title} ({explained})", head, rows)


def sentences(runs: xr.Dataset, analysis: xr.Dataset, family: Family) -> list[str]:
    """A sentence or two a response, on significant indices alone."""
    return [_sentence(runs, analysis, family, name) for name in asked(runs, analysis)]


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
    text = " ".join(_TELLERS[family.title](runs, analysis, name))
    if verdict and not verdict.sound:
        text += f" To be taken with care: {verdict.meaning or verdict.words}."
    return text


def _sobol(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> Iterator[str]:
    """What comes from single parameters, the largest share first; then interactions."""
    response, index = labels.response(name), measures.index(analysis, "first_order", name)
    found = _shares(analysis, index, index.significant)
    lost = _shares(analysis, index, index.numerically_lost)
    if found:
        (first, share), *rest = found
        head = f"{share} of the variance of the {response} comes from the {first} alone"
        others = [f"{share} from the {key}" for key, share in rest]
        yield f"At these ranges {labels.listing([head, *others])}."
    if lost:
        yield (
            f"The numerical error leaves open what share of the variance of the {response} comes "
            f"from these alone: {'; '.join(f'{key}, {share}' for key, share in lost)}."
        )
    if not found and not lost:
        yield f"No parameter alone has a significant share in the variance of the {response}."
    yield from _interactions(analysis, name)


def _interactions(analysis: xr.Dataset, name: str) -> Iterator[str]:
    """The parameter whose total index lies above its first order, beyond all that is in doubt."""
    first = measures.index(analysis, "first_order", name)
    total = measures.index(analysis, "total_order", name)
    surplus = total.values - first.values
    reach = first.margins + total.margins + first.numerical + total.numerical
    beyond = total.significant & (surplus > np.maximum(reach, _WORTH))
    if beyond.any():
        at = int(np.argmax(np.where(beyond, surplus, -np.inf)))
        parameter = labels.parameter(measures.parameters(analysis)[at])
        yield f"With all its interactions the {parameter} takes part in {_share(total, at)}."


def _morris(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> Iterator[str]:
    """How far the response moves, and whose effects are uneven."""
    response, found = labels.response(name), _significant(analysis, "morris_mu_star", name)
    if not found:
        yield f"No parameter moves the {response} significantly."
        return
    (first, value, margin), *rest = found[:_NAMED]
    moved = [f"the {first} moves the {response} by {in_units(runs[name], value, margin)}"]
    moved += [f"the {key} by {in_units(runs[name], v, m)}" for key, v, m in rest]
    yield f"Going through its whole range, {labels.listing(moved)} on average."
    spread = analysis["morris_sigma"].sel(response=name).values
    sizes = dict(zip(measures.parameters(analysis), spread, strict=True))
    keys = {labels.parameter(key): float(value) for key, value in sizes.items()}
    if uneven := [f"the {key}" for key, value, _ in found if keys[key] > value]:
        yield (
            f"The effect of {labels.listing(uneven)} changes with the others or along the range by "
            "more than its mean (σ above µ*)."
        )


def _dependence(measure: str, label: str) -> Callable[..., Iterator[str]]:
    """A teller of indices that say how much a response depends on a parameter, and no more."""

    def tell(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> Iterator[str]:
        found = _significant(analysis, measure, name)
        if not found:
            yield f"No dependence of the {labels.response(name)} stands out of the noise."
            return
        most = " most" * _leads(measures.index(analysis, measure, name))
        listed = [f"the {key} ({label} {told(v, m)})" for key, v, m in found[:_NAMED]]
        yield f"The {labels.response(name)} depends{most} on {_then(listed, bool(most))}."

    return tell


def _regression(runs: xr.Dataset, analysis: xr.Dataset, name: str) -> Iterator[str]:
    """With which parameters the response rises or falls, and whether a line tells it at all."""
    found = _significant(analysis, "regression", name)
    told_ = [
        f"{'rises' if value > 0 else 'falls'} with the {key} ({told(value, margin)})"
        for key, value, margin in found[:_NAMED]
    ]
    if told_:
        yield f"The {labels.response(name)} {labels.listing(told_)}."
    else:
        yield f"The {labels.response(name)} rises or falls with no parameter significantly."
    if "regression_r_squared" in analysis:
        share = float(analysis["regression_r_squared"].sel(response=name))
        little = ": the coefficients do not tell what it depends on" * (share < POOR_FIT)
        yield f"The linear fit explains {100 * share:.0f} % of its variance{little}."


_TELLERS: dict[str, Callable[[xr.Dataset, xr.Dataset, str], Iterator[str]]] = {
    SOBOL.title: _sobol,
    MORRIS.title: _morris,
    DELTA.title: _dependence("delta", "delta"),
    PAWN.title: _dependence("pawn", "median distance"),
    REGRESSION.title: _regression,
}


def _then(listed: list[str], ordered: bool) -> str:
    """The first before the others where it leads."""
    first, *rest = listed
    return (
        f"{first}, then on {labels.listing(rest)}" if ordered and rest else labels.listing(listed)
    )


def _leads(index: Index) -> bool:
    """Whether one parameter comes first beyond doubt."""
    return (1, 1) in index.ranks


def _significant(analysis: xr.Dataset, measure: str, name: str) -> Named:
    index = measures.index(analysis, measure, name)
    keys = [labels.parameter(key) for key in measures.parameters(analysis)]
    rows = zip(keys, index.values, index.margins, index.significant, strict=True)
    found = [(key, float(v), float(m)) for key, v, m, stands in rows if stands]
    return sorted(found, key=lambda entry: -abs(entry[1]))


def _shares(analysis: xr.Dataset, index: Index, asked: NDArray[np.bool_]) -> list[tuple[str, str]]:
    """(parameter, share) in words, the largest of those asked for first."""
    keys = [labels.parameter(key) for key in measures.parameters(analysis)]
    order = [at for at in np.argsort(-np.abs(index.values)) if asked[at]]
    return [(keys[at], _share(index, at)) for at in order[:_NAMED]]


def _share(index: Index, at: int) -> str:
    """With the half-width of its interval and, where that is known, the numerical error."""
    value, margin, error = (
        float(each[at]) for each in (index.values, index.margins, index.numerical)
    )
    decimals = 0 if margin >= _COARSE and value >= _SMALL else 1
    numerically = f", numerically ± {100 * error:.{decimals}f}" if error else ""
    return f"{100 * value:.{decimals}f} % (± {100 * margin:.{decimals}f}{numerically})"
