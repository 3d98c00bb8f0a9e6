"""Calibration: the posterior of parameters, and the weights of models, from measurements.

The likelihood is normal, with the measurements' uncertainties, the error of the surrogates on runs
held out, which neighbouring conditions share, and the numerical uncertainty of the runs: Kennedy
and O'Hagan (2001), J. R. Stat. Soc. B 63, 425 (recalled, not read), with a discrepancy of given
size in place of a fitted one. Weights of models are proportional to their evidence, times their
probability before.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from impactlab.analysis.importance import Posterior, modes, normalised, posterior
from impactlab.analysis.measurements import COVERAGE, Measurement, same
from impactlab.analysis.surrogate.from_runs import SurrogateVerdict
from impactlab.analysis.surrogate.stored import Surrogate
from impactlab.methods.distributions import distribution_of
from impactlab.types import Floats

MOST = 5  # largest number of calibrated parameters
FEWEST = 1000.0
"""Least effective sample size, of 16384 draws: with fewer, parts of the posterior may be missed."""
REACH = 0.3
"""Difference of two conditions, in probability, at which the correlation of the surrogate's errors
has fallen to 1/e: by measured coverage, see tests/benchmarks/calibration_coverage.py."""
EDGE, LEANING = 0.02, 0.1
"""Share of the prior at an end of its range, and share of the posterior there that is too much."""
SILENT = 0.9
"""Posterior over prior standard deviation from which on the data cannot tell a parameter."""
CONTRADICTED = 0.01  # posterior predictive p-value below which the data contradict the models
STRONG = 0.7  # correlation of two parameters from which on it is told
NEGLIGIBLE = 0.01  # weight below which a model's own doubts do not matter
DRAWS = 2000  # equally weighted draws that are kept
_SEED = 1


@dataclass(frozen=True)
class Model:
    """A surrogate with measurements: from points of the prior's unit cube to their likelihood.

    free: calibrated parameters. limits: probabilities of the ends of their sampled ranges,
    (parameters, 2). places: for each distinct condition, the probabilities of the
    stated parameters, and which measurements have it. error: of the surrogate, and covariance: of
    all errors together, both for the measurements.
    """

    surrogate: Surrogate
    free: tuple[str, ...]
    places: tuple[tuple[Mapping[str, float], NDArray[np.int64]], ...]
    limits: Floats
    responses: tuple[str, ...]
    measured: Floats
    error: Floats
    covariance: Floats

    @classmethod
    def of(
        cls,
        surrogate: Surrogate,
        measurements: Sequence[Measurement],
        numerical: Mapping[str, float],
        model_error: float,
    ) -> Model:
        """Match a surrogate with measurements.

        Raises ValueError, with every reason, where it cannot predict one of them.
        """
        reasons = list(_mismatches(surrogate, measurements))
        varied = surrogate.parameters
        stated = [
            {
                name: float(measurement.conditions[name])
                for name in varied
                if name in measurement.conditions
            }
            for measurement in measurements
        ]
        free = tuple(n for n in surrogate.parameters if not all(n in fixed for fixed in stated))
        for name in free:
            if quantities := [
                measurement.quantity
                for measurement, fixed in zip(measurements, stated, strict=True)
                if name in fixed
            ]:
                reasons.append(
                    f"{name}: is stated for {quantities[0]} but not for all: state it for all, or "
                    "none"
                )
        if not 0 < len(free) <= MOST:
            reasons.append(
                f"{len(free)} parameters are left to calibrate ({', '.join(free) or 'none'}): vary "
                f"1 to {MOST} that no measurement states"
            )
        if reasons:
            raise ValueError("\n".join(dict.fromkeys(reasons)))
        keys = [json.dumps(fixed) for fixed in stated]
        _, firsts, place = np.unique(keys, return_index=True, return_inverse=True)
        places = []
        for index, first in enumerate(firsts.tolist()):
            unit = {n: surrogate.probability(n, value) for n, value in stated[first].items()}
            places.append((unit, np.flatnonzero(place == index)))
        sampled = surrogate.dataset.sel(parameter=list(free))
        ends = zip(free, sampled[["lowest", "highest"]].to_array().values.T.tolist(), strict=True)
        limits = np.array([[surrogate.probability(n, end) for end in pair] for n, pair in ends])
        # root mean square over the prior: the error grows towards the ends of the ranges
        draws = np.random.default_rng(_SEED).random((len(free), 256))
        prior = limits[:, :1] + np.diff(limits) * draws
        error = np.empty(len(measurements))
        for unit, members in places:
            columns = dict(zip(free, prior, strict=True)) | {
                name: np.full(256, value) for name, value in unit.items()
            }
            widths = surrogate.errors(np.column_stack([columns[name] for name in varied]))
            for member in members.tolist():
                row = surrogate.responses.index(measurements[member].quantity)
                error[member] = np.sqrt(np.mean(widths[row] ** 2)) / COVERAGE
        measured = np.array([measurement.value for measurement in measurements])
        names = np.array([measurement.quantity for measurement in measurements])
        alike = names[:, None] == names
        systematic = np.array([measurement.systematic_uncertainty for measurement in measurements])
        sources = np.array([measurement.source for measurement in measurements])
        total = np.array([measurement.standard_uncertainty for measurement in measurements])
        covariance = np.diag(total**2 - systematic**2)
        common = alike & (sources[:, None] == sources)
        covariance = covariance + np.outer(systematic, systematic) * common
        # neighbouring predictions have nearly the same error, however often they are measured
        conditions = np.array([list(unit.values()) for unit, _ in places]).reshape(len(places), -1)
        distance = np.linalg.norm(conditions[:, None] - conditions, axis=-1)[np.ix_(place, place)]
        covariance = covariance + np.outer(error, error) * alike * np.exp(-distance / REACH)
        shared = np.array([numerical.get(name, 0.0) / 2.0 for name in names]) * measured
        model_errors = model_error * measured
        covariance = (
            covariance + (np.outer(shared, shared) + np.outer(model_errors, model_errors)) * alike
        )
        return cls(
            surrogate, free, tuple(places), limits, tuple(names), measured, error, covariance
        )

    def values(self, points: Floats) -> Floats:
        """Return the parameters at points of the prior's cube, in SI units, (points, free)."""
        low, high = self.limits.T
        unit = low + (high - low) * points
        arguments = [self.surrogate.distribution(name) for name in self.free]
        return np.array(
            [
                distribution_of(attributes).quantile(u)
                for attributes, u in zip(arguments, unit.T, strict=True)
            ]
        ).T

    def predicted(self, points: Floats) -> Floats:
        """Return the surrogate at each measurement, (points, measurements)."""
        low, high = self.limits.T
        inner = dict(zip(self.free, (low + (high - low) * points).T, strict=True))
        predictions = np.empty((len(points), self.measured.size))
        for stated, members in self.places:
            columns = [
                inner[name] if name in inner else np.full(len(points), stated[name])
                for name in self.surrogate.parameters
            ]
            answers = self.surrogate.at(np.column_stack(columns))
            rows = [self.surrogate.responses.index(self.responses[member]) for member in members]
            predictions[:, members] = answers[rows].T
        return predictions

    def squared(self, predicted: Floats) -> Floats:
        """Return the squared distance of predictions from the data, in all errors, (points,)."""
        whitening = np.linalg.inv(np.linalg.cholesky(self.covariance))
        return np.asarray((((predicted - self.measured) @ whitening.T) ** 2).sum(axis=1))

    def log_likelihood(self, points: Floats) -> Floats:
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


