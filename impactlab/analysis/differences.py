"""Differences between the sensitivity indices of studies, and those that chance does not explain.

Two Sobol samples are compared replicate by replicate: the jackknife over pairs of replicates gives
the error of the difference whether or not the samples share their draws, as those of one seed do.
Of other methods only the half-widths are known, whose sum bounds the error for any dependence. All
intervals of a response hold together (Bonferroni), so that in 95 % of responses no difference is
called one that is none.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Self

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr

from impactlab.methods import indices_of, sobol
from impactlab.methods.runs import Sample, usable
from impactlab.types import Floats
from impactlab.verdicts import ROUND_OFF

METHOD = (
    "Differences of Sobol indices have the error of a jackknife over pairs of replicates, with "
    "Student's t; those of other indices, the sum of both half-widths. The intervals of all "
    "differences of a response hold together with {confidence} (Bonferroni), and numerical errors "
    "are added to them."
)
"""How differences are judged, for reports."""


@dataclass(frozen=True)
class _Estimates:
    """Indices of a response in one study: values, half_widths and numerical (measure, parameter).

    degrees: of freedom of the half-widths. replicates: the indices without each replicate,
    (replicate, measure, parameter); None where the method has none.
    """

    values: Floats
    half_widths: Floats
    numerical: Floats
    degrees: float
    confidence: float
    replicates: Floats | None

    @classmethod
    def of(
        cls,
        runs: xr.Dataset,
        analysis: xr.Dataset,
        response: str,
        measures: Sequence[str],
        parameters: Sequence[str],
    ) -> Self:
        """Return the estimates for these measures and parameters."""
        indices = analysis.sel(response=response, parameter=list(parameters))
        nothing = np.zeros(len(parameters))
        values, half_widths, numerical = (
            np.stack(
                [indices.get(f"{name}{end}", xr.DataArray(nothing)).values for name in measures]
            )
            for end in ("", "_interval", "_numerical")
        )
        sample, degrees, replicates = Sample.of(runs), np.inf, None
        method = indices_of(runs.attrs)[0].name
        if method == "fast":
            degrees = sample.number("curves") / (len(sample.parameters) + 1) - 1
        if method == "sobol":
            without = sobol.leaving_out(usable(sample.runs, response).values[0], sample)
            places = [sample.factors.index(name) for name in parameters]
            replicates = np.stack([without[name][1:, places] for name in measures], axis=1)
            degrees = len(replicates) - 1.0
        numerical = np.nan_to_num(numerical)
        return cls(values, half_widths, numerical, degrees, sample.confidence, replicates)

    def reach(self, chance: float) -> Floats:
        """Return half-widths of intervals that fail with this chance."""
        quantiles = scipy.stats.t.ppf([1 - chance / 2, 0.5 + self.confidence / 2], self.degrees)
        return self.half_widths * float(quantiles[0] / quantiles[1])


def differences(
    studies: Sequence[tuple[xr.Dataset, xr.Dataset]], response: str, measures: Sequence[str]
) -> xr.Dataset:
    """Return the differences of a response's indices between all pairs of studies.

    studies: runs and analysis of each. measures: variables of all analyses on (response,
    parameter). Returns, on (pair, measure, parameter), of the parameters that all studies share:
    difference, of the second study of the pair less the first; difference_interval, half-widths
    that hold together; is_significant, where a difference exceeds that and the numerical errors.
    Coordinates `first` and `second` number the studies of a pair.
    """
    analyses = [analysis for _, analysis in studies]
    parameters = [
        name
        for name in analyses[0]["parameter"].values.tolist()
        if all(name in analysis["parameter"].values for analysis in analyses)
    ]
    estimates = [_Estimates.of(*study, response, measures, parameters) for study in studies]
    pairs = list(combinations(range(len(studies)), 2))
    tests = len(pairs) * len(measures) * len(parameters)
    chance = (1 - estimates[0].confidence) / max(1, tests)
    rows = [_difference(estimates[a], estimates[b], chance) for a, b in pairs]
    values, intervals, numerical = (np.stack(columns) for columns in zip(*rows, strict=True))
    dims = ("pair", "measure", "parameter")
    largest = np.nanmax(np.abs([entry.values for entry in estimates]), initial=0.0)
    significant = np.abs(values) > intervals + numerical + ROUND_OFF * largest
    return xr.Dataset(
        {
            "difference": (dims, values),
            "difference_interval": (dims, intervals),
            "is_significant": (dims, significant),
        },
        {
            "measure": list(measures),
            "parameter": parameters,
            "first": ("pair", [a for a, _ in pairs]),
            "second": ("pair", [b for _, b in pairs]),
        },
    )


def _difference(first: _Estimates, second: _Estimates, chance: float) -> tuple[Floats, ...]:
    """Return a difference, its half-width, and what both numerical errors could change it by."""
    interval = first.reach(chance) + second.reach(chance)
    one, other = first.replicates, second.replicates
    if one is not None and other is not None and one.shape == other.shape:
        size = len(one)
        error = np.sqrt((size - 1) * (other - one).var(axis=0))
        interval = scipy.stats.t.ppf(1 - chance / 2, size - 1) * error
    return second.values - first.values, interval, first.numerical + second.numerical
