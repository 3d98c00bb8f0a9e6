"""Runs of a table, which nothing here drew: they are no section of a study."""

from __future__ import annotations

from dataclasses import dataclass

from impactlab.methods.sampling import RandomSample


@dataclass(frozen=True, kw_only=True)
class Table(RandomSample):
    """Rows of a design made elsewhere, or of measurements, each a draw of its own."""

    label = "table"
