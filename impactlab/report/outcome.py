"""How the runs ended: how many miss a response, which and why."""

from __future__ import annotations

from dataclasses import dataclass

import xarray as xr

from impactlab.figures import access, labels
from impactlab.figures.access import count, design_dims, responses, usable, varied
from impactlab.report.table import Cell, Table

_LISTED = 20
"""Up to so many failed runs are listed one by one."""


@dataclass(frozen=True)
class Outcome:
    """Numbers of runs in all and failed; reasons with their numbers; the failed runs."""

    total: int
    failed: int
    reasons: Table
    listed: Table


def outcome(runs: xr.Dataset) -> Outcome:
    """A run failed when its status says so, or when one of its responses is missing."""
    failed = access.failed(runs)
    found = access.causes(runs, failed)
    rows = [[Cell(labels.sentence(why)), Cell(str(n), "number")] for why, n in found.items()]
    reasons = Table("Why", ["Reason", "Runs"], rows)
    number = int(failed.sum())
    return Outcome(count(runs), number, reasons, _listed(runs, failed, number))


def place(runs: xr.Dataset, where: dict[str, int]) -> str:
    """Which run it is, by its varied parameters in words."""
    named = [f"run {where['run']}"] if "run" in where else []
    for name in varied(runs):
        text = labels.values(runs[name], [where[str(dim)] for dim in runs[name].dims])[0]
        named.append(f"{labels.parameter(name)} = {text}{labels.unit(runs[name])}")
    return ", ".join(named) or "the only run"


def _listed(runs: xr.Dataset, failed: xr.DataArray, number: int) -> Table:
    dims = design_dims(runs, failed.dims)
    rows = []
    for position in list(zip(*failed.transpose(*dims).values.nonzero(), strict=True))[:_LISTED]:
        where = {dim: int(at) for dim, at in zip(dims, position, strict=True)}
        why = access.causes(runs.isel(where), xr.DataArray(True))
        absent = [
            labels.response(name)
            for name in responses(runs)
            if bool(access.absent(usable(runs, name).isel(where)))
        ]
        rows.append(
            [
                Cell(place(runs, where)),
                Cell("; ".join(why), "warning"),
                Cell(_all_or(absent, len(responses(runs)))),
            ]
        )
    more = f" (the first {_LISTED} of {number})" if number > _LISTED else ""
    return Table(f"Failed runs{more}", ["Run", "Reason", "Missing responses"], rows)


def _all_or(names: list[str], total: int) -> str:
    return "all" if len(names) == total else labels.listing(names)
