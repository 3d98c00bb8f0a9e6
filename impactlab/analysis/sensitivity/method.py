"""The sample under analysis, records of an index and of a method, and the bootstrap.

The bootstrap resamples functions of means by matrix products: the mean over a resample is the mean
weighted by how often each row was drawn, so that all resamples together are one product of counts
(resamples, rows) by rows (rows, columns). Efron and Tibshirani (1993), An Introduction to the
Bootstrap, sections 6.2 and 20.2.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.stats import norm

from impactlab.analysis.responses import listed

Array = npt.NDArray[np.float64]

CONFIDENCE = 0.95
RESAMPLES = 200
"""Bootstrap resamples: give the width of an interval to 5 % (1/sqrt(2 resamples))."""
POLICIES = ("fail", "impute")


@dataclass(frozen=True)
class Sample:
    """A sample, and the settings of its indices.

    groups: the group of each parameter; empty where each stands for itself. inputs: (runs,
    parameter), in SI units and in the order of the runs. settings: the attributes of the runs.
    """

    parameters: tuple[str, ...]
    groups: tuple[str, ...]
    inputs: Array
    settings: Mapping[Any, Any]

    @classmethod
    def of(cls, runs: xr.Dataset) -> Sample:
        """Return the sample of runs, from their coordinates and attributes."""
        names = listed(runs, "varied")
        ordered = runs.sortby("run")
        return cls(
            parameters=tuple(names),
            groups=tuple(listed(runs, "groups")) if "groups" in runs.attrs else (),
            inputs=np.stack([np.asarray(ordered[name].values, float) for name in names], axis=1),
            settings=runs.attrs,
        )

    @property
    def factors(self) -> tuple[str, ...]:
        """Names of the indices: groups in order of appearance, or parameters."""
        return tuple(dict.fromkeys(self.groups or self.parameters))

    @property
    def confidence(self) -> float:
        """Confidence level of the intervals, in (0, 1)."""
        return float(self.settings.get("confidence", CONFIDENCE))

    @property
    def resamples(self) -> int:
        """Number of bootstrap resamples."""
        return int(self.settings.get("resamples", RESAMPLES))

    @property
    def policy(self) -> str:
        """Policy for failed runs. Raises ValueError for an unknown one."""
        policy = str(self.settings.get("failed_runs", POLICIES[0]))
        if policy not in POLICIES:
            raise ValueError(f"{self.study}: failed_runs = {policy!r}: choose from fail, impute")
        return policy

    @property
    def study(self) -> str:
        """The study's name, for messages."""
        return f"the study {str(self.settings.get('study', '?'))!r}"

    def number(self, setting: str) -> int:
        """Return a whole number that the method needs. Raises ValueError where it is absent."""
        if setting not in self.settings:
            raise ValueError(
                f"the runs of {self.study} have no attribute {setting}: solve the study again"
            )
        return int(self.settings[setting])

    def expect(self, runs: int, words: str) -> None:
        """Raise ValueError unless the sample has this number of runs; words: where it is from."""
        if len(self.inputs) != runs:
            raise ValueError(
                f"{self.study} has {len(self.inputs)} runs, but {words} make {runs}: solve it again"
            )

    def ungrouped(self) -> None:
        """Raise ValueError where groups are stated for a method that has none."""
        if self.groups:
            raise ValueError(
                f"{self.study}: the method {self.settings['method']!r} has no groups: remove them, "
                "or use sobol or morris"
            )

    def rng(self, *purpose: str) -> np.random.Generator:
        """Return the random stream of a purpose, such as a response, independent of all others."""
        key = tuple("\0".join(purpose).encode())
        seed = self.number("seed")
        return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))

    def half_width(self, replicates: Array) -> Array:
        """Return half-widths of intervals from bootstrap replicates (resamples, ...).

        NaN where a replicate is: a resample without variance has no index.
        """
        quantile = float(norm.ppf(0.5 + self.confidence / 2))
        return np.asarray(quantile * replicates.std(axis=0, ddof=1))


Stored = dict[str, tuple[tuple[str, ...], Array, dict[str, object]]]

FACTOR = ("parameter",)
PAIR = ("parameter", "other_parameter")
BY_SAMPLES = ("base_samples", "parameter")


