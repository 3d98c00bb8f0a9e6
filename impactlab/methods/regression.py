"""Standardised regression coefficients, on values and on ranks: signed, but linear or monotone."""

from collections.abc import Mapping

import numpy as np
import scipy  # its stats are loaded when first used

from impactlab.methods.hypercube import Hypercube
from impactlab.methods.record import (
    Family,
    IndexVariable,
    Indices,
    Measure,
    SensitivityVerdict,
    wide,
)
from impactlab.methods.runs import Sample, dummy_column, half_widths
from impactlab.types import Floats

_2008 = "Saltelli et al. (2008), Global Sensitivity Analysis: The Primer, section 1.2.5"
_1979 = "Iman and Conover (1979), Technometrics 21, 499"
_LINEAR = 0.7
"""Share of the variance from which on a regression describes a response (Saltelli et al. 2008,
Global Sensitivity Analysis, section 1.2.5)."""
_SMALLEST = 1e-12  # variance over that of all runs, up to which a resample does not vary
_VARIABLES = {
    "regression": IndexVariable("standardised regression coefficient", _2008),
    "regression_r_squared": IndexVariable(
        "share of the variance that linear regression explains", _2008, ()
    ),
    "dummy_regression": IndexVariable.of_dummy(
        "standardised regression coefficient of a dummy", _2008
    ),
    "rank_regression": IndexVariable("standardised rank regression coefficient", _1979),
    "rank_regression_r_squared": IndexVariable(
        "share of the variance of the ranks that linear regression explains", _1979, ()
    ),
    "dummy_rank_regression": IndexVariable.of_dummy(
        "standardised rank regression coefficient of a dummy", _1979
    ),
}
FAMILY = Family(
    "regression_indices",
    "Regression coefficients",
    (Measure("regression", "of values"), Measure("rank_regression", "of ranks", optional=True)),
    "Standardised coefficient (–)",
    "Standard deviations by which a response rises with one standard deviation of the parameter, "
    "in a linear fit of values and of ranks. They tell no more than the fit does: see R².",
    shares=False,
    explained="regression_r_squared",
    if_correlated="a coefficient is the effect of one while the others are held, and squares of "
    "coefficients are no shares",
)


def _check(sample: Sample) -> None:
    sample.ungrouped()
    sample.ordered()
    runs, needed = sample.inputs.shape[0], 2 * (sample.inputs.shape[1] + 2)
    if runs < needed:
        raise ValueError(
            f"{sample.study}: {runs} runs are too few for a regression on "
            f"{len(sample.parameters)} parameters: take {needed} or more"
        )


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    table = np.column_stack([sample.inputs, dummy_column(sample), outputs])
    ranks = scipy.stats.rankdata(table, axis=0)  # among all runs, in resamples, too
    linear = _regression("regression", table, sample, response)
    return linear | _regression("rank_regression", ranks, sample, response)


def _regression(name: str, table: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    """Regress the last column on the others, of which the last is the dummy."""
    standard = (table - table.mean(axis=0)) / table.std(axis=0)
    products = (standard[:, :, None] * standard[:, None, :]).reshape(len(table), -1)
    columns, size = np.column_stack([standard, products]), table.shape[1]

    def estimator(means: Floats) -> dict[str, Floats]:
        centre = means[..., :size]
        second = means[..., size:].reshape(*means.shape[:-1], size, size)
        covariance = second - centre[..., :, None] * centre[..., None, :]
        variance = np.diagonal(covariance, axis1=-2, axis2=-1)
        deviation = np.sqrt(np.where(variance > _SMALLEST, variance, np.nan))
        correlation = covariance / deviation[..., :, None] / deviation[..., None, :]
        with_dummy, _ = _coefficients(correlation)
        without = np.delete(np.delete(correlation, -2, axis=-1), -2, axis=-2)
        values, share = _coefficients(without)
        return {name: values, f"dummy_{name}": with_dummy[..., -1], f"{name}_r_squared": share}

    return estimator(columns.mean(axis=0)) | half_widths(columns, estimator, sample, response)


def _coefficients(correlation: Floats) -> tuple[Floats, Floats]:
    """Return standardised coefficients (..., regressors) of the last variable, and R^2 (...)."""
    inner, outer = correlation[..., :-1, :-1], correlation[..., :-1, -1]
    coefficients = np.asarray(np.linalg.solve(inner, outer[..., None])[..., 0], float)
    return coefficients, np.asarray((coefficients * outer).sum(axis=-1))


def _judge(indices: Mapping[str, Floats]) -> list[SensitivityVerdict]:
    margins = [indices[f"{name}_interval"] for name in ("regression", "rank_regression")]
    explained = (indices["regression_r_squared"], indices["rank_regression_r_squared"])
    poor = max(map(float, explained)) < _LINEAR
    return wide(*margins) + [SensitivityVerdict.NOT_LINEAR] * poor


INDICES = Indices(
    "regression",
    _VARIABLES,
    FAMILY,
    _check,
    _estimate,
    _judge,
    fewest=64,
    order="fits a slope over the values",
)


class Regression(Hypercube):
    """A Latin hypercube for regression coefficients.

    {arguments}

    References
    ----------
    Saltelli et al. (2008), Global Sensitivity Analysis: The Primer, section 1.2.5.

    {example}
    """

    records = (INDICES,)
    label = "Latin hypercube for regression"
