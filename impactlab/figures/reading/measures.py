"""What the analyses of a sample give: the indices of every method, their intervals and floors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.figures.reading.contents import known, responses

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Measure:
    """A variable of the analysis on (response, parameter), and its name in words."""

    name: str
    words: str


@dataclass(frozen=True)
class Family:
    """Measures of one method that are shown side by side.

    title: heads the figure and the tables. axis: what the numbers are, with the unit. says: what
    they mean, a sentence or two. shares: whether 1 is all there is.
    """

    title: str
    measures: tuple[Measure, ...]
    axis: str
    says: str
    shares: bool = True

    def given(self, analysis: xr.Dataset) -> bool:
        """Whether the analysis has every measure."""
        return all(measure.name in analysis for measure in self.measures)


@dataclass(frozen=True)
class Index:
    """One measure of one response.

    values, margins: on (parameter,), the index and the half-width of its interval (infinite where
    none is given). floor: the upper end of a dummy parameter's interval, which is noise; NaN where
    no dummy was sampled.
    """

    values: Array
    margins: Array
    floor: float

    @property
    def significant(self) -> NDArray[np.bool_]:
        """Where the whole interval of the magnitude lies above zero and above the dummy's."""
        floor = max(self.floor, 0.0) if np.isfinite(self.floor) else 0.0
        return np.asarray(np.abs(self.values) - self.margins > floor)


SOBOL = Family(
    "Sobol indices",
    (Measure("first_order", "first order"), Measure("total_order", "total order")),
    "Share of the variance (–)",
    "Share of the variance of each response that comes from a parameter alone (first order) and "
    "with all its interactions (total order), over the ranges of this study.",
)
SURROGATE = Family(
    "Indices of the surrogate beside the sampled ones",
    (
        Measure("first_order", "first order, sampled"),
        Measure("surrogate_first_order", "first order, surrogate"),
        Measure("total_order", "total order, sampled"),
        Measure("surrogate_total_order", "total order, surrogate"),
    ),
    "Share of the variance (–)",
    "The same shares of the variance from the runs themselves and from a surrogate fitted to them: "
    "where they differ by more than their intervals, trust neither.",
)
DELTA = Family(
    "Delta indices",
    (Measure("delta", "delta"), Measure("delta_first_order", "first order")),
    "Index (–)",
    "Delta: half the area by which the density of a response changes, on average, once the "
    "parameter is known (Borgonovo); beside it the first-order index from the same runs.",
)
PAWN = Family(
    "PAWN indices",
    (Measure("pawn", "median"), Measure("pawn_maximum", "largest")),
    "Kolmogorov-Smirnov distance (–)",
    "Distance between the distribution of a response and the same with the parameter held in one "
    "part of its range: median and largest over the parts (Pianosi and Wagener).",
)
REGRESSION = Family(
    "Regression coefficients",
    (Measure("regression", "of values"), Measure("rank_regression", "of ranks")),
    "Standardised coefficient (–)",
    "Standard deviations by which a response rises with one standard deviation of the parameter, "
    "in a linear fit of values and of ranks. They tell no more than the fit does: see R².",
    shares=False,
)
MORRIS = Family(
    "Elementary effects (Morris)",
    (Measure("morris_mu_star", "mean of magnitudes"),),
    "Mean of magnitudes µ*",
    "How far a response moves, on average, when one parameter goes through its whole range (µ*), "
    "and how much this depends on where the others are (σ).",
    shares=False,
)
RANKED = (SOBOL, MORRIS, DELTA, PAWN, REGRESSION)
"""Families that rank the parameters, each by one measure of theirs (`ranking`)."""


def ranking(family: Family) -> Measure:
    """The measure that parameters are ranked by: the total order of Sobol, else the first."""
    return family.measures[1] if family is SOBOL else family.measures[0]


def asked(runs: xr.Dataset, analysis: xr.Dataset) -> list[str]:
    """The responses of the runs that the sensitivity analysis knows."""
    return [name for name in responses(runs) if known(analysis, name)]


def parameters(analysis: xr.Dataset) -> list[str]:
    """Names of the varied parameters, or of their groups."""
    return [str(name) for name in analysis["parameter"].values]


def index(analysis: xr.Dataset, measure: str, response: str) -> Index:
    """One measure of one response."""
    values = analysis[measure].sel(response=response).values
    interval = analysis.get(f"{measure}_interval")
    margins = np.full_like(values, np.inf)
    if interval is not None:
        margins = np.nan_to_num(interval.sel(response=response).values, nan=np.inf)
    return Index(values, margins, _floor(analysis, measure, response))


def _floor(analysis: xr.Dataset, measure: str, response: str) -> float:
    dummy = f"dummy_{measure}"
    if dummy not in analysis:
        return float("nan")
    value = abs(float(analysis[dummy].sel(response=response)))
    interval = analysis.get(f"{dummy}_interval")
    margin = 0.0 if interval is None else float(interval.sel(response=response))
    return value + (margin if np.isfinite(margin) else 0.0)
