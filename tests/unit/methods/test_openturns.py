"""Indices and draws against OpenTURNS, which shares no code with them (it has no Shapley ones)."""

import numpy as np
import openturns as ot
import pytest

from impactlab.methods.delta import first_orders
from impactlab.methods.hsic import _alike, _gaussian, r_squared

ROWS = 120


@pytest.fixture(scope="module")
def table():
    """Return inputs, of which the first two are correlated, and a line with a product."""
    rng = np.random.default_rng(5)
    inputs = rng.multivariate_normal([0, 0, 0], [[1, 0.6, 0], [0.6, 1, 0], [0, 0, 1]], ROWS)
    return inputs, inputs @ [1.0, 0.3, 0.0] + inputs[:, 0] * inputs[:, 1]


def _sample(values):
    return ot.Sample(np.reshape(values, (ROWS, -1)))


def _kernel(values):
    kernel = ot.SquaredExponential(1)
    kernel.setScale([float(np.std(values))])
    return kernel


def test_first_orders_by_ranks(table):
    """They join the last row to the first in a circle, and divide their variance by ROWS - 1."""
    inputs, outputs = table
    theirs = ot.RankSobolSensitivityAlgorithm(_sample(inputs), _sample(outputs))
    ours, _ = first_orders(inputs, outputs)
    centred = (outputs - outputs.mean()) / outputs.std()
    ends = np.array([centred[order[0]] * centred[order[-1]] for order in inputs.argsort(0).T])
    circle = (ours * (ROWS - 1) + ends) * (ROWS - 1) / ROWS**2
    np.testing.assert_allclose(theirs.getFirstOrderIndices(), circle, atol=1e-10)


@pytest.mark.parametrize("target", [False, True])
def test_hsic_and_its_p_value(table, target):
    inputs, outputs = table
    limit, shuffles = float(np.quantile(outputs, 0.7)), 300
    kernels = [_kernel(column) for column in inputs.T]
    if target:
        above = ot.SymbolicFunction("y", f"y > {limit!r} ? 1 : 0")
        kernels.append(_kernel(outputs > limit))  # of two values: a constant and ours
        theirs = ot.HSICEstimatorTargetSensitivity(
            kernels, _sample(inputs), _sample(outputs), ot.HSICUStat(), above
        )
        kernel = _alike(outputs > limit)
    else:
        kernels.append(_kernel(outputs))
        theirs = ot.HSICEstimatorGlobalSensitivity(
            kernels, _sample(inputs), _sample(outputs), ot.HSICUStat()
        )
        kernel = _gaussian(outputs)
    theirs.setPermutationSize(shuffles)
    rng = np.random.default_rng(1)
    orders = rng.permuted(np.tile(np.arange(ROWS), (shuffles, 1)), axis=1)
    for number, column in enumerate(inputs.T):
        value, _, null = r_squared(_gaussian(column), kernel, orders)
        assert value == pytest.approx(theirs.getR2HSICIndices()[number], rel=1e-9)
        share = (1 + np.count_nonzero(null >= value)) / (1 + shuffles)
        noise = 4 * np.sqrt(2 * share * (1 - share) / shuffles) + 2 / shuffles
        assert share == pytest.approx(theirs.getPValuesPermutation()[number], abs=noise)
