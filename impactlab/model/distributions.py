"""Distributions of varied parameters: between values and probabilities.

A distribution is stored as it stands in a study file, by name and arguments in SI units: the
attributes of a varied coordinate of runs.nc, whose other attributes do not matter here. Rank
correlations between parameters are those of a Gaussian copula: their distributions stay as stated.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from inspect import signature
from typing import Any

import numpy as np
import scipy  # its stats are loaded when first used
from numpy.typing import ArrayLike

from impactlab.types import Floats

Arguments = Mapping[str, Any]
Correlations = Sequence[tuple[str, str, float]]
"""Two parameters and Spearman's rank correlation of them; pairs that are not listed have 0."""
_LEAST = 1e-8  # smallest eigenvalue of a matrix that counts as positive definite
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
    bounds = arguments(attributes)
    values = _frozen(attributes).ppf(probability)
    return np.asarray(np.clip(values, bounds.get("low", -np.inf), bounds.get("high", np.inf)))


def cumulative(attributes: Arguments, values: ArrayLike) -> Floats:
    """Return the probabilities (same shape) that a draw lies below these values: undo `quantile`.

    Raises ValueError as `arguments`.
    """
    return np.asarray(_frozen(attributes).cdf(values))


LOGARITHMIC = ("log_uniform", "lognormal")
"""Distributions whose draws spread evenly, or normally, in their logarithm."""
_NEGLIGIBLE = 1e-40  # share of the draws beyond either end of a quadrature
_PANELS, _NODES = 40, 40  # of Gauss and Legendre


def quadrature(attributes: Arguments) -> tuple[bool, Floats, Floats]:
    """Return nodes (SI units) and weights, which add up to 1, of integrals over a distribution.

    The first is True where the nodes are logarithms of values. They integrate polynomials up to
    degree 40 to rounding. Raises ValueError as `arguments`.
    """
    frozen = _frozen(attributes)
    low, high = float(frozen.ppf(_NEGLIGIBLE)), float(frozen.isf(_NEGLIGIBLE))
    is_logarithmic = attributes["distribution"] in LOGARITHMIC
    if is_logarithmic:
        low, high = np.log(low), np.log(high)
    edges = np.linspace(low, high, _PANELS + 1)
    if "mode" in attributes:  # where the density has a kink
        edges = np.unique([*edges, float(attributes["mode"])])
    half = np.diff(edges)[:, np.newaxis] / 2
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    x = (edges[:-1, np.newaxis] + half * (1 + nodes)).ravel()
    density = frozen.pdf(np.exp(x)) * np.exp(x) if is_logarithmic else frozen.pdf(x)
    shares = (half * weights).ravel() * density
    return is_logarithmic, x, shares / shares.sum()


def _frozen(attributes: Arguments) -> Any:
    parameters = arguments(attributes)
    return _FORMS[parameters.pop("distribution")](**parameters)


def correlation_matrix(names: Sequence[str], correlations: Correlations) -> Floats:
    """Return the linear correlations of the normal variables, (names, names).

    They are 2 sin(π ρ / 6) of the rank correlations ρ: Pearson (1907), as in Kruskal (1958), J. Am.
    Stat. Assoc. 53, 814 (recalled, not read). Pairs with other names are left out.
    """
    matrix, place = np.eye(len(names)), {name: i for i, name in enumerate(names)}
    for first, second, rank in correlations:
        if first in place and second in place:
            linear = 2 * np.sin(np.pi * rank / 6)
            matrix[place[first], place[second]] = matrix[place[second], place[first]] = linear
    return matrix


def contradicting(names: Sequence[str], correlations: Correlations) -> list[str]:
    """Return the fewest of the names whose correlations exclude each other; none if all can be."""

    def possible(subset: Sequence[str]) -> bool:
        smallest = np.linalg.eigvalsh(correlation_matrix(subset, correlations)).min(initial=1)
        return bool(smallest > _LEAST)

    clashing = [] if possible(names) else list(names)
    for name in clashing.copy():
        rest = [member for member in clashing if member != name]
        clashing = clashing if possible(rest) else rest
    return clashing


def correlated(unit: Floats, linear: Floats) -> Floats:
    """Return the sample with each column in another order, (runs, parameters).

    unit: independent draws in the unit cube, so even as they are; linear: correlation_matrix. The
    ranks are those of the normal variables with these correlations: Stein (1987), Technometrics 29,
    143, section 4 (recalled, not read). A column without partners keeps its order.
    """
    normal = scipy.stats.norm.ppf(unit) @ np.linalg.cholesky(linear).T
    ranks = normal.argsort(axis=0, kind="stable").argsort(axis=0)
    return np.asarray(np.take_along_axis(np.sort(unit, axis=0), ranks, axis=0))
