"""How one check ended: with a finding, or with an error, which is an outcome like any other."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from impactlab.verification.finding import Comparison, Finding

Verdict = Literal["passed", "failed", "error"]
_GRAVITY = {"error": 0, "failed": 1, "passed": 2}


@dataclass(frozen=True)
class Outcome:
    """A check and what came of it.

    name: the check's file; title, source: as it says them. seconds: what it took. finding: empty
    where an error ended it; reason: then that error in words, else "".
    """

    name: str
    title: str
    source: str
    seconds: float
    finding: Finding
    reason: str = ""

    @property
    def verdict(self) -> Verdict:
        """Whether every comparison passed, or an error left none."""
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
        """The comparison whose error is largest beside its tolerance."""
        return max(self.finding.comparisons, key=lambda entry: entry.ratio, default=None)


def gravest_first(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """Errors, then failures, then what passed; otherwise in the order given."""
    return sorted(outcomes, key=lambda outcome: _GRAVITY[outcome.verdict])
