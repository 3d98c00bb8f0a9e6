"""One statement of the paper and what came of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

import xarray as xr

Data = Mapping[str, xr.Dataset]
"""The runs of each study by its name."""


class Verdict(StrEnum):
    """How a statement stands."""

    HOLDS = "holds"
    READING = "holds under the stated reading"
    FAILS = "does not hold"
    UNKNOWN = "cannot be judged"


class UnknownError(Exception):
    """The datasets do not hold what a test needs; the message says what is missing, and why."""


@dataclass(frozen=True)
class Number:
    """A value in SI `units` ("1" for a pure number) and its numerical uncertainty, in them too.

    uncertainty: half-width; 0.0 where the value is a closed form, NaN where it is not known.
    """

    name: str
    value: float
    units: str
    uncertainty: float = 0.0

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
    """The verdict on one statement in one case. case: the case or the reading, in words."""

    case: str
    numbers: tuple[Number, ...]
    verdict: Verdict
    why: str


class ClaimFile(Protocol):
    """What a statement's file offers.

    SAYS: the paper's words in short. TEST: the formula, in words.
    """

    SAYS: str
    TEST: str

    def judge(self, data: Data) -> Iterable[Judgement]:
        """A judgement for each case; it does not raise UnknownError but says so."""
        ...


def attempt(case: str, judge: Callable[[], Judgement]) -> Judgement:
    """The judgement, or why there can be none."""
    try:
        return judge()
    except UnknownError as reason:
        return Judgement(case, (), Verdict.UNKNOWN, str(reason))


def holds(stands: bool, *, as_read: bool = False) -> Verdict:
    """The verdict on a clear test; as_read: the case is a reading that the paper does not state."""
    if not stands:
        return Verdict.FAILS
    return Verdict.READING if as_read else Verdict.HOLDS


def known(*numbers: Number) -> None:
    """Raises UnknownError naming the numbers whose value or uncertainty is missing."""
    if gaps := [n.name for n in numbers if math.isnan(n.value) or math.isnan(n.uncertainty)]:
        raise UnknownError(f"no number, or none with an uncertainty: {', '.join(gaps)}")
