"""All indices of a sample as one tidy table: a row a number."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.figures.files import replaced
from impactlab.figures.reading import verdicts

_HEAD = (
    "index",
    "response",
    "parameter",
    "other_parameter",
    "base_samples",
    "value",
    "interval",
    "units",
    "estimator",
    "verdict",
)
_DIMS = ("response", "parameter", "other_parameter", "base_samples")
_BESIDE = ("_interval", "_numerical")
"""Endings of variables that are about an index and are none."""


def write_indices(analysis: xr.Dataset, path: Path) -> Path | None:
    """Write a row an index: what of, value, half-width of its interval, unit and verdict.

    Dummies are rows without a parameter. Units are SI, those of the response where an index has
    them. Returns the path; None, and no file, where the analysis has no index. Raises OSError
    where it cannot be written.
    """
    rows = list(_rows(analysis))
    if not rows:
        path.unlink(missing_ok=True)
        return None
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, _HEAD, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return path


def _rows(analysis: xr.Dataset) -> Iterator[dict[str, str]]:
    for key, array in analysis.data_vars.items():
        name = str(key)
        if _is_index(name, array):
            yield from _of(analysis, name, array)


def _is_index(name: str, array: xr.DataArray) -> bool:
    """Those on a parameter, and the dummies of such."""
    about = "parameter" in array.dims or name.startswith("dummy_")
    return about and "response" in array.dims and not name.endswith(_BESIDE)


def _of(analysis: xr.Dataset, name: str, array: xr.DataArray) -> Iterator[dict[str, str]]:
    """The rows of one variable, pairs of parameters once."""
    intervals = analysis.get(f"{name}_interval", xr.full_like(array, np.nan))
    halves = intervals.transpose(*array.dims).values
    for place, value in np.ndenumerate(array.values):
        where = {str(dim): at for dim, at in zip(array.dims, place, strict=True)}
        if "other_parameter" in where and where["other_parameter"] <= where["parameter"]:
            continue
        labels = {dim: str(analysis[dim].values[at]) for dim, at in where.items() if dim in _DIMS}
        verdict = verdicts.verdict(analysis, "sensitivity_verdict", labels["response"])
        yield labels | {
            "index": name,
            "value": f"{value:.9g}",
            "interval": f"{halves[place]:.3g}",
            "units": str(array.attrs.get("units", "1")),
            "estimator": str(array.attrs.get("estimator", "")),
            "verdict": verdict.flag if verdict else "",
        }
