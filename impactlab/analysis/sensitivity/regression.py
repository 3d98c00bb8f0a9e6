"""Standardised regression coefficients, on values and on ranks: signed, but linear or monotone."""

from __future__ import annotations

import numpy as np
from scipy.stats import rankdata

from impactlab.analysis.responses import Sample
from impactlab.analysis.sensitivity.method import Index, Method, dummy_column, half_widths
from impactlab.types import Floats

_2008 = "Saltelli et al. (2008), Global Sensitivity Analysis: The Primer, section 1.2.5"
_1979 = "Iman and Conover (1979), Technometrics 21, 499"
_SMALLEST = 1e-12  # variance over that of all runs, up to which a resample does not vary
_INDICES = {
    "regression": Index("standardised regression coefficient", _2008),
    "regression_r_squared": Index(
        "share of the variance that linear regression explains", _2008, ()
    ),
    "dummy_regression": Index.of_dummy("standardised regression coefficient of a dummy", _2008),
    "rank_regression": Index("standardised rank regression coefficient", _1979),
    "rank_regression_r_squared": Index(
        "share of the variance of the ranks that linear regression explains", _1979, ()
    ),
    "dummy_rank_regression": Index.of_dummy(
        "standardised rank regression coefficient of a dummy", _1979
    ),
}


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
    ranks = rankdata(table, axis=0)  # among all runs, in resamples, too
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


METHOD = Method("regression", _INDICES, _check, _estimate)
