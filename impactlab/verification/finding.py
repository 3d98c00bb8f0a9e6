"""A check, what it finds (comparisons, and curves to draw), and how it ends."""

from __future__ import annotations

import logging
import traceback
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Literal

from impactlab.model.plausibility import ImplausibleWarning, TooShortWarning
from impactlab.types import Floats
from impactlab.verification.comparisons import Comparison

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Curve:
    """A line to draw, x and y of shape (points,), in SI; independent: not from the solver."""

    label: str
    x: Floats
    y: Floats
    independent: bool = False


@dataclass(frozen=True)
class Panel:
    """Axes with their curves. x, y: (name, units); log: logarithmic axes, for errors."""

    title: str
    x: tuple[str, str]
    y: tuple[str, str]
    curves: Sequence[Curve]
    log: bool = False


@dataclass(frozen=True)
class Finding:
    """All that one check found."""

    comparisons: Sequence[Comparison]
    panels: Sequence[Panel] = field(default_factory=tuple)

    @property
    def passed(self) -> bool:
        """True if there is at least one comparison, and all of them pass."""
        return bool(self.comparisons) and all(entry.passed for entry in self.comparisons)


@dataclass(frozen=True)
class Outcome:
    """A check that was run, and its result.

    name, title, source: those of the check. seconds: the time it took. finding: empty if an error
    ended the check; reason: that error in words, otherwise "".
    """

    name: str
    title: str
    source: str
    seconds: float
    finding: Finding
    reason: str = ""

    @property
    def verdict(self) -> Literal["error", "failed", "passed"]:
        """Passed if every comparison passed, "error" if an error ended the check."""
        if self.reason:
            return "error"
        return "passed" if self.finding.passed else "failed"

    @property
    def failures(self) -> list[Comparison]:
        """The comparisons that failed, the worst first."""
        failed = (entry for entry in self.finding.comparisons if not entry.passed)
        return sorted(failed, key=lambda entry: -entry.ratio)

    @property
    def worst(self) -> Comparison | None:
        """The comparison with the largest error over tolerance, None without comparisons."""
        return max(self.finding.comparisons, key=lambda entry: entry.ratio, default=None)


@dataclass(frozen=True)
class Check:
    """A check of the solver.

    name: the one in study files. source: of the independent values. check: runs the solver and the
    independent solution, and compares them.
    """

    name: str
    title: str
    source: str
    check: Callable[[], Finding]

    def run(self) -> Outcome:
        """Run the check. An exception becomes the reason of the outcome."""
        start, finding, reason = perf_counter(), Finding(()), ""
        try:
            with warnings.catch_warnings():  # limits of theories are implausible by design
                for category in (ImplausibleWarning, TooShortWarning):
                    warnings.simplefilter("ignore", category)
                finding = self.check()
        except Exception as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            file = Path(place.filename).name
            reason = f"{type(error).__name__}: {error} ({file}, line {place.lineno})"
            log.debug("the check %s ended in an error", self.name, exc_info=True)
        return Outcome(self.name, self.title, self.source, perf_counter() - start, finding, reason)


def check(title: str, source: str) -> Callable[[Callable[[], Finding]], Check]:
    """Return a decorator that makes a function the `Check` of its name."""
    return lambda function: Check(function.__name__, title, source, function)


def gravest_first(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """Return errors, then failures, then passed checks, each group in the order given."""
    gravity = ("error", "failed", "passed")
    return sorted(outcomes, key=lambda outcome: gravity.index(outcome.verdict))
