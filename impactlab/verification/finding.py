"""A check, what it finds (comparisons, and curves to draw), and how it ends."""

import logging
import re
import traceback
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import perf_counter
from typing import Literal, Self

import numpy as np
import xarray as xr

from impactlab.model.plausibility import ImplausibleWarning, TooShortWarning
from impactlab.solver.contact import CONTACT_LAWS
from impactlab.types import Floats

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Comparison:
    """One quantity of the solver beside an independent value.

    ours, independent: in `units` (UDUNITS). error: the difference in the measure that `measure`
    names ("relative", "absolute", or such as "of the peak"). tolerance: the largest error that
    passes. where: the case, in words. uncertainty: of the independent value, in the same measure;
    NaN where it is not known.
    """

    quantity: str
    where: str
    units: str
    ours: float
    independent: float
    error: float
    tolerance: float
    measure: str = "relative"
    uncertainty: float = np.nan

    def __post_init__(self) -> None:
        """Spell the names of study files as people write them."""
        object.__setattr__(self, "quantity", spelled(self.quantity))
        object.__setattr__(self, "where", spelled(self.where))

    @property
    def passed(self) -> bool:
        """True if the error is within the tolerance; a NaN never is."""
        return bool(abs(self.error) <= self.tolerance)

    @property
    def ratio(self) -> float:
        """Error over tolerance: above 1 the comparison fails; infinite for a NaN."""
        size = abs(self.error)
        if size == 0.0:
            return 0.0
        return float(size / self.tolerance) if size < np.inf and self.tolerance > 0 else np.inf


class Comparisons(list[Comparison]):
    """Comparisons; where: the present case, in words. A method adds one and returns all."""

    def __init__(self, where: str = "") -> None:
        """Begin without any."""
        super().__init__()
        self.where = where

    def at(self, where: str) -> Self:
        """Go on with another case."""
        self.where = where
        return self

    def relative(
        self, quantity: str, units: str, ours: float, independent: float, tolerance: float
    ) -> Self:
        """Add the relative difference, which is infinite where the independent value is zero."""
        error = ours / independent - 1.0 if independent else np.inf
        self.append(Comparison(quantity, self.where, units, ours, independent, error, tolerance))
        return self

    def absolute(
        self, quantity: str, units: str, ours: float, independent: float, tolerance: float
    ) -> Self:
        """Add the difference, in `units`."""
        values = ours, independent, ours - independent, tolerance, "absolute"
        self.append(Comparison(quantity, self.where, units, *values))
        return self

    def responses(self, run: xr.Dataset, expected: Mapping[str, float], tolerance: float) -> Self:
        """Add the relative differences of responses of a run from those expected, by variable."""
        for name, value in expected.items():
            ours, units = run[name].item(), run[name].attrs["units"]
            self.relative(words(name), units, ours, value, tolerance)
        return self

    def histories(self, run: xr.Dataset, expected: Mapping[str, Floats], tolerance: float) -> Self:
        """Add the differences of histories of a run from those expected, by variable; see curve."""
        for name, values in expected.items():
            label, units = f"history of {words(name)}", run[name].attrs["units"]
            self.curve(label, units, run[name].values, values, tolerance)
        return self

    def curve(
        self, quantity: str, units: str, ours: Floats, independent: Floats, tolerance: float
    ) -> Self:
        """Add the largest difference of two curves at the same points, over the largest value.

        The comparison holds the values at the point where they differ most.
        """
        gap = np.abs(ours - independent)
        worst = int(np.argmax(gap))  # the first NaN where there is one
        error = float(gap[worst] / np.max(np.abs(independent)))
        values = float(ours[worst]), float(independent[worst]), error, tolerance
        self.append(Comparison(quantity, self.where, units, *values, "of the largest value"))
        return self

    def worst(self, rows: Iterable[Sequence[Comparison]]) -> Self:
        """Add the one nearest to failing of each column of rows of alike comparisons."""
        self.extend(map(worst, zip(*rows, strict=True)))
        return self


_SPELLED = {law: record.short for law, record in CONTACT_LAWS.items()} | {
    "euler_bernoulli": "Euler-Bernoulli",
    "timoshenko": "Timoshenko",
    "von_karman": "von Karman",
}
_NAME = re.compile(rf"\b(?:{'|'.join(_SPELLED)})\b|(?<=[a-z][a-z])_(?=[a-z][a-z])")


def spelled(text: str) -> str:
    """Return a text with contact laws and beam models as papers spell them, and no underscores."""
    return _NAME.sub(lambda match: _SPELLED.get(match[0], " "), text)


