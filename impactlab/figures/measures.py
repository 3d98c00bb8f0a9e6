"""Sensitivity measures of every method: their indices, intervals and noise floors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.analysis.verdicts import ROUND_OFF
from impactlab.figures.access import known, responses
from impactlab.types import Floats


@dataclass(frozen=True)
class Measure:
    """A variable of the analysis on (response, parameter), and its name in words.

    optional: shown where it is given.
    """

    name: str
    label: str
    optional: bool = False


@dataclass(frozen=True)
class Family:
    """Measures of one method that are shown side by side.

    figure: name of their figure; title: heads it and the tables. axis: label of their axis.
    meaning: of the numbers, in a sentence or two. shares: True for shares of a whole.
    """

    figure: str
    title: str
    measures: tuple[Measure, ...]
    axis: str
    meaning: str
    shares: bool = True

    def given(self, analysis: xr.Dataset) -> bool:
        """Return whether the analysis has every measure that is not optional."""
        return all(measure.name in analysis for measure in self.measures if not measure.optional)

    def measures_in(self, analysis: xr.Dataset) -> list[Measure]:
        """Return the measures that the analysis has."""
        return [measure for measure in self.measures if measure.name in analysis]


@dataclass(frozen=True)
class Index:
    """One measure of one response.

    values, margins, numerical: on (parameter,), the index, the half-width of its interval (infinite
    where none is given), and what the numerical error of the runs could change it by (0 where that
    is not known). floor: the upper end of a dummy parameter's interval, which is noise; 0 where the
    method has no dummy.
    """

    values: Floats
    margins: Floats
    numerical: Floats
    floor: float

    @property
    def above_noise(self) -> NDArray[np.bool_]:
        """True where the whole interval lies beyond zero, the dummy and round-off."""
        size = np.abs(self.values)
        least = max(self.floor, ROUND_OFF * np.max(size, initial=0.0, where=np.isfinite(size)))
        return np.asarray(size - self.margins > least)

    @property
    def significant(self) -> NDArray[np.bool_]:
        """True where an index is above noise, and larger than its numerical error."""
        return self.above_noise & (np.abs(self.values) > self.numerical)

    @property
    def numerically_lost(self) -> NDArray[np.bool_]:
        """True where an index is above noise, but not larger than its numerical error."""
        return self.above_noise & ~self.significant

    @property
    def ranks(self) -> list[tuple[int, int]]:
        """The best and the worst rank of each magnitude, from 1.

        They differ where the interval and the numerical error, added, leave the rank open.
        """
        size, reach = np.abs(self.values), self.margins + self.numerical
        best = 1 + (size - reach > (size + reach)[:, None]).sum(1)
        worst = size.size - (size + reach < (size - reach)[:, None]).sum(1)
        return list(zip(best.tolist(), worst.tolist(), strict=True))


SOBOL = Family(
    "sobol_indices",
    "Sobol indices",
    (Measure("first_order", "first order"), Measure("total_order", "total order", optional=True)),
    "Share of the variance (–)",
    "Share of the variance of each response that comes from a parameter alone (first order) and "
    "with all its interactions (total order), over the ranges of this study.",
)
SURROGATE = Family(
    "surrogate_indices",
    "Indices of the surrogate beside the sampled ones",
    (
        Measure("first_order", "first order, sampled", optional=True),
        Measure("surrogate_first_order", "first order, surrogate"),
        Measure("total_order", "total order, sampled", optional=True),
        Measure("surrogate_total_order", "total order, surrogate"),
    ),
    "Share of the variance (–)",
    "The same shares of the variance from the runs themselves and from a surrogate fitted to them: "
    "where they differ by more than their intervals, trust neither.",
)
DELTA = Family(
    "delta_indices",
    "Delta indices",
    (Measure("delta", "delta"), Measure("delta_first_order", "first order", optional=True)),
    "Index (–)",
    "Delta: half the area by which the density of a response changes, on average, once the "
    "parameter is known (Borgonovo); beside it the first-order index from the same runs.",
)
PAWN = Family(
    "pawn_indices",
    "PAWN indices",
    (Measure("pawn", "median"), Measure("pawn_maximum", "largest", optional=True)),
    "Kolmogorov-Smirnov distance (–)",
    "Distance between the distribution of a response and the same with the parameter held in one "
    "part of its range: median and largest over the parts (Pianosi and Wagener).",
)
REGRESSION = Family(
    "regression_indices",
    "Regression coefficients",
    (Measure("regression", "of values"), Measure("rank_regression", "of ranks", optional=True)),
    "Standardised coefficient (–)",
    "Standard deviations by which a response rises with one standard deviation of the parameter, "
    "in a linear fit of values and of ranks. They tell no more than the fit does: see R².",
    shares=False,
)
MORRIS = Family(
    "morris_plane",
    "Elementary effects (Morris)",
    (Measure("morris_mu_star", "mean of magnitudes"),),
    "Mean of magnitudes µ*",
    "How far a response moves, on average, when one parameter goes through its whole range (µ*), "
    "and how much this depends on where the others are (σ).",
    shares=False,
)
RANKED = (SOBOL, MORRIS, DELTA, PAWN, REGRESSION)
"""Families that rank the parameters, each by one measure of theirs (`ranking`)."""


def ranking(family: Family, analysis: xr.Dataset) -> Measure:
    """Return the measure that ranks the parameters: the total order where given, else the first."""
    return family.measures_in(analysis)[-1 if family in (SOBOL, SURROGATE) else 0]


def analysed(runs: xr.Dataset, analysis: xr.Dataset, *needed: str) -> list[str]:
    """Return the responses of the runs that are in the analysis; none if it lacks what is needed.

    needed: variables of the analysis.
    """
    complete = all(name in analysis for name in needed)
    return [name for name in responses(runs) if complete and known(analysis, name)]


HISTORY_VERDICT = "history_verdict"
OVER_TIME = {"first_order_over_time": "first order", "total_order_over_time": "total order"}
"""Indices at each time, and their names in words."""


def histories(analysis: xr.Dataset) -> list[str]:
    """Return the histories that the analysis has indices of."""
    complete = all(name in analysis for name in (*OVER_TIME, "history_mean", HISTORY_VERDICT))
    return [str(name) for name in analysis["history"].values] if complete else []


def parameters(analysis: xr.Dataset) -> list[str]:
    """Return the names of the varied parameters, or of their groups."""
    return [str(name) for name in analysis["parameter"].values]


def index(analysis: xr.Dataset, measure: str, response: str) -> Index:
    """Return one measure of one response."""

    def beside(kind: str, gap: float) -> Floats:
        nothing = xr.full_like(analysis[measure], np.nan)
        companion = analysis.get(f"{measure}_{kind}", nothing).sel(response=response)
        return np.asarray(np.nan_to_num(companion.values, nan=gap))

    dummy = (f"dummy_{measure}", f"dummy_{measure}_interval")
    ends = [analysis[name].sel(response=response).item() for name in dummy if name in analysis]
    return Index(
        analysis[measure].sel(response=response).values,
        beside("interval", gap=np.inf),
        beside("numerical", gap=0.0),
        float(sum(np.nan_to_num(abs(end)) for end in ends)),
    )