def calibrated(
    surrogates: Mapping[str, Surrogate],
    measurements: Sequence[Measurement],
    numerical: Mapping[str, float] | None = None,
    model_error: float = 0.0,
    before: Mapping[str, float] | None = None,
) -> xr.Dataset:
    """Return posterior, weights of models and predictions as a dataset.

    surrogates: by the name of the model, of one set of parameters. numerical: relative expanded
    uncertainty of responses. before: probabilities of the models without the data, by default
    equal. model_error: relative standard uncertainty of the models themselves, the same way in all
    measurements of a response.

    Returns the variables of _LONG_NAMES on `parameter` (over all models by their weights), `model`,
    `measurement`, or `draw`; parameter_units; and measured_quantity, _units, _conditions (JSON) and
    _source.

    Raises ValueError with every reason for which there is no posterior: a surrogate or a
    measurement that do not fit, a surrogate that is less certain than the data, too small an
    effective sample, a posterior at the edge of the sampled range.
    """
    if len({surrogate.parameters for surrogate in surrogates.values()}) != 1:
        raise ValueError("the models vary different parameters: sample the same ones for all")
    reasons: list[str] = []
    models: dict[str, Model] = {}
    for name, surrogate in surrogates.items():
        try:
            models[name] = Model.of(surrogate, measurements, numerical or {}, model_error)
        except ValueError as error:
            head = f"{name}: " if name else ""
            reasons += [f"{head}{line}" for line in str(error).splitlines()]
    if reasons:
        raise ValueError("\n".join(reasons))
    with threadpool_limits(limits=1):  # the same bits on any number of processors
        posteriors = {
            name: posterior(model.log_likelihood, len(model.free), _SEED + position)
            for position, (name, model) in enumerate(models.items())
        }
        even = dict.fromkeys(posteriors, 1.0 / len(posteriors))
        return _packed(models, posteriors, measurements, before or even)


