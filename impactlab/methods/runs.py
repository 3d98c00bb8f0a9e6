"""The runs of a study: attributes, responses, parameters, factors; a dummy, bootstrap, jackknife.

The bootstrap resamples functions of means by matrix products: the mean over a resample is the mean
weighted by how often each row was drawn, so that all resamples together are one product of counts
(resamples, rows) by rows (rows, columns). Efron and Tibshirani (1993), An Introduction to the
Bootstrap, sections 6.2 and 20.2.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr
from numpy.typing import NDArray

from impactlab.methods.distributions import CHOICE
from impactlab.types import Floats
from impactlab.variables import status_bits


def listed(runs: xr.Dataset, attribute: str) -> list[str]:
    """Return a list attribute as a list: netCDF gives a list of one back as a plain string."""
    return [str(entry) for entry in np.atleast_1d(runs.attrs[attribute])]


def correlations(runs: xr.Dataset) -> list[tuple[str, str, float]]:
    """Return pairs of parameters and the rank correlation that they were drawn with."""
    if "correlated" not in runs.attrs:
        return []
    ranks = np.atleast_1d(runs.attrs["rank_correlations"]).tolist()
    pairs = [entry.split() for entry in listed(runs, "correlated")]
    return [(name, other, float(rank)) for (name, other), rank in zip(pairs, ranks, strict=True)]


def in_order(runs: xr.Dataset) -> xr.Dataset:
    """Return a sample in the order of `run`: as it is, not read, where it has that order."""
    numbers = runs["run"].values
    return runs if (numbers[1:] >= numbers[:-1]).all() else runs.sortby("run")


def usable(runs: xr.Dataset, response: str | None = None) -> xr.DataArray:
    """Return the requested responses in SI units on (response, *design dims).

    NaN where a run gives no usable number: it is not finite, or its status excludes it. Coordinates
    response_units and response_long_name describe each one. response: this one alone, without the
    coordinates on `run`, so that memory holds little beside it. Raises ValueError when a requested
    response is not among the variables.
    """
    names = listed(runs, "responses") if response is None else [response]
    described = labels(runs, names)
    if response is None:
        values = runs[names].compute().to_array("response", name="value")
    else:
        alone = runs[response].rename("value")
        of_runs = [name for name, coordinate in alone.coords.items() if "run" in coordinate.dims]
        values = alone.drop_vars(of_runs).compute().expand_dims(response=[response])
    values = values.astype(float, copy=False).assign_coords(described)
    status = xr.DataArray(runs["status"].variable.compute())
    bits = np.array([status_bits([name]) for name in names], status.dtype)
    excluded = (status & xr.DataArray(bits, dims="response")) != 0
    good = np.isfinite(values) & ~excluded.transpose(*values.dims)
    return values if good.all() else values.where(good)


def labels(runs: xr.Dataset, names: Sequence[str] = ()) -> dict[str, Any]:
    """Return the coordinates of these responses, of all requested ones by default.

    Raises ValueError when one is not among the variables.
    """
    names = names or listed(runs, "responses")
    if absent := [name for name in names if name not in runs.data_vars]:
        raise ValueError(
            f"the runs of study {runs.attrs.get('study', '?')!r} hold no {', '.join(absent)}, "
            "which its attribute `responses` lists: solve the study again"
        )
    attributes = {
        f"response_{key}": ("response", [str(runs[name].attrs.get(key, "")) for name in names])
        for key in ("units", "long_name")
    }
    return {"response": ("response", list(names), {"long_name": "response"}), **attributes}


@dataclass(frozen=True)
class Sample:
    """A sample, and the settings of its indices.

    groups: the group of each parameter; empty where each stands for itself. runs: in their order,
    perhaps not read. settings: the attributes of the runs.
    """

    parameters: tuple[str, ...]
    groups: tuple[str, ...]
    runs: xr.Dataset
    settings: Mapping[Any, Any]

    @classmethod
    def of(cls, runs: xr.Dataset) -> Self:
        """Return the sample of runs, from their coordinates and attributes."""
        return cls(
            parameters=tuple(listed(runs, "varied")),
            groups=tuple(listed(runs, "groups")) if "groups" in runs.attrs else (),
            runs=in_order(runs),
            settings=runs.attrs,
        )

    @property
    def size(self) -> int:
        """The number of runs."""
        return int(self.runs.sizes["run"])

    @cached_property
    def inputs(self) -> Floats:
        """The parameters of all runs, (runs, parameter): held in memory once used; see `column`."""
        return np.stack([self.column(name) for name in self.parameters], axis=1)

    @cached_property
    def words(self) -> dict[str, list[str]]:
        """The words of each parameter that is drawn among words, by its name."""
        attrs = {name: self.runs[name].attrs for name in self.parameters}
        choices = {
            n: entry["values"] for n, entry in attrs.items() if entry.get("distribution") == CHOICE
        }
        return {name: [str(word) for word in np.atleast_1d(choices[name])] for name in choices}

    def column(self, parameter: str) -> Floats:
        """Return a parameter in all runs, (runs,), in SI units; of words, their places in `words`.

        The places only tell words apart: they have no order. Raises ValueError for other words.
        """
        values = self.runs[parameter].values
        if parameter not in self.words:
            return np.asarray(values, float)
        choices = self.words[parameter]
        places = sum(place * (values == word) for place, word in enumerate(choices, 1))
        if not np.all(places):
            raise ValueError(f"the runs of {self.study} hold words of {parameter} not drawn from")
        return np.asarray(places, float) - 1

    def rows(self, runs: NDArray[np.int64]) -> Floats:
        """Return the parameters of these runs, (runs, parameter); one column is read at a time."""
        return np.stack([self.column(name)[runs] for name in self.parameters], axis=1)

    @property
    def memberships(self) -> tuple[str, ...]:
        """The factor of each parameter: its group, or its own name."""
        return self.groups or self.parameters

    @property
    def factors(self) -> tuple[str, ...]:
        """Names of the indices: groups in order of appearance, or parameters."""
        return tuple(dict.fromkeys(self.memberships))

    @property
    def confidence(self) -> float:
        """Confidence level of the intervals, in (0, 1)."""
        return float(self.settings.get("confidence", 0.95))

    @property
    def resamples(self) -> int:
        """Number of bootstrap resamples: 200 give the width of an interval to 5 %."""
        return int(self.settings.get("resamples", 200))

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

    def expect(self, runs: int, origin: str) -> None:
        """Raise ValueError unless the sample has this number of runs; origin: where it is from."""
        if self.size != runs:
            raise ValueError(
                f"{self.study} has {self.size} runs, but {origin} make {runs}: solve it again"
            )

    def ordered(self) -> None:
        """Raise ValueError where words are drawn for a method that needs an order of the values."""
        if self.words:
            raise ValueError(
                f"{self.study}: the method {self.settings['method']!r} needs an order of the "
                f"values, and {next(iter(self.words))} takes words: use sobol, delta or pawn"
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
        return np.random.default_rng(np.random.SeedSequence(self.number("seed"), spawn_key=key))

    @property
    def quantile(self) -> float:
        """Half-width of an interval over the standard error of a normal estimate."""
        return float(scipy.stats.norm.ppf(0.5 + self.confidence / 2))

    def half_width(self, replicates: Floats) -> Floats:
        """Return half-widths of intervals from replicates (resamples, ...), NaN where one is."""
        return np.asarray(self.quantile * replicates.std(axis=0, ddof=1))


def dummy_column(sample: Sample) -> Floats:
    """Return a Latin hypercube in (0, 1), (runs,): unseen by the model, its indices are noise."""
    runs = sample.size
    return (sample.rng("dummy").permutation(runs) + 0.5) / runs


def apart_from_dummy(name: str, values: Floats, margins: Floats) -> dict[str, Floats]:
    """Return indices and half-widths by variable name; of both, the last is that of the dummy."""
    return {
        name: values[:-1],
        f"{name}_interval": margins[:-1],
        f"dummy_{name}": values[-1],
        f"dummy_{name}_interval": margins[-1],
    }


_CELLS = 2_000_000
"""Number of counts held at a time: 16 MB, and about three times that while they are drawn."""


def counts(rows: int, resamples: int, rng: np.random.Generator) -> Iterator[Floats]:
    """Yield how often each row is drawn: (some resamples, rows), of `resamples` in all."""
    chunk = max(1, _CELLS // rows)  # the draws do not depend on it
    for start in range(0, resamples, chunk):
        number = min(chunk, resamples - start)
        draws = rng.integers(rows, size=(number, rows)) + rows * np.arange(number)[:, None]
        tallied = np.bincount(draws.ravel(), minlength=number * rows)
        yield tallied.reshape(number, rows).astype(float)


def half_widths(
    columns: Floats,
    estimator: Callable[[Floats], Mapping[str, Floats]],
    sample: Sample,
    *purpose: str,
) -> dict[str, Floats]:
    """Return half-widths of intervals of everything the estimator gives, by `<name>_interval`.

    columns: (rows, columns), resampled by row. estimator: from means (..., columns) to indices
    (..., *dims), by name. purpose: of the draws, see `Sample.rng`.
    """
    parts = [
        estimator(tally @ columns / len(columns))
        for tally in counts(len(columns), sample.resamples, sample.rng(*purpose))
    ]
    return {
        f"{name}_interval": sample.half_width(np.concatenate([part[name] for part in parts]))
        for name in parts[0]
    }


def leave_one_out(sums: Floats) -> Floats:
    """Return from sums of replicates, (replicate, ...), that of all, then those without each."""
    total = sums.sum(axis=0, keepdims=True)
    return np.concatenate([total, total - sums])


def half_width(estimates: Floats, confidence: float) -> Floats:
    """Return half-widths of intervals from estimates without one replicate each, (replicate, ...).

    The standard error is that of the jackknife (Efron and Tibshirani 1993, section 11.2), the
    quantile Student's. NaN where an estimate is, and of fewer than two replicates.
    """
    size = len(estimates)
    if size < 2:
        return np.full(estimates.shape[1:], np.nan)
    error = np.sqrt((size - 1) * estimates.var(axis=0))
    return np.asarray(scipy.stats.t.ppf(0.5 + confidence / 2, size - 1) * error)