@dataclass(frozen=True)
class Index:
    """One index of a response.

    estimator: its source, with the equation; dims: those beside `response`; units: None where it
    has the unit of its response; interval: whether it comes with one; comment: what a reader of
    the number has to know.
    """

    long_name: str
    estimator: str
    dims: tuple[str, ...] = FACTOR
    units: str | None = "1"
    interval: bool = True
    comment: str = ""

    def attributes(self) -> dict[str, object]:
        """Return the attributes of its variable."""
        attrs: dict[str, object] = {"long_name": self.long_name, "estimator": self.estimator}
        attrs |= {"units": self.units} if self.units else {}
        return attrs | ({"comment": self.comment} if self.comment else {})

    def interval_attributes(self, sample: Sample) -> dict[str, object]:
        """Return the attributes of the variable of its half-width."""
        words = f"half-width of the {100 * sample.confidence:g} % interval of the {self.long_name}"
        own = {"confidence": sample.confidence, "resamples": sample.resamples}
        return self.attributes() | {"long_name": words} | own


def index_variables(
    rows: Sequence[Mapping[str, Array]],
    indices: Mapping[str, Index],
    sample: Sample,
    sizes: Mapping[str, int],
) -> Stored:
    """Return dataset variables from one mapping of indices per response; an empty one is NaN."""
    variables: Stored = {}
    for name, index in indices.items():
        gap = np.full([sizes[dim] for dim in index.dims], np.nan)
        kinds = {name: index.attributes()}
        if index.interval:
            kinds[f"{name}_interval"] = index.interval_attributes(sample)
        for key, attrs in kinds.items():
            stacked = np.array([row[key] if row else gap for row in rows], float)
            variables[key] = (("response", *index.dims), stacked, attrs)
    return variables


def dummy_column(runs: int, rng: np.random.Generator) -> Array:
    """Return values of a parameter that the model never saw, (runs,): its indices are noise.

    A Latin hypercube in one dimension, in the open interval (0, 1).
    """
    return (rng.permutation(runs) + 0.5) / runs


Estimator = Callable[[Array], Mapping[str, Array]]
"""From means (..., columns) to indices (..., *dims)."""
_CELLS = 2_000_000
"""Number of counts held at a time: 16 MB, and about three times that while they are drawn."""


def counts(rows: int, resamples: int, rng: np.random.Generator) -> Iterator[Array]:
    """Yield how often each row is drawn: (some resamples, rows), of `resamples` in all.

    The draws do not depend on how many are held at a time.
    """
    chunk = max(1, _CELLS // rows)
    for start in range(0, resamples, chunk):
        number = min(chunk, resamples - start)
        drawn = rng.integers(rows, size=(number, rows)) + rows * np.arange(number)[:, None]
        tallied = np.bincount(drawn.ravel(), minlength=number * rows)
        yield tallied.reshape(number, rows).astype(float)


def half_widths(
    columns: Array, estimator: Estimator, sample: Sample, rng: np.random.Generator
) -> dict[str, Array]:
    """Return half-widths of intervals of everything the estimator gives, by `<name>_interval`.

    columns: (rows, columns), resampled by row.
    """
    parts = [
        estimator(tally @ columns / len(columns))
        for tally in counts(len(columns), sample.resamples, rng)
    ]
    return {
        f"{name}_interval": sample.half_width(np.concatenate([part[name] for part in parts]))
        for name in parts[0]
    }


def _whole(outputs: Array, sample: Sample) -> list[Array]:
    return [outputs]


@dataclass(frozen=True)
class SensitivityMethod:
    """One method of sensitivity analysis.

    name: as in study files. indices: its indices of a sample, by variable name. check: raises
    ValueError where the runs are not the sample that their attributes describe. estimate: from
    finite and varying outputs (runs,), the sample and the response's name to indices and
    half-widths, by variable name. varying: the parts of the outputs each of which has to vary.
    """

    name: str
    indices: Callable[[Sample], Mapping[str, Index]]
    check: Callable[[Sample], None]
    estimate: Callable[[Array, Sample, str], dict[str, Array]]
    varying: Callable[[Array, Sample], list[Array]] = _whole