def _packed(
    models: Mapping[str, Model],
    posteriors: Mapping[str, Posterior],
    measurements: Sequence[Measurement],
    before: Mapping[str, float],
) -> xr.Dataset:
    evidence = np.array([posterior.log_evidence for posterior in posteriors.values()])
    share = normalised(evidence + np.log([before[name] for name in posteriors]))
    doubts = [_doubt(models[name], posterior) for name, posterior in posteriors.items()]
    if reasons := [
        f"{name}: {doubt}" if name else doubt
        for name, doubt, weight in zip(posteriors, doubts, share, strict=True)
        if doubt and not weight < NEGLIGIBLE
    ]:
        raise ValueError("\n".join(reasons))
    first = next(iter(models.values()))
    free = first.free
    weights = np.concatenate(
        [w * p.weights for w, p in zip(share, posteriors.values(), strict=True)]
    )
    of_each = [
        (models[name].values(posterior.points), models[name].predicted(posterior.points))
        for name, posterior in posteriors.items()
    ]
    values, predicted = (np.concatenate(parts) for parts in zip(*of_each, strict=True))
    squares = [model.squared(y) for model, (_, y) in zip(models.values(), of_each, strict=True)]
    of_model = np.repeat(
        np.arange(len(posteriors)), [posterior.weights.size for posterior in posteriors.values()]
    )
    even = (np.arange(20_000) + 0.5) / 20_000
    prior = first.values(np.column_stack([even] * len(free)))
    mean, deviation = _moments(values, weights)
    moments = [
        _moments(x, p.weights) for (x, _), p in zip(of_each, posteriors.values(), strict=True)
    ]
    prior_mean, prior_deviation = prior.mean(axis=0), prior.std(axis=0)
    low, high = np.quantile(values, (0.025, 0.975), axis=0, weights=weights, method="inverted_cdf")
    inner = np.concatenate([posterior.points for posterior in posteriors.values()])
    of_modes = [modes(column, weights) for column in inner.T]
    ranges = np.full((len(free), max(map(len, of_modes)), 3), np.nan)
    for parameter, intervals in enumerate(of_modes):
        for mode, (ends, mass) in enumerate(intervals):
            corners = np.full((2, len(free)), 0.5)
            corners[:, parameter] = ends
            ranges[parameter, mode] = [*first.values(corners)[:, parameter], mass]
    offsets = (values - mean) / np.where(deviation > 0, deviation, 1.0)
    correlation = (offsets * weights[:, np.newaxis]).T @ offsets
    predicted_mean, predicted_deviation = _moments(predicted, weights)
    # systematic resampling: draws of equal weight, in a random order
    rng = np.random.default_rng(_SEED)
    ends = np.cumsum(weights)
    picked = np.searchsorted(ends / ends[-1], (np.arange(DRAWS) + rng.random()) / DRAWS)
    picked = rng.permutation(picked.clip(max=weights.size - 1))
    p_value = float(weights @ scipy.stats.chi2.sf(np.concatenate(squares), len(measurements)))
    units = [first.surrogate.units(name) for name in free]
    uncertainty = COVERAGE * np.array(
        [measurement.standard_uncertainty for measurement in measurements]
    )
    stated = [json.dumps(dict(measurement.conditions)) for measurement in measurements]
    variables: dict[str, Any] = {
        "posterior_mean": ("parameter", mean),
        "posterior_deviation": ("parameter", deviation),
        "posterior_low": ("parameter", low),
        "posterior_high": ("parameter", high),
        "posterior_correlation": (("parameter", "other_parameter"), correlation),
        "mode_low": (("parameter", "mode"), ranges[..., 0]),
        "mode_high": (("parameter", "mode"), ranges[..., 1]),
        "mode_weight": (("parameter", "mode"), ranges[..., 2]),
        "prior_mean": ("parameter", prior_mean),
        "prior_deviation": ("parameter", prior_deviation),
        "spread_ratio": ("parameter", deviation / prior_deviation),
        "parameter_units": ("parameter", units),
        "model_weight": ("model", share),
        "model_weight_before": ("model", [before[name] for name in posteriors]),
        "model_mean": (("model", "parameter"), np.array([means for means, _ in moments])),
        "model_deviation": (
            ("model", "parameter"),
            np.array([deviations for _, deviations in moments]),
        ),
        "log_evidence": ("model", evidence),
        "effective_samples": ("model", [posterior.effective for posterior in posteriors.values()]),
        "model_doubt": ("model", doubts),
        "measured": ("measurement", first.measured),
        "measured_uncertainty": ("measurement", uncertainty),
        "predicted_mean": ("measurement", predicted_mean),
        "predicted_deviation": ("measurement", predicted_deviation),
        "surrogate_error": ("measurement", np.max([m.error for m in models.values()], axis=0)),
        "draws": (("draw", "parameter"), values[picked]),
        "draw_model": ("draw", np.array(list(posteriors))[of_model[picked]]),
        "draw_predicted": (("draw", "measurement"), predicted[picked]),
        "prior_draws": (("prior_draw", "parameter"), prior[::20]),
        "predictive_p": ((), p_value),
        "measured_quantity": (
            "measurement",
            [measurement.quantity for measurement in measurements],
        ),
        "measured_units": ("measurement", [measurement.units for measurement in measurements]),
        "measured_conditions": ("measurement", stated),
        "measured_source": ("measurement", [measurement.source for measurement in measurements]),
    }
    names = {"parameter": list(free), "other_parameter": list(free), "model": list(posteriors)}
    dataset = xr.Dataset(variables, names)
    for name, words_of in _LONG_NAMES.items():
        dataset[name].attrs["long_name"] = words_of
    return dataset


