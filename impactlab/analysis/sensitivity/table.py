"""All indices of a study as a tidy table: a row a number, with its interval and verdict."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields
from pathlib import Path

import numpy as np
import xarray as xr

_OF = ("parameter", "other_parameter", "base_samples")
_BESIDE = ("sensitivity_verdict", "sensitivity_remarks", "imputed_share")


@dataclass(frozen=True)
class Row:
    """One index. low, high: ends of its interval; NaN where there is none. units: of all three."""

    response: str
    parameter: str
    other_parameter: str
    base_samples: str
    index: str
    value: float
    low: float
    high: float
    units: str
    verdict: str


def indices(analysis: xr.Dataset) -> xr.Dataset:
    """What of an analysis is sensitivity: indices, their intervals and verdicts; or nothing."""
    wanted = [name for name in analysis.data_vars if _is_index(analysis[name]) or name in _BESIDE]
    return analysis[wanted]


def rows(analysis: xr.Dataset) -> Iterator[Row]:
    """Every index of every response; of a pair of parameters once. None without a sample."""
    for name, array in indices(analysis).data_vars.items():
        if not str(name).endswith("_interval") and name not in _BESIDE:
            yield from _rows(analysis, array)


def write_csv(analysis: xr.Dataset, path: Path) -> None:
    """Write the rows under their names, in UTF-8; an empty cell stands for what is not given."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(field.name for field in fields(Row))
        writer.writerows(map(_cells, rows(analysis)))


def _rows(analysis: xr.Dataset, array: xr.DataArray) -> Iterator[Row]:
    margins = analysis.get(f"{array.name}_interval", xr.full_like(array, np.nan))
    margins = margins.transpose(*array.dims)
    verdicts = _verdicts(analysis["sensitivity_verdict"])
    units = analysis.get("response_units", xr.full_like(analysis["response"], ""))
    for place in np.ndindex(array.shape):
        at = dict(zip(map(str, array.dims), place, strict=True))
        if "other_parameter" in at and at["parameter"] >= at["other_parameter"]:
            continue
        labels = {dim: str(array[dim].values[at[dim]]) if dim in at else "" for dim in _OF}
        value, margin, response = float(array[at]), float(margins[at]), at["response"]
        yield Row(
            response=str(array["response"].values[response]),
            index=str(array.name),
            value=value,
            low=value - margin,
            high=value + margin,
            units=str(array.attrs.get("units", units.values[response])),
            verdict=verdicts[response],
            **labels,
        )


def _is_index(array: xr.DataArray) -> bool:
    known = set(array.dims) <= {"response", *_OF} and "response" in array.dims
    return known and ("estimator" in array.attrs or "parameter" in array.dims)


def _verdicts(array: xr.DataArray) -> list[str]:
    flags = np.atleast_1d(array.attrs["flag_values"]).tolist()
    names = dict(zip(flags, str(array.attrs["flag_meanings"]).split(), strict=True))
    return [names[code] for code in array.values.tolist()]


def _cells(row: Row) -> list[str]:
    cells = astuple(row)
    return ["" if isinstance(cell, float) and np.isnan(cell) else str(cell) for cell in cells]
