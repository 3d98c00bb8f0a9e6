"""The likelihood of measurements by a surrogate, whose errors and theirs are normal.

The errors are the measurements' uncertainties, the error of the surrogate on runs held out, which
neighbouring conditions share, and the numerical uncertainty of the runs: Kennedy and O'Hagan
(2001), J. R. Stat. Soc. B 63, 425 (recalled, not read), with a discrepancy of given size in place
of a fitted one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from impactlab.analysis.measurements import COVERAGE, Measurement, same
from impactlab.analysis.surrogate.from_runs import SurrogateVerdict
from impactlab.analysis.surrogate.stored import Surrogate
from impactlab.methods.distributions import distribution_of
from impactlab.types import Floats

MOST = 5  # largest number of calibrated parameters
REACH = 0.3
"""Difference of two conditions, in probability, at which the correlation of the surrogate's errors
has fallen to 1/e: by measured coverage, see tests/benchmarks/calibration_coverage.py."""
_POINTS, _SEED = 256, 1  # of the prior, over which the surrogate's error is averaged


@dataclass(frozen=True)
class Likelihood:
    """The likelihood of measurements at points of the unit cube, whose axes are the prior's.

    numerical: relative expanded uncertainty of responses; model_error: see posterior.calibrated.

    Raises ValueError, with every reason, where the surrogate cannot predict a measurement.
    """

    surrogate: Surrogate
    measurements: Sequence[Measurement]
    numerical: Mapping[str, float]
    model_error: float

    def __post_init__(self) -> None:
        reasons = list(_mismatches(self.surrogate, self.measurements))
        for name in self.free:
            pairs = zip(self.measurements, self._stated, strict=True)
            if quantities := [entry.quantity for entry, stated in pairs if name in stated]:
                reasons.append(
                    f"{name}: is stated for {quantities[0]} but not for all: state it for all, or "
                    "none"
                )
        if not 0 < len(self.free) <= MOST:
            reasons.append(
                f"{len(self.free)} parameters are left to calibrate "
                f"({', '.join(self.free) or 'none'}): vary 1 to {MOST} that no measurement states"
            )
        if reasons:
            raise ValueError("\n".join(dict.fromkeys(reasons)))

    @cached_property
    def _stated(self) -> list[dict[str, float]]:
        """The varied parameters that each measurement states, in SI units."""
        return [
            {
                name: float(measurement.conditions[name])
                for name in self.surrogate.parameters
                if name in measurement.conditions
            }
            for measurement in self.measurements
        ]

    @cached_property
    def free(self) -> tuple[str, ...]:
        """The calibrated parameters: those that not all measurements state."""
        names = self.surrogate.parameters
        return tuple(n for n in names if not all(n in stated for stated in self._stated))

    @cached_property
    def _common(self) -> tuple[str, ...]:
        """The varied parameters that all measurements state."""
        return tuple(name for name in self.surrogate.parameters if name not in self.free)

    @cached_property
    def _conditions(self) -> Floats:
        """The probabilities of these, (measurements, common)."""
        probability = self.surrogate.probability
        return np.array([[probability(n, row[n]) for n in self._common] for row in self._stated])

    @cached_property
    def _places(self) -> dict[tuple[float, ...], list[int]]:
        """The numbers of the measurements at each of the distinct conditions."""
        places: dict[tuple[float, ...], list[int]] = {}
        for number, conditions in enumerate(self._conditions.tolist()):
            places.setdefault(tuple(conditions), []).append(number)
        return places

    @cached_property
    def _limits(self) -> Floats:
        """Probabilities of the ends of the sampled ranges, (2, free)."""
        sampled = self.surrogate.dataset.sel(parameter=list(self.free))
        ends = zip(self.free, sampled["lowest"].values, sampled["highest"].values, strict=True)
        probability = self.surrogate.probability
        return np.array([[probability(name, float(end)) for end in pair] for name, *pair in ends]).T

    def _prior(self, points: Floats) -> Floats:
        """Return the probabilities of the free parameters at points of the cube, of its shape."""
        low, high = self._limits
        return np.asarray(low + (high - low) * points)

    def values(self, points: Floats) -> Floats:
        """Return the free parameters at points of the cube, in SI units, (points, free)."""
        distributions = [distribution_of(self.surrogate.distribution(n)) for n in self.free]
        columns = zip(distributions, self._prior(points).T, strict=True)
        return np.array([distribution.quantile(column) for distribution, column in columns]).T

    def _inputs(self, points: Floats, conditions: Sequence[float]) -> Floats:
        """Return the probabilities of all parameters, (points, parameters)."""
        columns = dict(zip(self.free, self._prior(points).T, strict=True))
        pairs = zip(self._common, conditions, strict=True)
        columns |= {name: np.full(len(points), value) for name, value in pairs}
        return np.column_stack([columns[name] for name in self.surrogate.parameters])

    @cached_property
    def _rows(self) -> NDArray[np.int64]:
        """The place of each measurement's quantity among the surrogate's responses."""
        responses = self.surrogate.responses
        return np.array([responses.index(entry.quantity) for entry in self.measurements])

    def predicted(self, points: Floats) -> Floats:
        """Return the surrogate at each measurement, (points, measurements)."""
        predictions = np.empty((len(points), len(self.measurements)))
        for conditions, numbers in self._places.items():
            answers = self.surrogate.at(self._inputs(points, conditions))
            predictions[:, numbers] = answers[self._rows[numbers]].T
        return predictions

    @cached_property
    def measured(self) -> Floats:
        """The measured values, (measurements,)."""
        return np.array([measurement.value for measurement in self.measurements])

    @cached_property
    def error(self) -> Floats:
        """The standard error of the surrogate at each measurement, (measurements,).

        It is the root mean square over the prior: the error grows towards the ends of the ranges.
        """
        points = np.random.default_rng(_SEED).random((len(self.free), _POINTS)).T
        error = np.empty(len(self.measurements))
        for conditions, numbers in self._places.items():
            widths = self.surrogate.errors(self._inputs(points, conditions))
            error[numbers] = np.sqrt(np.mean(widths**2, axis=1))[self._rows[numbers]] / COVERAGE
        return error

    @cached_property
    def covariance(self) -> Floats:
        """The covariance of all errors together, (measurements, measurements)."""
        quantities = np.array([measurement.quantity for measurement in self.measurements])
        sources = np.array([measurement.source for measurement in self.measurements])
        total = np.array([measurement.standard_uncertainty for measurement in self.measurements])
        systematic = np.array([entry.systematic_uncertainty for entry in self.measurements])
        numerical = [self.numerical.get(name, 0.0) / 2.0 for name in quantities] * self.measured
        of_model = self.model_error * self.measured
        alike = quantities[:, None] == quantities
        common = alike & (sources[:, None] == sources)
        covariance = np.diag(total**2 - systematic**2) + np.outer(systematic, systematic) * common
        # neighbouring predictions have nearly the same error, however often they are measured
        distance = np.linalg.norm(self._conditions[:, None] - self._conditions, axis=-1)
        covariance = covariance + np.outer(self.error, self.error) * alike * np.exp(
            -distance / REACH
        )
        shared = np.outer(numerical, numerical) + np.outer(of_model, of_model)
        return np.asarray(covariance + shared * alike)

    @cached_property
    def _whitening(self) -> Floats:
        return np.asarray(np.linalg.inv(np.linalg.cholesky(self.covariance)))

    def squared(self, predicted: Floats) -> Floats:
        """Return the squared distance of predictions from the data, in all errors, (points,)."""
        residuals = (predicted - self.measured) @ self._whitening.T
        return np.asarray((residuals**2).sum(axis=1))

    def log(self, points: Floats) -> Floats:
        """Return the logarithm of the likelihood, (points,)."""
        constant = np.linalg.slogdet(2 * np.pi * self.covariance)[1]
        return np.asarray(-0.5 * (self.squared(self.predicted(points)) + constant))


def _mismatches(surrogate: Surrogate, measurements: Sequence[Measurement]) -> Iterator[str]:
    """Yield the reasons why a surrogate cannot predict the measurements."""
    held = surrogate.dataset.coords
    for measurement in measurements:
        for name, value in measurement.conditions.items():
            if name in surrogate.parameters:
                try:
                    surrogate.probability(name, float(value))
                except ValueError as error:
                    yield f"{measurement.quantity}: {error}"
            elif name not in held or not same(held[name].item(), value):
                remark = (
                    f"it is {held[name].item()!r} in the study"
                    if name in held
                    else "the study has none"
                )
                yield f"{measurement.quantity}: was measured at {name} = {value!r}, but {remark}"
        if measurement.quantity not in surrogate.responses:
            responses = ", ".join(surrogate.responses)
            yield f"{measurement.quantity}: is no response of the study ({responses})"
            continue
        entry = surrogate.dataset.sel(response=measurement.quantity)
        verdict = list(SurrogateVerdict)[int(entry["verdict"])]
        if verdict is not SurrogateVerdict.USABLE:
            yield f"{measurement.quantity}: its surrogate is not usable: {verdict.meaning}"
        elif (rmse := float(entry["rmse"])) > measurement.standard_uncertainty:
            yield (
                f"{measurement.quantity}: the surrogate's error ({rmse:.3g} {measurement.units}) "
                "exceeds the standard uncertainty of the data "
                f"({measurement.standard_uncertainty:.3g}): draw more runs, or narrower ranges"
            )
