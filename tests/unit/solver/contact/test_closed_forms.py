"""Regimes of Stronge's law and their pressures, and the fit to finite elements and its range."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from impactlab.solver.contact import finite_element
from impactlab.solver.contact.stronge import (
    MEAN_PRESSURE,
    THETA,
    U_PLASTIC,
    curve,
    yield_indentation,
)
from impactlab.verification.solutions.contact_laws import StrongeImpact

E, R, S_y, nu = 115e9, 0.035, 345e6, 0.3
LAW = StrongeImpact(E, R, S_y)
X_PLASTIC = 0.5 * (U_PLASTIC + 1.0)


def at(x):
    return curve(x * LAW.yield_indentation, E, R, S_y, nu)


def test_the_plastic_regimes_meet_at_x_82_511_and_not_at_84():
    assert round(X_PLASTIC, 3) == 82.511
    u = 2 * 84.0 - 1.0
    jump = MEAN_PRESSURE / THETA / (1 + math.log(u) / (3 * THETA)) - 1
    assert abs(jump) > 1e-3  # what the often quoted limit would leave


@pytest.mark.parametrize(("x", "pressure"), [(1.0, 1.1), (150.0, 2.8)])
def test_mean_pressure_at_first_yield_and_when_fully_plastic(x, pressure):
    """F over the area of contact in yield stresses, with a^2 = R (2 delta - delta_y)."""
    area = math.pi * R * (2 * x - 1) * LAW.yield_indentation
    assert at(x)[0] / area == pytest.approx(pressure * S_y, rel=1e-12)


def test_the_fit_is_that_of_the_finite_elements():
    """Forces while loading, in the resolved upper tenth of each run; what unloading recovers."""
    file = Path(finite_element.__file__).with_suffix(".csv")
    rows = pd.read_csv(file).query("elements > 20")  # the others are for comparison
    begins = (rows["x_max"].diff() < 0) & (rows["x_max"] < 0.5 * rows["x_max"].shift())
    loading, recovered = [], []
    for _, run in rows.groupby(begins.cumsum()):
        for x, F, top in run[["x", "F", "x_max"]].to_numpy():
            ours, K, delta_r, n = finite_element.curve(top * LAW.yield_indentation, E, R, S_y, nu)
            if abs(x - top) < 1e-4 * top and top > max(0.1 * run["x_max"].max(), 1.2):
                loading.append(ours / LAW.yield_force / F - 1)
            elif x < top:
                left = K * max(x * LAW.yield_indentation - delta_r, 0.0) ** n
                recovered.append((left / LAW.yield_force - F) / (ours / LAW.yield_force))
    assert len(loading) > 150
    assert len(recovered) > 120
    assert np.abs(loading).max() < 0.036
    assert abs(np.mean(loading)) < 0.001
    assert np.sqrt(np.mean(np.square(loading))) < 0.0097
    assert np.sqrt(np.mean(np.square(recovered))) < 0.008


@pytest.mark.parametrize(
    ("ratio", "depth"),
    [(50, 0.0), (70, 0.045), (400, 0.045), (435, 0.038), (510, 0.024), (1400, 0.024), (1600, 0.0)],
)
def test_the_fit_ends_with_the_ratios_of_its_data(ratio, depth):
    """On soft metals it ends sooner, and on those outside its data at first yield."""
    R, S_y = 0.035, 345e6
    first_yield = yield_indentation(ratio * S_y, R, S_y)
    last = finite_element.limit(ratio * S_y, R, S_y, 0.3)
    assert last == pytest.approx(depth * R or first_yield)