def words(name: str) -> str:
    """Return the name of a variable in words."""
    return name.replace("midspan", "mid-span").replace("_", " ")


def rms_error(ours: Floats, independent: Floats) -> float:
    """Return the root mean square of the difference over the largest independent value."""
    gap = ours - independent
    return float(np.sqrt(np.mean(gap**2)) / np.max(np.abs(independent)))


def worst(entries: Sequence[Comparison]) -> Comparison:
    """Return the comparison nearest to failing, to shorten a table; a NaN comes first."""
    entry = max(entries, key=lambda entry: entry.ratio)
    return replace(entry, where=f"{entry.where} (the worst of {len(entries)})")


@dataclass(frozen=True)
class Curve:
    """A line to draw, x and y of shape (points,), in SI; independent: not from the solver."""

    label: str
    x: Floats
    y: Floats
    independent: bool = False

    def __post_init__(self) -> None:
        """Spell the names of study files as people write them."""
        object.__setattr__(self, "label", spelled(self.label))


@dataclass(frozen=True)
class CurvePanel:
    """Axes with their curves. x, y: (name, units); log: logarithmic axes, for errors."""

    title: str
    x: tuple[str, str]
    y: tuple[str, str]
    curves: Sequence[Curve]
    log: bool = False

    def __post_init__(self) -> None:
        """Spell the names of study files as people write them."""
        object.__setattr__(self, "title", spelled(self.title))


@dataclass(frozen=True)
class Finding:
    """All that one check found."""

    comparisons: Sequence[Comparison]
    panels: Sequence[CurvePanel] = field(default_factory=tuple)

    @property
    def passed(self) -> bool:
        """True if there is at least one comparison, and all of them pass."""
        return bool(self.comparisons) and all(entry.passed for entry in self.comparisons)


Kind = Literal[
    "", "closed form", "identity", "limit", "series", "quadrature", "finite elements", "finer grid"
]


@dataclass(frozen=True)
class Reference:
    """Independent values of a check, and their uncertainty.

    uncertainty: relative; NaN where it is not known. Whole numbers in absolute comparisons (zeros,
    orders, numbers of contacts) are exact. basis: what it is, and how it is known. parts: others,
    by regular expressions of which the first that occurs in "quantity, case" counts.
    """

    kind: Kind = ""
    uncertainty: float = np.nan
    basis: str = ""
    parts: Mapping[str, float] = field(default_factory=dict)

    def applied(self, entry: Comparison) -> Comparison:
        """Return a comparison with the uncertainty of its independent value."""
        text, value = f"{entry.quantity}, {entry.where}", entry.independent
        matches = (size for part, size in self.parts.items() if re.search(part, text))
        size = next(matches, self.uncertainty)
        if entry.measure == "absolute" and self.kind:
            size = 0.0 if float(value).is_integer() else size * abs(value)
        return replace(entry, uncertainty=size)


ROUNDING = 1e-14
"""Relative uncertainty of closed forms, of which each number has some rounded operations."""
CLOSED_FORM = Reference("closed form", ROUNDING, "rounding")


@dataclass(frozen=True)
class Outcome:
    """A check that was run, and its result.

    name, title, source: those of the check. seconds: the time it took. finding: empty if an error
    ended the check; reason: that error in words, otherwise "". reference, basis: kind of the
    independent values, and how their uncertainty is known.
    """

    name: str
    title: str
    source: str
    seconds: float
    finding: Finding
    reason: str = ""
    reference: str = ""
    basis: str = ""

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
    independent solution, and compares them. reference: the uncertainty of the latter.
    """

    name: str
    title: str
    source: str
    check: Callable[[], Finding]
    reference: Reference = Reference()

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
        comparisons = [self.reference.applied(entry) for entry in finding.comparisons]
        finding, seconds = replace(finding, comparisons=comparisons), perf_counter() - start
        kind, basis = self.reference.kind, self.reference.basis
        return Outcome(self.name, self.title, self.source, seconds, finding, reason, kind, basis)


def check(
    title: str, source: str, reference: Reference
) -> Callable[[Callable[[], Finding]], Check]:
    """Return a decorator that makes a function the `Check` of its name."""
    return lambda function: Check(function.__name__, title, source, function, reference)


def gravest_first(outcomes: Iterable[Outcome]) -> list[Outcome]:
    """Return errors, then failures, then passed checks, each group in the order given."""
    gravity = ("error", "failed", "passed")
    return sorted(outcomes, key=lambda outcome: gravity.index(outcome.verdict))
