"""Distributions of varied parameters: between values and probabilities.

A distribution is stored as it stands in a study file, by name and arguments in SI units: the
attributes of a varied coordinate of runs.nc, whose other attributes do not matter here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import scipy  # its stats are loaded when first used
from numpy.typing import ArrayLike, NDArray

Arguments = Mapping[str, Any]
Values = NDArray[np.float64]


def _uniform(low: float, high: float) -> Any:
    return scipy.stats.uniform(low, high - low)


def _log_uniform(low: float, high: float) -> Any:
    return scipy.stats.loguniform(low, high)


def _normal(mean: float, standard_deviation: float) -> Any:
    return scipy.stats.norm(mean, standard_deviation)


def _truncated_normal(mean: float, standard_deviation: float, low: float, high: float) -> Any:
    """Return it by mean and deviation before the cut; scipy counts the cuts in deviations."""
    cuts = [(at - mean) / standard_deviation for at in (low, high)]
    return scipy.stats.truncnorm(*cuts, mean, standard_deviation)


def _lognormal(median: float, geometric_standard_deviation: float) -> Any:
    return scipy.stats.lognorm(np.log(geometric_standard_deviation), scale=median)


def _triangular(low: float, mode: float, high: float) -> Any:
    """Scipy counts the mode in parts of the base."""
    return scipy.stats.triang((mode - low) / (high - low), low, high - low)


_FORMS: dict[str, tuple[Callable[..., Any], tuple[str, ...]]] = {
    "uniform": (_uniform, ("low", "high")),
    "log_uniform": (_log_uniform, ("low", "high")),
    "normal": (_normal, ("mean", "standard_deviation")),
    "truncated_normal": (_truncated_normal, ("mean", "standard_deviation", "low", "high")),
    "lognormal": (_lognormal, ("median", "geometric_standard_deviation")),
    "triangular": (_triangular, ("low", "mode", "high")),
}
"""By their name in study files: scipy's distribution, and the arguments that it is made of."""


def is_distributed(attributes: Arguments) -> bool:
    """Return whether these attributes hold a distribution."""
    return attributes.get("distribution") in _FORMS


def arguments(attributes: Arguments) -> dict[str, Any]:
    """Return the name and the arguments of a distribution, without any other attribute.

    Raises ValueError when the name is unknown or an argument is missing.
    """
    name = attributes.get("distribution")
    if name not in _FORMS:
        raise ValueError(f"unknown distribution {name!r}: choose from {', '.join(_FORMS)}")
    keys = _FORMS[name][1]
    if absent := [key for key in keys if key not in attributes]:
        raise ValueError(f"a distribution {name!r} needs {', '.join(absent)}")
    return {"distribution": name} | {key: float(attributes[key]) for key in keys}


def quantile(attributes: Arguments, probability: ArrayLike) -> Values:
    """Return the values (same shape) below which a draw lies with these probabilities in [0, 1].

    Never beyond `low` and `high`, which rounding may pass by a digit. Raises ValueError as
    `arguments`.
    """
    given = arguments(attributes)
    values = _frozen(given).ppf(probability)
    return np.asarray(np.clip(values, given.get("low", -np.inf), given.get("high", np.inf)))


def cumulative(attributes: Arguments, values: ArrayLike) -> Values:
    """Return the probabilities (same shape) that a draw lies below these values: undo `quantile`.

    Raises ValueError as `arguments`.
    """
    return np.asarray(_frozen(arguments(attributes)).cdf(values))


def _frozen(given: dict[str, Any]) -> Any:
    make, keys = _FORMS[given["distribution"]]
    return make(**{key: given[key] for key in keys})
