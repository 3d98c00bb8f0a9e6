"""A section of the page."""

from __future__ import annotations

from dataclasses import dataclass, field

from impactlab.report.table import Table


@dataclass(frozen=True)
class Section:
    """A heading with what stands under it, in this order.

    name: the anchor. lead: a paragraph. sentences: a list. tables: shown. figures: names of figures
    (those that were not drawn are left out). folded: tables to be opened. files: beside the page.
    """

    name: str
    title: str
    lead: str = ""
    sentences: list[str] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    figures: list[str] = field(default_factory=list)
    folded: list[Table] = field(default_factory=list)
    files: list[str] = field(default_factory=list)
