"""Mistakes in a study, in words for the person who wrote it."""

import reprlib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from impactlab.model.checks import did_you_mean

_NOTHING = object()
_LONGEST = 1000  # letters of a reason: a parser may quote as much as the file holds
_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 60


class StudyError(ValueError):
    """All mistakes of a study, one argument per problem.

    Parameters
    ----------
    *args : Problem
        The mistakes.

    Examples
    --------
    >>> il.Study.from_yaml("nowhere.yaml")
    Traceback (most recent call last):
    impactlab.validation.errors.StudyError: nowhere.yaml: there is no such file
    """

    def __str__(self) -> str:
        """Return one line per problem: file, key, value, what is wrong and what to do."""
        return "\n".join(str(problem) for problem in self.args)


@dataclass(frozen=True)
class Problem:
    """A mistake in a study; as text, `file: key = value: reason`.

    Attributes
    ----------
    file : str
        File, or the function that was called.
    key : str
        Dotted key; "" for the file as a whole.
    reason : str
        Mistake and remedy.
    value : object
        Value of the key, if it has one.
    """

    file: str
    key: str
    reason: str
    value: Any = _NOTHING

    def __str__(self) -> str:
        """Return `file: key = value: reason` on one line, without the parts that do not apply."""
        if self.value is None or isinstance(self.value, bool):  # as it stands in YAML
            shown = " = null" if self.value is None else f" = {str(self.value).lower()}"
        else:
            shown = "" if self.value is _NOTHING else f" = {_SHORT.repr(self.value)}"
        key = f"{self.key}{shown}: " if self.key else ""
        cut = " ..." if len(self.reason) > _LONGEST else ""
        return printable(f"{self.file}: {key}{self.reason[:_LONGEST]}{cut}")


def printable(text: str) -> str:
    """Return the text with control characters and line breaks escaped."""
    return "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in text
    )


def dotted(path: Iterable[object]) -> str:
    """Return keys and positions as one path; unprintable and long ones as their repr."""
    steps = [str(step) for step in path]
    return ".".join(
        step if step.isprintable() and 0 < len(step) <= 60 else _SHORT.repr(step) for step in steps
    )


def unknown(kind: str, word: object, choices: Iterable[str]) -> str:
    """Return a message about an unknown word, with the nearest choice and all of them."""
    names = list(choices)
    return f"unknown {kind}{did_you_mean(word, names) or ';'} choose from {', '.join(names)}"
