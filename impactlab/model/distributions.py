"""Distributions of varied parameters: between values and probabilities.

A distribution is stored as it stands in a study file, by name and arguments in SI units: the
attributes of a varied coordinate of runs.nc, whose other attributes do not matter here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import signature
from typing import Any

import numpy as np
import scipy  # its stats are loaded when first used
from numpy.typing import ArrayLike

from impactlab.types import Floats

Arguments = Mapping[str, Any]


_FORMS: dict[str, Callable[..., Any]] = {
    "uniform": lambda low, high: scipy.stats.uniform(low, high - low),
    "log_uniform": lambda low, high: scipy.stats.loguniform(low, high),
    "normal": lambda mean, standard_deviation: scipy.stats.norm(mean, standard_deviation),
    # mean and deviation are those before the cut; scipy counts the cuts in deviations
    "truncated_normal": lambda low, high, mean, standard_deviation: scipy.stats.truncnorm(
        (low - mean) / standard_deviation,
        (high - mean) / standard_deviation,
        mean,
        standard_deviation,
    ),
    "lognormal": lambda median, geometric_standard_deviation: scipy.stats.lognorm(
        np.log(geometric_standard_deviation), scale=median
    ),
    # scipy counts the mode in parts of the base
    "triangular": lambda low, high, mode: scipy.stats.triang(
        (mode - low) / (high - low), low, high - low
    ),
}
"""By their name in study files: scipy's distribution, of the arguments that a study gives."""
ARGUMENTS = {name: tuple(signature(form).parameters) for name, form in _FORMS.items()}
"""Names of the arguments of each distribution."""
CHOICE = "choice"
"""The name of the draw among words, which have no order and so no quantiles."""


def arguments(attributes: Arguments) -> dict[str, Any]:
    """Return the name and the arguments of a distribution, without any other attribute.

    Raises ValueError when the name is unknown or an argument is missing.
    """
    name = attributes.get("distribution")
    if name not in _FORMS:
        raise ValueError(f"unknown distribution {name!r}: choose from {', '.join(_FORMS)}")
    keys = ARGUMENTS[name]
    if absent := [key for key in keys if key not in attributes]:
        raise ValueError(f"a distribution {name!r} needs {', '.join(absent)}")
    return {"distribution": name} | {key: float(attributes[key]) for key in keys}


def quantile(attributes: Arguments, probability: ArrayLike) -> Floats:
    """Return the values (same shape) below which a draw lies with these probabilities in [0, 1].

    Never beyond `low` and `high`, which rounding may pass by a digit. Raises ValueError as
    `arguments`.
    """
    given = arguments(attributes)
    values = _frozen(attributes).ppf(probability)
    return np.asarray(np.clip(values, given.get("low", -np.inf), given.get("high", np.inf)))


def cumulative(attributes: Arguments, values: ArrayLike) -> Floats:
    """Return the probabilities (same shape) that a draw lies below these values: undo `quantile`.

    Raises ValueError as `arguments`.
    """
    return np.asarray(_frozen(attributes).cdf(values))


def _frozen(attributes: Arguments) -> Any:
    given = arguments(attributes)
    return _FORMS[given.pop("distribution")](**given)
