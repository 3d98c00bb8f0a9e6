"""Terminal output: the cost of a 3-D run, and its answers beside those of the beam models."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from rich import box
from rich.console import Console
from rich.table import Column, Table

from impactlab.fem3d.comparison.comparison import SOLID
from impactlab.fem3d.comparison.plan import Plan
from impactlab.figures import labels
from impactlab.figures.labels import display
from impactlab.study.quantities import amount, time
from impactlab.variables import UNLIKE, reasons

_NAMES = {SOLID: "3-D"}
_NARROW: dict[str, Any] = {"box": box.SIMPLE, "show_edge": False, "padding": 0}
"""Fits 80 columns."""
_WHOLE = 9.95
"""Difference in % from which on it is printed without a decimal."""
_FAR = 1e-3
"""PEEQ of elements that are not fully integrated, from which on it is printed."""


def print_plan(plan: Plan, workers: int | None, problems: Iterable[str]) -> None:
    """Print what is solved and what it costs, one line each, and the problems, if any.

    workers: None for a deck, which another program solves.
    """
    cost, across = plan.cost, plan.contact_radius / plan.element_size
    lines = {
        "case": f"{plan.case.file}, at {plan.case.impact.velocity:g} m/s",
        "element size": f"{1e3 * plan.element_size:g} mm in a patch of {1e3 * plan.patch:.3g} mm: "
        f"about {across:.2g} elements over the contact's radius",
        "duration": f"{1e3 * plan.duration:.4g} ms; {_contact(plan)}",
        "elements": f"{cost.elements:,}",
        "time steps": f"about {cost.steps:,}",
    }
    if workers:
        threads = labels.counted(workers, "thread")
        lines["wall"] = f"about {time(plan.seconds(workers))} on {threads}"
        lines["memory"] = f"about {amount(cost.memory_bytes)}"
    console = Console(soft_wrap=True)
    for name, text in lines.items():
        console.print(f"{name:15s}{text}", markup=False, highlight=False)
    for problem in problems:
        console.print(f"exceeds the limit: {problem}", markup=False, highlight=False)


def print_comparison(found: xr.Dataset) -> None:
    """Print one row per response: the 3-D value, and each beam model's with its difference in %.

    found: see compared. Below the table, the missing responses and the reasons, by model.
    """
    models = found["model"].values.tolist()
    right = [Column(name, justify="right") for name in map(_named, models)]
    table = Table(Column("response", no_wrap=True), *right, **_NARROW)
    for name in found["response"].values.tolist():
        table.add_row(*_row(found.sel(response=name)))
    console = Console()
    console.print(table)
    console.print("In %: difference from the 3-D FE model.", markup=False)
    for why in dict.fromkeys(UNLIKE.values()):
        which = labels.listing([name for name, given in UNLIKE.items() if given == why])
        console.print(f"not compared: {which}: {why}", markup=False)
    for reason, lacking in _missing(found).items():
        who = "all models" if lacking == [*map(_named, models)] else ", ".join(lacking)
        console.print(f"missing ({who}): {reason}", markup=False)


def print_yielding(solid: xr.Dataset) -> None:
    """Print one line per body or region that yields where the responses do not show it.

    solid: a dataset of fem3d.solver. Elements with one point beyond the middle yield all at once,
    and late in bending.
    """
    console = Console()
    sphere = float(solid["sphere_plastic_strain"])
    if sphere > 0.0:
        text = f"the sphere yields, too: PEEQ up to {sphere:.2%}, in plastic_dissipation alone"
        console.print(text, markup=False, highlight=False)
    coarse = float(solid["one_point_plastic_strain"])
    if coarse > _FAR:
        text = (
            f"elements with one integration point yield: PEEQ up to {coarse:.2%} away from contact "
            "and middle, where they are too stiff in bending"
        )
        console.print(text, markup=False, highlight=False)


def _missing(found: xr.Dataset) -> dict[str, list[str]]:
    """Return the models that lack a response, by the reason."""
    which: dict[str, list[str]] = {}
    for model in found["model"].values.tolist():
        for reason in reasons(int(found["status"].sel(model=model))):
            which.setdefault(reason, []).append(_named(model))
    return which


def _contact(plan: Plan) -> str:
    """Return a phrase about the duration of the first contact."""
    if np.isnan(plan.first_contact):
        return f"the first contact is longer than {1e3 * plan.case.longest:.4g} ms"
    contact = (
        f"an Euler-Bernoulli beam's first contact takes about {1e3 * plan.first_contact:.2g} ms"
    )
    if plan.duration > 1.5 * plan.usual_duration:
        return f"{contact}: for it alone, {1e3 * plan.usual_duration:.4g} ms would do"
    return contact


def _row(one: xr.Dataset) -> list[str]:
    """Return the cells of a row, in the unit that fits the largest value."""
    name = str(one["response"].item())
    values = one["value"].rename(name).assign_attrs(units=str(one["units"].item()))
    unit = display(values)
    shown, shares = unit(values), 100.0 * one["difference"].values
    cells = [_cell(value, share) for value, share in zip(shown, shares, strict=True)]
    return [f"{name} ({unit.symbol})" if unit.symbol else name, *cells]


def _cell(value: float, share: float) -> str:
    if np.isnan(value):
        return "missing"
    text = f"{value:.4g}"
    digits = 1 if abs(share) < _WHOLE else 0
    return text if np.isnan(share) else f"{text} {share:+.{digits}f}%"


def _named(model: str) -> str:
    return _NAMES.get(model) or "-".join(part.capitalize() for part in model.split("_"))
