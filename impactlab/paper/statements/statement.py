"""A statement of the paper, its assessments, and the numbers from solved studies that they rest on.

Every number has an uncertainty from the convergence in the mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis.convergence.extrapolation import SAFETY_DOUBTFUL
from impactlab.analysis.convergence.judgement import judge
from impactlab.variables import RESPONSES, reasons, status_bits

Data = Mapping[str, xr.Dataset]  # the runs of each study by its name
Case = tuple[Any, ...]
BEAM = "euler_bernoulli"  # the paper's beam, among `beam_model`
VELOCITY = 0.99  # the paper's impact velocity, m/s
PRINTED_DIFFERENCE = 0.024
"""What the paper says of its force against finite elements; its scale where it says "small"."""


class Ruling(StrEnum):
    """The outcome of a test."""

    HOLDS = "holds"
    READING = "holds under the stated reading"
    FAILS = "does not hold"
    UNKNOWN = "cannot be judged"


class Subject(StrEnum):
    """The subject of a test."""

    STATEMENT = "statement of the paper"
    MISPRINT = "misprint"
    OBSERVATION = "observation of ours, of something that the paper leaves open"


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

    def within(self, limit: float) -> bool:
        """Return whether a difference may be as small as `limit`: |value| - U <= limit.

        Raises UnknownError where its uncertainty is not known.
        """
        if not np.isfinite(self.uncertainty):
            raise UnknownError(f"nothing bounds the numerical error of the {self.name}")
        return abs(self.value) - self.uncertainty <= limit

    def relative_to(self, other: Number, name: str) -> Number:
        """Return self/other - 1 in %, with the uncertainties of both."""
        ratio = self.value / other.value
        share = self.uncertainty / abs(self.value) + other.uncertainty / abs(other.value)
        return Number(name, ratio - 1.0, "1", abs(ratio) * share, percent=True)


@dataclass(frozen=True)
class Assessment:
    """The verdict on one statement in one case, which may be a reading of the paper's words.

    case: in words; those of a judge follow those of its statement.
    """

    numbers: tuple[Number, ...]
    verdict: Ruling
    why: str
    case: str = ""


@dataclass(frozen=True)
class Statement:
    """A statement of the paper, a misprint, or an observation of ours, with its test.

    name: identifies it in the CSV files and in links.
    judge_case: a function (data, the case but for its words) that judges one case; it raises
        UnknownError where a run is missing.
    text: the paper's words in short. test: the formula in words.
    cases: tuples that begin with their words, or a function that returns them for the data.
    studies: names of the studies that it is judged on; empty where closed forms suffice.
    holds: what holds in place of a misprint, or instead of what may be expected; empty for a
        statement.
    """

    name: str
    judge_case: Callable[..., Assessment]
    text: str
    test: str
    cases: tuple[Case, ...] | Callable[[Data], Iterable[Case]]
    studies: tuple[str, ...] = ()
    holds: str = ""
    kind: Subject = Subject.STATEMENT

    def judge(self, data: Data) -> Iterator[Assessment]:
        """Yield one assessment per case: UNKNOWN, with the reason, where a run is missing."""
        for case, *rest in self.cases(data) if callable(self.cases) else self.cases:
            try:
                assessment = self.judge_case(data, *rest)
            except UnknownError as reason:
                assessment = Assessment((), Ruling.UNKNOWN, str(reason))
            yield replace(assessment, case=", ".join(filter(None, (case, assessment.case))))


def statement(**fields: Any) -> Callable[[Callable[..., Assessment]], Statement]:
    """Return a decorator that makes a function the `Statement` of its name; fields: the others."""
    return lambda function: Statement(function.__name__, function, **fields)


def judged(
    numbers: tuple[Number, ...],
    stands: bool,
    why: str,
    otherwise: str = "",
    *,
    literal: bool = True,
) -> Assessment:
    """Return the assessment of a clear test; literal: the paper states this very case.

    otherwise: what is said where the statement does not stand, if not the same.
    """
    if not stands:
        return Assessment(numbers, Ruling.FAILS, otherwise or why)
    return Assessment(numbers, Ruling.HOLDS if literal else Ruling.READING, why)


def runs_of(data: Data, study: str) -> xr.Dataset:
    """Return the runs of a study. Raises UnknownError where there are none."""
    if study not in data:
        raise UnknownError(f"the study {study} has not been solved")
    return data[study]


def select_response(runs: xr.Dataset, response: str, **where: Any) -> xr.DataArray:
    """Return a response at the labels `where`.

    Raises UnknownError, with the reasons, where a run lacks it.
    """
    try:
        chosen = runs[[response, "status"]].sel(where)
    except KeyError as error:
        study = runs.attrs.get("study", "?")
        raise UnknownError(f"the study {study} does not have {error.args[0]!r}") from None
    bits = chosen["status"].values & status_bits([response])
    gaps = (bits != 0) | ~np.isfinite(chosen[response].values)
    if gaps.any():
        causes = reasons(int(np.bitwise_or.reduce(np.ravel(bits)))) or ["no reason is recorded"]
        raise UnknownError(f"{int(gaps.sum())} of {gaps.size} runs lack it: {'; '.join(causes)}")
    return chosen[response]


def finest_grid(runs: xr.Dataset, response: str, **where: Any) -> Number:
    """Return a response on the finest grid with its uncertainty.

    The uncertainty is the grid convergence index. Where the grids show no convergence, it is three
    times the range of the three finest (Eca and Hoekstra's bound for scattered data), so that a
    value which still grows has an uncertainty of its own size. It is NaN with fewer than three
    grids. where: a label for every varied parameter but `nodes`. Raises UnknownError where a run
    of the grids is missing.
    """
    if "nodes" not in runs.dims:
        study = runs.attrs.get("study", "?")
        raise UnknownError(f"the study {study} does not vary the nodes: no uncertainty is known")
    by_grid = select_response(runs, response, **where).sortby("nodes", ascending=False)
    entry = RESPONSES[response]
    return Number(entry.long_name, float(by_grid[0]), entry.units, uncertain(by_grid))


def uncertain(by_grid: xr.DataArray) -> float:
    """Return the uncertainty of the finest grid; by_grid: on `nodes`, the finest first.

    See finest_grid; NaN where there are fewer than three grids.
    """
    values = by_grid.values.astype(float)
    if len(values) < 3:
        return float("nan")
    index = judge(values, 1.0 / (by_grid["nodes"].values - 1.0)).gci
    scatter = SAFETY_DOUBTFUL * float(np.ptp(values[:3]))
    return float(index * abs(values[0])) if np.isfinite(index) else scatter


def response_curve(data: Data, study: str, response: str, **where: Any) -> dict[float, Number]:
    """Return a response by the velocities of a study in m/s, from the lowest on.

    On the paper's beam unless `where` differs. Raises UnknownError where a run or an uncertainty is
    missing, naming the velocity.
    """
    runs = runs_of(data, study)
    if "beam_model" in runs.dims:
        where = {"beam_model": BEAM} | where
    curve = {}
    for velocity in np.sort(runs["velocity"].values.astype(float)).tolist():
        try:
            number = finest_grid(runs, response, velocity=velocity, **where)
        except UnknownError as reason:
            raise UnknownError(f"at {velocity:g} m/s {reason}") from None
        if np.isnan(number.uncertainty):
            raise UnknownError(f"at {velocity:g} m/s there are fewer than three grids")
        curve[velocity] = number
    return curve
