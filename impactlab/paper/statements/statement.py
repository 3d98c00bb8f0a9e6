"""A statement of the paper, and the judgements that testing it gives."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Concatenate, ParamSpec

import xarray as xr

Data = Mapping[str, xr.Dataset]
"""The runs of each study by its name."""
P = ParamSpec("P")


class Verdict(StrEnum):
    """The outcome of a test."""

    HOLDS = "holds"
    READING = "holds under the stated reading"
    FAILS = "does not hold"
    UNKNOWN = "cannot be judged"


class UnknownError(Exception):
    """The datasets lack what a test needs; the message says what is missing, and why."""


@dataclass(frozen=True)
class Number:
    """A value in SI `units` ("1" for a pure number) and its numerical uncertainty in the same.

    uncertainty: half-width; 0.0 where the value is a closed form, NaN where it is not known.
    percent: a pure number that is written in %.
    """

    name: str
    value: float
    units: str
    uncertainty: float = 0.0
    percent: bool = False

    @property
    def low(self) -> float:
        """The smallest value that the uncertainty allows; NaN where it is not known."""
        return self.value - self.uncertainty

    @property
    def high(self) -> float:
        """The largest value that the uncertainty allows; NaN where it is not known."""
        return self.value + self.uncertainty


@dataclass(frozen=True)
class Judgement:
    """The verdict on one statement in one case, which may be a reading of the paper's words."""

    case: str
    numbers: tuple[Number, ...]
    verdict: Verdict
    why: str


@dataclass(frozen=True)
class Statement:
    """A statement of the paper, or a misprint, with its test.

    name: identifies it in the CSV files and in links.
    text: the paper's words in short. test: the formula in words.
    judge: a function from the runs of the studies to one judgement per case. Where a run is
        missing it gives the verdict UNKNOWN; it never raises UnknownError.
    studies: names of the studies that it is judged on; empty where closed forms suffice.
    holds: what holds in place of a misprint; empty for a statement.
    """

    name: str
    text: str
    test: str
    judge: Callable[[Data], Iterable[Judgement]]
    studies: tuple[str, ...] = ()
    holds: str = ""


@dataclass(frozen=True)
class JudgedStatement:
    """A statement with all its judgements."""

    statement: Statement
    judgements: tuple[Judgement, ...]


def attempt(
    case: str,
    judge: Callable[Concatenate[str, P], Judgement],
    *args: P.args,
    **kwargs: P.kwargs,
) -> Judgement:
    """Return judge(case, ...), or the verdict UNKNOWN with the reason where it raises one."""
    try:
        return judge(case, *args, **kwargs)
    except UnknownError as reason:
        return Judgement(case, (), Verdict.UNKNOWN, str(reason))


def verdict(stands: bool, *, reading: bool = False) -> Verdict:
    """Return the verdict on a clear test; reading: the paper does not state this case itself."""
    if not stands:
        return Verdict.FAILS
    return Verdict.READING if reading else Verdict.HOLDS


def require_known(number: Number) -> None:
    """Raise UnknownError where the value or the uncertainty is missing."""
    if math.isnan(number.value) or math.isnan(number.uncertainty):
        raise UnknownError(f"no number, or none with an uncertainty: {number.name}")
