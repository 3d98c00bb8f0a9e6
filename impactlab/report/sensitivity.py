"""Sobol indices in tables and in sentences."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from impactlab.figures.reading import verdicts, words
from impactlab.figures.reading.contents import known, responses
from impactlab.report.table import Cell, Table

_ORDERS = {"first_order": "First-order Sobol indices", "total_order": "Total-order Sobol indices"}
_COARSE = 0.02
"""Half-width from which on shares are told in whole per cent."""
_NAMED = 3
"""At most so many parameters are named in a sentence."""


def tables(runs: xr.Dataset, analysis: xr.Dataset) -> list[Table]:
    """A table an order: responses by parameters, index ± half-width of its interval."""
    if not all(order in analysis for order in _ORDERS):
        return []
    parameters = [str(name) for name in analysis["parameter"].values]
    head = ["Response", *(words.sentence(words.parameter(name)) for name in parameters)]
    return [
        Table(
            f"{caption}, with half-widths of the {verdicts.confidence(analysis)} intervals",
            head,
            [_row(analysis, order, name) for name in responses(runs) if known(analysis, name)],
        )
        for order, caption in _ORDERS.items()
    ]


def sentences(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """A sentence a response, on significant indices alone; none without the analysis."""
    if not all(order in analysis for order in _ORDERS):
        return []
    return [_sentence(analysis, name) for name in responses(runs) if known(analysis, name)]


def _row(analysis: xr.Dataset, order: str, name: str) -> list[Cell]:
    values, margins = _index(analysis, order, name)
    cells = [_cell(value, margin) for value, margin in zip(values, margins, strict=True)]
    return [Cell(words.sentence(words.response(name))), *cells]


def _cell(value: float, margin: float) -> Cell:
    if not np.isfinite(value):
        return Cell("undefined", "muted")
    text = f"{round(value, 2) + 0.0:.2f}".replace("-", "−")
    if np.isfinite(margin):
        text += f" ± {margin:.2f}"
    return Cell(text, "number" if abs(value) > margin else "muted")


def _sentence(analysis: xr.Dataset, name: str) -> str:
    response = words.response(name)
    verdict = verdicts.verdict(analysis, "sensitivity_verdict", name)
    values, _ = _index(analysis, "first_order", name)
    if not np.isfinite(values).any():
        why = f": {verdict.meaning or verdict.words}" if verdict else ""
        return f"The indices of the {response} are undefined{why}."
    parts = [*_first(analysis, name), *_interactions(analysis, name)]
    text = " ".join(parts)
    if verdict and not verdict.sound:
        text += f" To be taken with care: {verdict.meaning or verdict.words}."
    return text


def _first(analysis: xr.Dataset, name: str) -> Iterator[str]:
    """What comes from single parameters, the largest share first."""
    response = words.response(name)
    shares = [
        f"{_share(value, margin)} from the {words.parameter(parameter)}"
        for parameter, value, margin in _significant(analysis, "first_order", name)
    ]
    if not shares:
        yield f"No parameter alone has a significant share in the variance of the {response}."
        return
    head, *rest = shares[:_NAMED]
    first = head.replace(" from the ", f" of the variance of the {response} comes from the ", 1)
    yield f"At these ranges {words.listing([f'{first} alone', *rest])}."


def _interactions(analysis: xr.Dataset, name: str) -> Iterator[str]:
    """The parameter whose total index lies above its first-order index beyond both intervals."""
    first, first_margin = _index(analysis, "first_order", name)
    total, total_margin = _index(analysis, "total_order", name)
    surplus = total - first
    beyond = np.where(surplus > first_margin + total_margin, surplus, -np.inf)
    if beyond.size and np.isfinite(beyond.max()):
        at = int(np.argmax(beyond))
        parameter = words.parameter(str(analysis["parameter"].values[at]))
        share = _share(total[at], total_margin[at])
        yield f"With all its interactions the {parameter} takes part in {share}."


def _significant(analysis: xr.Dataset, order: str, name: str) -> list[tuple[str, float, float]]:
    """(parameter, index, half-width) where zero lies outside the interval, the largest first."""
    values, margins = _index(analysis, order, name)
    named = zip(analysis["parameter"].values, values, margins, strict=True)
    found = [(str(key), float(v), float(m)) for key, v, m in named if v > m]
    return sorted(found, key=lambda entry: -entry[1])


def _index(analysis: xr.Dataset, order: str, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Index and half-width on (parameter,); infinite half-widths where none is given."""
    values = analysis[order].sel(response=name).values
    interval = analysis.get(f"{order}_interval")
    if interval is None:
        return values, np.full_like(values, np.inf)
    return values, np.nan_to_num(interval.sel(response=name).values, nan=np.inf)


def _share(value: float, margin: float) -> str:
    decimals = 0 if margin >= _COARSE else 1
    return f"{100 * value:.{decimals}f} % (± {100 * margin:.{decimals}f})"
