"""What trials on the corner cases found, for a terminal."""

from __future__ import annotations

import numpy as np
import xarray as xr
from rich.console import Console
from rich.table import Column, Table

from impactlab.study.adaptive.levels import relative

_AXES = ("nodes", "points", "courant")


def print_recommendation(found: xr.Dataset) -> None:
    """The recommended discretisation and, a row a response, the evidence for it.

    found: what study.adaptive.recommending found.
    """
    console = Console()
    best = int(found["recommended"])
    console.print(_headline(found, best), markup=False)
    table = Table(Column("response", no_wrap=True), "in all", *_AXES, "checked", "")
    told = _told(found, best) if best >= 0 else _least(found)
    for name in found["response"].values:
        shares = [_percent(told[column].sel(response=name)) for column in told.data_vars]
        remark = _remark(found.sel(response=name))
        table.add_row(str(name), *shares, *[""] * (len(table.columns) - 2 - len(shares)), remark)
    console.print(table)
    console.print(
        f"Relative uncertainty, the worst of {found.sizes['case']} corner cases: in all, and of "
        "each axis. Checked: the difference to the last rungs of all axes at once.",
        markup=False,
    )


def _headline(found: xr.Dataset, best: int) -> str:
    tolerance = f"{100 * found.attrs['tolerance']:g} %"
    if best < 0:
        most = int(found["nodes"].max())
        return f"No discretisation up to {most} nodes meets {tolerance} for any asked response."
    chosen = found.isel(candidate=best)
    grid = ", ".join(f"{axis} = {chosen[f'candidate_{axis}'].item():g}" for axis in _AXES)
    cost = chosen["candidate_cost"].item()
    return f"Cheapest for {tolerance}: {grid}; {cost:.2g} times the cost of the study's own."


def _told(found: xr.Dataset, best: int) -> xr.Dataset:
    """Columns on (response): the recommended candidate's uncertainty, its parts, and the check."""
    chosen = found.isel(candidate=best)
    last = found["nodes_value"].isel(nodes=-1, drop=True)
    parts = {
        axis: found[f"{axis}_uncertainty"].sel(
            {axis: chosen[f"candidate_{axis}"].item()}, drop=True
        )
        for axis in _AXES
    }
    parts["checked"] = found["check_difference"]
    shares = {name: relative(amount, last).max("case") for name, amount in parts.items()}
    return xr.Dataset({"all": chosen["candidate_uncertainty"]} | shares)


def _least(found: xr.Dataset) -> xr.Dataset:
    return xr.Dataset({"all": found["candidate_uncertainty"].min("candidate")})


def _remark(found: xr.Dataset) -> str:
    if not found["asked"]:
        return "not asked"
    return "" if found["reached"] else "none reaches it"


def _percent(share: xr.DataArray) -> str:
    value = float(share)
    return f"{float(f'{100 * value:.2g}'):g} %" if np.isfinite(value) else "no bound"
