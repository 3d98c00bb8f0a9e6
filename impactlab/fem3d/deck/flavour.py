"""What a deck has of one program."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from impactlab.fem3d.deck.case import Case
from impactlab.model.material import Material

Hardening = Callable[[Material], Iterable[str]]
"""The cards that follow *ELASTIC where a material yields."""


@dataclass(frozen=True, kw_only=True)
class Flavour:
    """One program's part of a deck.

    elements: its types, fully integrated (True) and not. hardening, sections, contact and step
    give lines: plasticity of a material, section assignments, what the model says of contact, and
    the step from *STEP to *END STEP. limits: what a user has to know, a sentence each.
    """

    program: str
    elements: Mapping[bool, str]
    hardening: Hardening
    sections: Callable[[Case], Iterable[str]]
    contact: Callable[[Case], Iterable[str]]
    step: Callable[[Case], Iterable[str]]
    limits: tuple[str, ...]
