"""The likelihood of measurements by a surrogate, whose errors and theirs are normal.

The errors are the measurements' uncertainties, the error of the surrogate on runs held out, which
neighbouring conditions share, and the numerical uncertainty of the runs: Kennedy and O'Hagan
(2001), J. R. Stat. Soc. B 63, 425 (recalled, not read), with a discrepancy of given size in place
of a fitted one.
"""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

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


class Likelihood:
    """The likelihood of measurements at points of the unit cube, whose axes are the prior's.

    numerical: relative expanded uncertainty of responses; model_error: see posterior.calibrated.
    free: calibrated parameters, which no measurement states. measured: values, error: standard
    error of the surrogate, both (measurements,). covariance: of all errors together,
    (measurements, measurements).

    Raises ValueError, with every reason, where the surrogate cannot predict a measurement.
    """

    def __init__(
        self,
        surrogate: Surrogate,
        measurements: Sequence[Measurement],
        numerical: Mapping[str, float],
        model_error: float,
    ) -> None:
        """Match a surrogate with measurements."""
        reasons = list(_mismatches(surrogate, measurements))
        stated = [measurement.conditions for measurement in measurements]
        names, probability = surrogate.parameters, surrogate.probability
        self.free = tuple(n for n in names if not all(n in conditions for conditions in stated))
        reasons += _contradictions(self.free, measurements)
        if reasons:
            raise ValueError("\n".join(dict.fromkeys(reasons)))
        self.surrogate, self.measurements = surrogate, measurements
        self._common = tuple(name for name in names if name not in self.free)
        self._conditions = np.array(
            [[probability(n, float(conditions[n])) for n in self._common] for conditions in stated]
        )
        sampled = surrogate.dataset.sel(parameter=list(self.free))
        ends = zip(self.free, sampled["lowest"].values, sampled["highest"].values, strict=True)
        self._limits = np.array([[probability(n, float(end)) for end in pair] for n, *pair in ends])
        responses = surrogate.responses
        self._rows = np.array([responses.index(entry.quantity) for entry in measurements])
        self.measured = np.array([measurement.value for measurement in measurements])
        # root mean square over the prior: the error grows towards the ends of the ranges
        points = np.random.default_rng(_SEED).random((len(self.free), _POINTS)).T
        self.error = np.empty(len(measurements))
        for inputs, numbers in self._places(points):
            squares = np.mean(surrogate.errors(inputs) ** 2, axis=1)
            self.error[numbers] = np.sqrt(squares)[self._rows[numbers]] / COVERAGE
        self.covariance = self._covariance(numerical, model_error)
        self._whitening = np.linalg.inv(np.linalg.cholesky(self.covariance))

    def _covariance(self, numerical: Mapping[str, float], model_error: float) -> Floats:
        quantities = np.array([measurement.quantity for measurement in self.measurements])
        sources = np.array([measurement.source for measurement in self.measurements])
        total = np.array([measurement.standard_uncertainty for measurement in self.measurements])
        systematic = np.array([entry.systematic_uncertainty for entry in self.measurements])
        of_grid = [numerical.get(name, 0.0) / 2.0 for name in quantities] * self.measured
        of_model = model_error * self.measured
        alike = quantities[:, None] == quantities
        common = alike & (sources[:, None] == sources)
        covariance = np.diag(total**2 - systematic**2) + np.outer(systematic, systematic) * common
        # neighbouring predictions have nearly the same error, however often they are measured
        distance = np.linalg.norm(self._conditions[:, None] - self._conditions, axis=-1)
        covariance = covariance + np.outer(self.error, self.error) * alike * np.exp(
            -distance / REACH
        )
        shared = np.outer(of_grid, of_grid) + np.outer(of_model, of_model)
        return np.asarray(covariance + shared * alike)

    def _prior(self, points: Floats) -> Floats:
        """Return the probabilities of the free parameters at points of the cube, of its shape."""
        low, high = self._limits.T
        return np.asarray(low + (high - low) * points)

    def _places(self, points: Floats) -> Iterator[tuple[Floats, list[int]]]:
        """Yield the probabilities of all parameters at points, (points, parameters).

        They are those of one set of conditions, and come with the numbers of its measurements.
        """
        places: dict[tuple[float, ...], list[int]] = {}
        for number, conditions in enumerate(self._conditions.tolist()):
            places.setdefault(tuple(conditions), []).append(number)
        for conditions, numbers in places.items():
            columns = dict(zip(self.free, self._prior(points).T, strict=True))
            pairs = zip(self._common, conditions, strict=True)
            columns |= {name: np.full(len(points), value) for name, value in pairs}
            yield np.column_stack([columns[name] for name in self.surrogate.parameters]), numbers

    def values(self, points: Floats) -> Floats:
        """Return the free parameters at points of the cube, in SI units, (points, free)."""
        distributions = [distribution_of(self.surrogate.distribution(n)) for n in self.free]
        columns = zip(distributions, self._prior(points).T, strict=True)
        return np.array([distribution.quantile(column) for distribution, column in columns]).T

    def predicted(self, points: Floats) -> Floats:
        """Return the surrogate at each measurement, (points, measurements)."""
        predictions = np.empty((len(points), len(self.measurements)))
        for inputs, numbers in self._places(points):
            predictions[:, numbers] = self.surrogate.at(inputs)[self._rows[numbers]].T
        return predictions

    def squared(self, predicted: Floats) -> Floats:
        """Return the squared distance of predictions from the data, in all errors, (points,)."""
        residuals = (predicted - self.measured) @ self._whitening.T
        return np.asarray((residuals**2).sum(axis=1))

    def log(self, points: Floats) -> Floats:
        """Return the logarithm of the likelihood, (points,)."""
        constant = np.linalg.slogdet(2 * np.pi * self.covariance)[1]
        return np.asarray(-0.5 * (self.squared(self.predicted(points)) + constant))


def _contradictions(free: Sequence[str], measurements: Sequence[Measurement]) -> Iterator[str]:
    """Yield the reasons why these parameters cannot be calibrated."""
    for name in free:
        if stating := [entry.quantity for entry in measurements if name in entry.conditions]:
            yield f"{name}: is stated for {stating[0]} but not for all: state it for all, or none"
    if not 0 < len(free) <= MOST:
        yield (
            f"{len(free)} parameters are left to calibrate ({', '.join(free) or 'none'}): vary 1 "
            f"to {MOST} that no measurement states"
        )


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
