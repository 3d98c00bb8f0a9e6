"""Samples in which parameters may be put into groups that vary together."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, model_validator

from impactlab.study.declaration.form import Names, at_key
from impactlab.study.declaration.methods.sample import Sample
from impactlab.study.errors import unknown

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,59}")
"""No formula in a table, no label that a legend leaves out."""


def _named(data: Any) -> Any:
    if not isinstance(data, dict):
        raise ValueError("expected a mapping such as {steel: [beam_density, beam_yield_stress]}")
    if odd := [name for name in data if not isinstance(name, str) or not _NAME.fullmatch(name)]:
        raise ValueError(
            f"{odd[0]!r} cannot name a group: letters, digits, _ and - only, no _ or - first"
        )
    return data


Groups = Annotated[Mapping[str, Names], BeforeValidator(_named)]


class Grouped(Sample):
    """A sample that gives an index for each group of parameters.

    groups: the varied parameters of each group by its name; any that is not named is a group of
    its own.

    Raises ValueError unless every group has a name of its own, each member is a varied parameter
    of one group alone, and there are two groups or more (SALib takes a single group for none).
    """

    groups: Groups = Field(default_factory=dict)

    @property
    def group_of(self) -> dict[str, str]:
        """The group of each varied parameter, in their order."""
        group = {member: name for name, members in self.groups.items() for member in members}
        return {name: group.get(name, name) for name in self.varied}

    @property
    def group_count(self) -> int:
        """How many groups vary, each of which has indices of its own."""
        return len(set(self.group_of.values()))

    @model_validator(mode="after")
    def _sound_groups(self) -> Self:
        for key, reason in self._wrong_in_groups():
            raise at_key(key, reason)
        return self

    def _wrong_in_groups(self) -> Iterator[tuple[str, str]]:
        """Dotted keys, and what is wrong there."""
        seen: set[str] = set()
        for group, members in self.groups.items():
            if group in self.parameters:
                yield f"groups.{group}", "is the name of a parameter: give the group another"
            for at, member in enumerate(members):
                if reason := self._unfit(member, seen):
                    yield f"groups.{group}.{at}", reason
                seen.add(member)
        if self.group_count < self.fewest:
            yield "groups", f"too few: {self.fewest} groups or more are compared, here is one"

    def _unfit(self, member: str, seen: set[str]) -> str:
        if member in self.fixed:
            return "is fixed: it belongs to no group"
        if member not in self.varied:
            return unknown("varied parameter", member, self.varied)
        return "is named more than once: each parameter has one group" if member in seen else ""
