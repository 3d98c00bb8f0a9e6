"""What the command line prints: tables for a terminal."""

from __future__ import annotations

from collections.abc import Iterable

import xarray as xr
from rich.console import Console
from rich.table import Table

from impactlab.dataset import RESPONSES, reasons, remarked


def print_responses(dataset: xr.Dataset) -> None:
    """The scalar responses of one run, each with its unit; a missing one as such, and why."""
    table = Table("response", "value", "unit", "meaning")
    for name, entry in RESPONSES.items():
        value = dataset[name].item()
        table.add_row(
            name, "missing" if value != value else f"{value:.6g}", entry.units, entry.long_name
        )
    console = Console()
    console.print(table)
    for reason in reasons(dataset["status"].item()):
        console.print(f"missing because {reason}; a longer duration may help", markup=False)
    for remark in remarked(dataset["remarks"].item()):
        console.print(f"note: {remark}", markup=False)


def print_studies(rows: Iterable[tuple[str, int, str]]) -> None:
    """One line a study: name, number of runs, title."""
    table = Table("study", "runs", "title")
    for name, runs, title in rows:
        table.add_row(name, f"{runs:,}", title)
    Console().print(table)
