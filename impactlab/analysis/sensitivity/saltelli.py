"""Saltelli's sample: its outputs taken apart, and its estimators as functions of means.

All estimators are ratios of means over the base samples, which is what makes their bootstrap fast.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from SALib.analyze.sobol import separate_output_values

from impactlab.analysis.sensitivity.sample import Array

_ALONE = 5
"""Columns of a row's statistics that belong to no factor: a, b, a^2, b^2, a b."""


@dataclass(frozen=True)
class Outputs:
    """Outputs of one response at the points of a Saltelli sample, standardised as a whole.

    a, b: (base samples,), at the two independent samples; ab: (base samples, factors), at A with
    the factor's columns from B; ba: the same at B with columns from A, None without second order.
    """

    a: Array
    b: Array
    ab: Array
    ba: Array | None

    @classmethod
    def of(cls, outputs: Array, factors: int, second_order: bool) -> Outputs:
        """From outputs (runs,) in SALib's order, not all equal."""
        standard = (outputs - outputs.mean()) / outputs.std()
        size = len(outputs) // step(factors, second_order)
        return cls(*separate_output_values(standard, factors, size, second_order))

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """Of factors whose second order was sampled."""
        return list(combinations(range(self.ab.shape[1]), 2)) if self.ba is not None else []

    def statistics(self, interactions: bool = True) -> Array:
        """What the estimators take the means of, (base samples, columns)."""
        a, b = self.a[:, None], self.b[:, None]
        columns = [a, b, a**2, b**2, a * b, b * (self.ab - a), (a - self.ab) ** 2 / 2]
        if self.ba is not None and interactions:
            first, second = np.array(self.pairs, int).reshape(-1, 2).T
            columns.append(self.ba[:, first] * self.ab[:, second] - a * b)
        return np.concatenate(columns, axis=1)


def step(factors: int, second_order: bool) -> int:
    """Runs for each base sample."""
    return (2 if second_order else 1) * factors + 2


def estimates(means: Array, factors: int) -> dict[str, Array]:
    """Indices from the means of the statistics, (..., columns); NaN where nothing varies.

    first_order, total_order (..., factor): Saltelli et al. (2010), Table 2 (b) and (f);
    second_order (..., pair): Saltelli (2002), Theorem 2; and the noise floor, dummy_first_order
    and dummy_total_order (...).

    A dummy is a parameter that the model never sees, so that its column changes nothing: AB = A,
    BA = B. Saltelli's B (AB - A) and (A - AB)^2 are then zero to the last digit, whatever the
    sample, and tell no noise. The dummy is put into the estimators of Khorashadi Zadeh et al.
    (2017), Environ. Model. Softw. 91, 210, instead, as sensobol's sobol_dummy does:
    S = (mean(A BA) - f0^2)/V and T = 1 - (mean(B BA) - f0^2)/V, with BA = B and centred outputs.
    One departure: f0 is the mean of A and B. sensobol takes mean(A B) for f0^2, which cancels the
    very noise that the first order is to show.
    """
    a, b, squared_a, squared_b, product = np.moveaxis(means[..., :_ALONE], -1, 0)
    centre = ((a + b) / 2) ** 2
    variance = (squared_a + squared_b) / 2 - centre
    variance = np.where(variance > np.finfo(float).eps, variance, np.nan)
    shares = means[..., _ALONE:] / variance[..., None]
    first, total, joint = np.split(shares, [factors, 2 * factors], axis=-1)
    found = {
        "first_order": first,
        "total_order": total,
        "dummy_first_order": (product - centre) / variance,
        "dummy_total_order": 1 - (squared_b - centre) / variance,
    }
    if joint.shape[-1]:
        one, other = np.array(list(combinations(range(factors), 2))).T
        found["second_order"] = joint - first[..., one] - first[..., other]
    return found
