"""A table for the templates: plain text in cells, with what a cell means for its looks."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Cell:
    """Text of one cell. kind: "", "number", "muted" or "warning"; detail: small print below."""

    text: str
    kind: str = ""
    detail: str = ""


@dataclass(frozen=True)
class Table:
    """A caption, the column heads, and rows as wide as the head; the first cell heads its row."""

    caption: str
    head: list[str]
    rows: list[list[Cell]] = field(default_factory=list)
