"""What is wrong with a study, in words for the person who wrote it."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

_NOTHING = object()
_LONGEST = 1000
_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 60


class StudyError(ValueError):
    """Everything that is wrong with a study, one argument a problem, one line a problem."""

    def __str__(self) -> str:
        """One line a problem: file, key, value, what is wrong and what to do."""
        return "\n".join(str(problem) for problem in self.args)


@dataclass(frozen=True)
class Problem:
    """One thing wrong: in which file, at which dotted key, with which value, and why."""

    file: str
    key: str
    reason: str
    value: Any = _NOTHING

    def __str__(self) -> str:
        """`file: key = value: reason` on one line, without the parts that do not apply."""
        shown = "" if self.value is _NOTHING else f" = {_shown(self.value)}"
        key = f"{self.key}{shown}: " if self.key else ""
        return printable(f"{self.file}: {key}{_cut(self.reason)}")


def _cut(reason: str) -> str:
    """A parser may quote as much as the file holds."""
    return reason if len(reason) <= _LONGEST else f"{reason[:_LONGEST]} ..."


def printable(text: str) -> str:
    """The text with escapes in the place of what steers a terminal, or breaks the line."""
    if text.isprintable():
        return text
    return "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in text
    )


def _shown(value: object) -> str:
    """A value as it stands in YAML, cut short."""
    if value is None or isinstance(value, bool):
        return "null" if value is None else str(value).lower()
    return _SHORT.repr(value)


def dotted(path: Iterable[object]) -> str:
    """Keys and positions as one path; what does not print as it is comes as its repr."""
    return ".".join(str(step) if _plain(str(step)) else _SHORT.repr(step) for step in path)


def _plain(step: str) -> bool:
    return step.isprintable() and 0 < len(step) <= 60


def unknown(kind: str, word: object, choices: Iterable[str]) -> str:
    """That `word` is no such kind of thing, the nearest that is, and all that are."""
    names = list(choices)
    near = get_close_matches(word[:60], names, n=1) if isinstance(word, str) else []
    hint = f"did you mean {near[0]!r}? " if near else ""
    return f"unknown {kind}; {hint}choose from {', '.join(names)}"
