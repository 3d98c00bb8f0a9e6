"""Sensitivity measures of every method: their indices, intervals and noise floors."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from impactlab.figures.access import known, responses
from impactlab.methods import FAMILIES, indices_of, morris, sobol
from impactlab.methods.record import Family, Measure
from impactlab.types import Floats
from impactlab.verdicts import ROUND_OFF


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


SOBOL, MORRIS = sobol.FAMILY, morris.FAMILY
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
    ranking="surrogate_total_order",
)


def families(runs: xr.Dataset, analysis: xr.Dataset) -> list[Family]:
    """Return the families of measures in the analysis, first that of the indices named first."""
    first = [record.family for record in indices_of(runs.attrs)]
    return [family for family in dict.fromkeys([*first, *FAMILIES]) if family.given(analysis)]


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


def meanings(analysis: xr.Dataset) -> list[str]:
    """Return the meanings of the varied parameters, or the names of their groups in words."""
    texts = analysis.get("parameter_long_name", analysis["parameter"]).values
    return [str(text).replace("_", " ") for text in texts]


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
