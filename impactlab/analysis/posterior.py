"""Calibration: the posterior of parameters, and the weights of models, from measurements.

Weights of models are proportional to their evidence, times their probability before.
"""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import scipy  # its stats are loaded when first used
import xarray as xr
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from impactlab.analysis.importance import Posterior, modes, normalised, posterior
from impactlab.analysis.likelihood import Likelihood
from impactlab.analysis.measurements import COVERAGE, Measurement
from impactlab.analysis.surrogate.stored import Surrogate
from impactlab.types import Floats

FEWEST = 1000.0
"""Least effective sample size, of 16384 draws: with fewer, parts of the posterior may be missed."""
EDGE, LEANING = 0.02, 0.1
"""Share of the prior at an end of its range, and share of the posterior there that is too much."""
SILENT = 0.9
"""Posterior over prior standard deviation from which on the data cannot tell a parameter."""
CONTRADICTED = 0.01  # posterior predictive p-value below which the data contradict the models
STRONG = 0.7  # correlation of two parameters from which on it is told
NEGLIGIBLE = 0.01  # weight below which a model's own doubts do not matter
DRAWS = 2000  # equally weighted draws that are kept
_PRIOR, _KEPT = 20_000, 20  # quantiles of the prior, and one in how many of them is kept
_ENDS = (0.025, 0.975)
_SEED = 1


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

    Returns the variables of _VARIABLES, those on `parameter` over all models by their weights;
    measured_conditions is JSON.

    Raises ValueError with every reason for which there is no posterior: a surrogate or a
    measurement that do not fit, a surrogate that is less certain than the data, too small an
    effective sample, a posterior at the edge of the sampled range.
    """
    if len({surrogate.parameters for surrogate in surrogates.values()}) != 1:
        raise ValueError("the models vary different parameters: sample the same ones for all")
    reasons: list[str] = []
    models: dict[str, Likelihood] = {}
    for name, surrogate in surrogates.items():
        try:
            models[name] = Likelihood(surrogate, measurements, numerical or {}, model_error)
        except ValueError as error:
            reasons += [_of_model(name, line) for line in str(error).splitlines()]
    if reasons:
        raise ValueError("\n".join(reasons))
    with threadpool_limits(limits=1):  # the same bits on any number of processors
        posteriors = [
            posterior(model.log, len(model.free), _SEED + position)
            for position, model in enumerate(models.values())
        ]
        even = dict.fromkeys(models, 1.0 / len(models))
        values = _values(models, posteriors, before or even)
    free = list(next(iter(models.values())).free)
    return xr.Dataset(
        {
            name: (dims, values[name], {"long_name": long_name} if long_name else {})
            for dims, meanings in _VARIABLES.items()
            for name, long_name in meanings.items()
        },
        {"parameter": free, "other_parameter": free, "model": list(models)},
    )


def _values(
    models: Mapping[str, Likelihood], posteriors: Sequence[Posterior], before: Mapping[str, float]
) -> dict[str, Any]:
    """Return the values of _VARIABLES. Raises ValueError where a posterior is not to be trusted."""
    evidence = np.array([posterior.log_evidence for posterior in posteriors])
    prior = [before[name] for name in models]
    share = normalised(evidence + np.log(prior))
    pairs = list(zip(models.values(), posteriors, strict=True))
    doubts = [_doubt(model, posterior) for model, posterior in pairs]
    if reasons := [
        _of_model(name, doubt)
        for name, doubt, weight in zip(models, doubts, share, strict=True)
        if doubt and not weight < NEGLIGIBLE
    ]:
        raise ValueError("\n".join(reasons))
    values = [model.values(posterior.points) for model, posterior in pairs]
    predicted = [model.predicted(posterior.points) for model, posterior in pairs]
    squares = [model.squared(y) for model, y in zip(models.values(), predicted, strict=True)]
    weights = np.concatenate([w * p.weights for w, p in zip(share, posteriors, strict=True)])
    moments = [_moments(x, p.weights) for x, p in zip(values, posteriors, strict=True)]
    draws = _draws(weights)
    all_values, all_predicted = np.concatenate(values), np.concatenate(predicted)
    of_draw = np.repeat(list(models), [posterior.weights.size for posterior in posteriors])
    predicted_mean, predicted_deviation = _moments(all_predicted, weights)
    first = next(iter(models.values()))
    points = np.concatenate([posterior.points for posterior in posteriors])
    chances = scipy.stats.chi2.sf(np.concatenate(squares), len(first.measurements))
    return {
        **_of_parameters(first, points, all_values, weights),
        "model_weight": share,
        "model_weight_before": prior,
        "model_mean": np.array([mean for mean, _ in moments]),
        "model_deviation": np.array([deviation for _, deviation in moments]),
        "log_evidence": evidence,
        "effective_samples": [posterior.effective for posterior in posteriors],
        "model_doubt": doubts,
        **_of_data(first.measurements),
        "predicted_mean": predicted_mean,
        "predicted_deviation": predicted_deviation,
        "surrogate_error": np.max([model.error for model in models.values()], axis=0),
        "draws": all_values[draws],
        "draw_model": of_draw[draws],
        "draw_predicted": all_predicted[draws],
        "predictive_p": float(weights @ chances),
    }


def _of_parameters(
    model: Likelihood, points: Floats, values: Floats, weights: Floats
) -> dict[str, Any]:
    """Return the variables on `parameter`: of the prior, and of all models by their weights."""
    free = model.free
    even = (np.arange(_PRIOR) + 0.5) / _PRIOR
    prior = model.values(np.column_stack([even] * len(free)))
    mean, deviation = _moments(values, weights)
    low, high = np.quantile(values, _ENDS, axis=0, weights=weights, method="inverted_cdf")
    offsets = (values - mean) / np.where(deviation > 0, deviation, 1.0)
    of_modes = [modes(column, weights) for column in points.T]
    ranges = np.full((len(free), max(map(len, of_modes)), 3), np.nan)
    for parameter, intervals in enumerate(of_modes):
        for mode, (ends, mass) in enumerate(intervals):
            corners = np.full((2, len(free)), 0.5)
            corners[:, parameter] = ends
            ranges[parameter, mode] = [*model.values(corners)[:, parameter], mass]
    return {
        "posterior_mean": mean,
        "posterior_deviation": deviation,
        "posterior_low": low,
        "posterior_high": high,
        "posterior_correlation": (offsets * weights[:, np.newaxis]).T @ offsets,
        "mode_low": ranges[..., 0],
        "mode_high": ranges[..., 1],
        "mode_weight": ranges[..., 2],
        "prior_mean": prior.mean(axis=0),
        "prior_deviation": prior.std(axis=0),
        "spread_ratio": deviation / prior.std(axis=0),
        "parameter_units": [model.surrogate.units(name) for name in free],
        "prior_draws": prior[::_KEPT],
    }


def _of_data(measurements: Sequence[Measurement]) -> dict[str, Any]:
    """Return what is known of the measurements without a model."""
    uncertainties = np.array([entry.standard_uncertainty for entry in measurements])
    return {
        "measured": np.array([entry.value for entry in measurements]),
        "measured_uncertainty": COVERAGE * uncertainties,
        "measured_quantity": [entry.quantity for entry in measurements],
        "measured_units": [entry.units for entry in measurements],
        "measured_conditions": [json.dumps(dict(entry.conditions)) for entry in measurements],
        "measured_source": [entry.source for entry in measurements],
    }


def _draws(weights: Floats) -> NDArray[np.int64]:
    """Return the places of draws of equal weight, in a random order, by systematic resampling."""
    rng = np.random.default_rng(_SEED)
    ends = np.cumsum(weights)
    places = np.searchsorted(ends / ends[-1], (np.arange(DRAWS) + rng.random()) / DRAWS)
    return rng.permutation(places.clip(max=weights.size - 1))


_VARIABLES: dict[tuple[str, ...], dict[str, str]] = {
    ("parameter",): {
        "posterior_mean": "mean of the parameter given the measurements, SI",
        "posterior_deviation": "standard deviation of the parameter given the measurements",
        "posterior_low": "lower end of the central 95 % of the posterior",
        "posterior_high": "upper end of the central 95 % of the posterior",
        "prior_mean": "mean of the sampled range",
        "prior_deviation": "standard deviation of the sampled range",
        "spread_ratio": "standard deviation of the posterior over that of the prior",
        "parameter_units": "",
    },
    ("parameter", "other_parameter"): {
        "posterior_correlation": "correlation of two parameters given the measurements"
    },
    ("parameter", "mode"): {
        "mode_low": "lower end of the central 95 % of one mode of the parameter's posterior, SI",
        "mode_high": "upper end of the central 95 % of one mode of the parameter's posterior, SI",
        "mode_weight": "probability of the mode given the measurements",
    },
    ("model",): {
        "model_weight": "probability of the model given the measurements",
        "model_weight_before": "probability of the model without the measurements",
        "log_evidence": "logarithm of the evidence",
        "effective_samples": "effective sample size",
        "model_doubt": "why a model of negligible weight might deserve more",
    },
    ("model", "parameter"): {
        "model_mean": "mean of the parameter given the measurements and the model, SI",
        "model_deviation": "standard deviation of the parameter given measurements and model",
    },
    ("measurement",): {
        "measured": "measured value, in measured_units",
        "measured_uncertainty": "expanded uncertainty of the measured value (k = 2)",
        "predicted_mean": "mean of the posterior predictions",
        "predicted_deviation": "standard deviation of the posterior predictions",
        "surrogate_error": "half of the surrogate's 95 % interval, root mean square over the prior",
        "measured_quantity": "",
        "measured_units": "",
        "measured_conditions": "",
        "measured_source": "",
    },
    ("draw", "parameter"): {"draws": "draws from the posterior, of equal weight, SI"},
    ("draw",): {"draw_model": "model of a draw"},
    ("draw", "measurement"): {
        "draw_predicted": "the surrogate's prediction of each measurement at a draw"
    },
    ("prior_draw", "parameter"): {"prior_draws": "quantiles of the prior, SI"},
    (): {"predictive_p": "posterior predictive p-value of chi-squared"},
}
"""Meaning by name, of the variables on these dimensions."""


def _doubt(model: Likelihood, posterior: Posterior) -> str:
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


def _of_model(name: str, reason: str) -> str:
    return f"{name}: {reason}" if name else reason
