"""Terminal output: the cost of a 3-D run, and its answers beside those of the beam models."""

from __future__ import annotations

import numpy as np
import xarray as xr
from rich import box
from rich.console import Console
from rich.table import Column, Table

from impactlab.fem3d.comparison.plan import Plan
from impactlab.figures import labels
from impactlab.figures.labels import display
from impactlab.model.impact import SOLID
from impactlab.study.quantities import amount, time
from impactlab.variables import UNLIKE, reasons

_WHOLE = 9.95
"""Difference in % from which on it is printed without a decimal."""
_FAR = 1e-3
"""PEEQ of elements that are not fully integrated, from which on it is printed."""


def print_plan(plan: Plan, workers: int | None, problem: str) -> None:
    """Print what is solved and what it costs, one line each, and the problem, if any.

    workers: None for a deck, which another program solves.
    """
    cost, across = plan.cost, plan.contact_radius / plan.element_size
    contact = f"the first contact is longer than {1e3 * plan.case.longest:.4g} ms"
    if not np.isnan(plan.first_contact):
        lasting = f"{1e3 * plan.first_contact:.2g} ms"
        contact = f"an Euler-Bernoulli beam's first contact takes about {lasting}"
        if plan.duration > 1.5 * plan.usual_duration:
            contact += f": for it alone, {1e3 * plan.usual_duration:.4g} ms would do"
    lines = {
        "case": f"{plan.case.file}, at {plan.case.impact.velocity:g} m/s",
        "element size": f"{1e3 * plan.element_size:g} mm in a patch of {1e3 * plan.patch:.3g} mm: "
        f"about {across:.2g} elements over the contact's radius",
        "duration": f"{1e3 * plan.duration:.4g} ms; {contact}",
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
    if problem:
        console.print(f"exceeds the limit: {problem}", markup=False, highlight=False)


def print_comparison(found: xr.Dataset) -> None:
    """Print one row per response: the 3-D value, and each beam model's with its difference in %.

    found: see compared. Below the table, the missing responses and the reasons, by model.
    """
    names = found["model"].values.tolist()
    models = ["3-D" if name == SOLID else name.replace("_", "-").title() for name in names]
    right = [Column(name, justify="right") for name in models]
    table = Table(  # narrow enough for 80 columns
        Column("response", no_wrap=True), *right, box=box.SIMPLE, show_edge=False, padding=0
    )
    for name in found["response"].values.tolist():
        one = found.sel(response=name)
        values = one["value"].rename(name).assign_attrs(units=one["units"].item())
        unit = display(values)  # fits the largest value
        cells = map(_cell, unit(values), 100.0 * one["difference"].values)
        table.add_row(f"{name} ({unit.symbol})" if unit.symbol else name, *cells)
    missing: dict[str, list[str]] = {}
    for model, status in zip(models, found["status"].values.tolist(), strict=True):
        for reason in reasons(status):
            missing.setdefault(reason, []).append(model)
    console = Console()
    console.print(table)
    console.print("In %: difference from the 3-D FE model.", markup=False)
    for why in dict.fromkeys(UNLIKE.values()):
        which = labels.listing([name for name, given in UNLIKE.items() if given == why])
        console.print(f"not compared: {which}: {why}", markup=False)
    for reason, lacking in missing.items():
        who = "all models" if lacking == models else ", ".join(lacking)
        console.print(f"missing ({who}): {reason}", markup=False)


def print_yielding(solid: xr.Dataset) -> None:
    """Print one line per body or region that yields where the responses do not show it.

    solid: a dataset of fem3d.solver. Elements with one integration point yield as a whole, and late
    in bending.
    """
    console = Console()
    lines = []
    if (sphere := float(solid["sphere_plastic_strain"])) > 0.0:
        lines = [f"the sphere yields, too: PEEQ up to {sphere:.2%}, in plastic_dissipation alone"]
    if (coarse := float(solid["one_point_plastic_strain"])) > _FAR:
        lines.append(
            f"elements with one integration point yield: PEEQ up to {coarse:.2%} away from contact "
            "and middle, where they are too stiff in bending"
        )
    for line in lines:
        console.print(line, markup=False, highlight=False)


def _cell(value: float, share: float) -> str:
    if np.isnan(value):
        return "missing"
    text = f"{value:.4g}"
    digits = 1 if abs(share) < _WHOLE else 0
    return text if np.isnan(share) else f"{text} {share:+.{digits}f}%"