_LONG_NAMES = {
    "posterior_mean": "mean of the parameter given the measurements, SI",
    "posterior_deviation": "standard deviation of the parameter given the measurements",
    "posterior_low": "lower end of the central 95 % of the posterior",
    "posterior_high": "upper end of the central 95 % of the posterior",
    "posterior_correlation": "correlation of two parameters given the measurements",
    "mode_low": "lower end of the central 95 % of one mode of the parameter's posterior, SI",
    "mode_high": "upper end of the central 95 % of one mode of the parameter's posterior, SI",
    "mode_weight": "probability of the mode given the measurements",
    "prior_mean": "mean of the sampled range",
    "prior_deviation": "standard deviation of the sampled range",
    "spread_ratio": "standard deviation of the posterior over that of the prior",
    "model_weight": "probability of the model given the measurements",
    "model_weight_before": "probability of the model without the measurements",
    "model_mean": "mean of the parameter given the measurements and the model, SI",
    "model_deviation": "standard deviation of the parameter given measurements and model",
    "log_evidence": "logarithm of the evidence",
    "effective_samples": "effective sample size",
    "model_doubt": "why a model of negligible weight might deserve more",
    "measured": "measured value, in measured_units",
    "measured_uncertainty": "expanded uncertainty of the measured value (k = 2)",
    "predicted_mean": "mean of the posterior predictions",
    "predicted_deviation": "standard deviation of the posterior predictions",
    "surrogate_error": "half of the surrogate's 95 % interval, root mean square over the prior",
    "draws": "draws from the posterior, of equal weight, SI",
    "draw_model": "model of a draw",
    "draw_predicted": "the surrogate's prediction of each measurement at a draw",
    "prior_draws": "quantiles of the prior, SI",
    "predictive_p": "posterior predictive p-value of chi-squared",
}


def _doubt(model: Model, posterior: Posterior) -> str:
    """Return why a posterior is not to be trusted; "" where nothing speaks against it."""
    if not posterior.effective >= FEWEST:
        return (
            f"the effective sample size is {posterior.effective:.0f}, less than {FEWEST:g}: the "
            "data are too precise for the sampled ranges, or contradict them: narrow the ranges"
        )
    for parameter, name in enumerate(model.free):
        column = posterior.points[:, parameter]
        for end, leaning in (("lower", column < EDGE), ("upper", column > 1 - EDGE)):
            mass = float(posterior.weights[leaning].sum())
            if mass > LEANING:
                edge = model.values(np.full((1, len(model.free)), float(end == "upper")))[
                    0, parameter
                ]
                return (
                    f"{name}: {100 * mass:.0f} % of the posterior leans on the {end} end of the "
                    f"range ({edge:.4g} {model.surrogate.units(name)}): sample a wider one"
                )
    return ""


def _moments(values: Floats, weights: Floats) -> tuple[Floats, Floats]:
    mean = weights @ values
    return mean, np.sqrt(weights @ (values - mean) ** 2)
