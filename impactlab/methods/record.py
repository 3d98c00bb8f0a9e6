"""Records of indices: their variables, how they are estimated, shown and judged."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import xarray as xr

from impactlab.methods.runs import Sample
from impactlab.methods.verdict import SensitivityVerdict
from impactlab.types import Floats

PAIR = ("parameter", "other_parameter")
BY_SAMPLES = ("base_samples", "parameter")


@dataclass(frozen=True)
class IndexVariable:
    """One index of a response, as a variable of the analysis.

    estimator: its source, with the equation; dims: those beside `response`; units: None where it
    has the unit of its response; interval: whether it comes with one; comment: what a reader of
    the number has to know.
    """

    long_name: str
    estimator: str
    dims: tuple[str, ...] = ("parameter",)
    units: str | None = "1"
    interval: bool = True
    comment: str = ""

    @classmethod
    def of_dummy(cls, long_name: str, estimator: str) -> IndexVariable:
        """Return the index of a dummy parameter, see `estimators.dummy_column`."""
        return cls(long_name, estimator, (), comment="of a random column that the model never saw")


@dataclass(frozen=True)
class Measure:
    """A variable of the analysis on (response, parameter), and its name in words.

    optional: shown where it is given.
    """

    name: str
    label: str
    optional: bool = False


_OVERLAP = "the index of each includes what it shares with the others, and indices overlap"


@dataclass(frozen=True)
class Family:
    """Measures that are shown side by side, in one figure and in tables.

    figure: name of their figure; title: heads it and the tables. axis: label of their axis.
    meaning: of the numbers, in a sentence or two. shares: True for shares of a whole. ranking: the
    measure that ranks the parameters where it is given; the first one otherwise. explained:
    variable with the share of the variance that they tell of, if they are coefficients of a fit.
    if_correlated: what the numbers mean where parameters are correlated.
    """

    figure: str
    title: str
    measures: tuple[Measure, ...]
    axis: str
    meaning: str
    shares: bool = True
    ranking: str = ""
    explained: str = ""
    if_correlated: str = _OVERLAP

    def given(self, analysis: xr.Dataset) -> bool:
        """Return whether the analysis has every measure that is not optional."""
        return all(measure.name in analysis for measure in self.measures if not measure.optional)

    def measures_in(self, analysis: xr.Dataset) -> list[Measure]:
        """Return the measures that the analysis has."""
        return [measure for measure in self.measures if measure.name in analysis]

    def ranked_by(self, analysis: xr.Dataset) -> Measure:
        """Return the measure that ranks the parameters."""
        measures = self.measures_in(analysis)
        return next((entry for entry in measures if entry.name == self.ranking), measures[0])


@dataclass(frozen=True)
class Indices:
    """The indices that one method estimates.

    name: as in study files. variables: by name. family: how they are shown. check: raises
    ValueError where the runs are not the sample that their attributes describe. estimate: from
    finite and varying outputs (runs,), the sample and the response's name to indices and
    half-widths, by variable name. judge: from these to verdicts, empty for the best. varying: the
    parts of the outputs each of which has to vary. fewest: least number of runs. most: largest
    number of parameters, 0 for any. of_limits: whether they need a limit of a response. order: why
    the values need an order, which words have not; "" where they do not.
    """

    name: str
    variables: Mapping[str, IndexVariable]
    family: Family
    check: Callable[[Sample], None]
    estimate: Callable[[Floats, Sample, str], dict[str, Floats]]
    judge: Callable[[Mapping[str, Floats]], list[SensitivityVerdict]]
    varying: Callable[[Floats, Sample], list[Floats]] = lambda outputs, sample: [outputs]
    fewest: int = 1
    most: int = 0
    of_limits: bool = False
    order: str = ""
