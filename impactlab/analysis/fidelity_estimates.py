"""Estimates of a slow model, and what the runs of both models have to be for them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from impactlab.types import Floats


@dataclass(frozen=True)
class FidelityEstimate:
    """A statistic of the slow model, with its interval.

    Parameters
    ----------
    value : float
        Estimate, in the unit of the statistic.
    standard_error : float
        Standard error, in the same unit.
    interval : tuple of float
        Lower and upper end of the interval.
    plain_error : float
        Standard error that the slow runs alone give.

    Examples
    --------
    >>> il.FidelityEstimate(12.0, 0.5, (11.0, 13.0), plain_error=1.0).saving
    4.0
    """

    value: float
    standard_error: float
    interval: tuple[float, float]
    plain_error: float

    @property
    def saving(self) -> float:
        """Plain slow runs per slow run for the same standard error: above 1, runs are saved.

        Returns
        -------
        float
            Ratio of the variances.
        """
        return (self.plain_error / self.standard_error) ** 2


@dataclass(frozen=True)
class FidelityPrediction:
    """Answers of the slow model at points, with their intervals; NaN where there is none.

    Parameters
    ----------
    value : numpy.ndarray
        Predictions, (points,), in the unit of the output.
    low, high : numpy.ndarray
        Lower and upper ends of the intervals, (points,).
    refusal : list of str
        Reason why a point has no prediction; "" where it has one.

    Examples
    --------
    >>> answer = il.FidelityPrediction(value=[2.0], low=[1.9], high=[2.2], refusal=[""])
    >>> answer.high[0] - answer.low[0] < 0.4
    True
    """

    value: Floats
    low: Floats
    high: Floats
    refusal: list[str]


def outputs_of(name: str, values: Any) -> Floats:
    """Return outputs as (runs,). Raises ValueError where they are not, or a run has no answer."""
    outputs = np.asarray(values, dtype=float)
    if outputs.ndim != 1:
        raise ValueError(f"Multifidelity.{name}: must be one output per run")
    if missing := int(np.sum(~np.isfinite(outputs))):
        raise ValueError(
            f"Multifidelity.{name}: {missing} of {outputs.size} runs have no answer: failed runs "
            "cannot be left out, because they may be the extreme ones"
        )
    return outputs


def table_of(name: str, values: Any, rows: int, columns: int | None = None) -> Floats:
    """Return parameters as (rows, columns). Raises ValueError where they are not."""
    table = np.asarray(values, dtype=float)
    if table.ndim != 2 or len(table) != rows or columns not in (None, table.shape[1]):
        shape = f"({rows}, {columns or 'parameters'})"
        raise ValueError(f"Multifidelity.{name}: has the shape {table.shape}: must be {shape}")
    if not np.isfinite(table).all():
        raise ValueError(f"Multifidelity.{name}: parameters must be numbers")
    return table


def interval_on(
    scale: tuple[Callable[[Floats], Floats], ...], value: float, margin: float
) -> tuple[float, float]:
    """Return an interval that is even on a scale, by the derivative of the scale at the value."""
    if not scale:
        return float(value - margin), float(value + margin)
    forward, backward = scale
    with np.errstate(invalid="ignore", divide="ignore"):
        low, centre, high = forward(value * np.array([1 - 1e-6, 1, 1 + 1e-6]))
    if not np.isfinite([low, centre, high]).all():
        raise ValueError(
            f"Multifidelity: the estimate {value:.3g} is impossible: add runs of high, because the "
            "pairs predict it too poorly"
        )
    width = margin * (high - low) / (2e-6 * value)
    lower, upper = backward(centre + width * np.array([-1, 1]))
    return float(lower), float(upper)
