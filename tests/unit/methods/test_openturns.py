"""Indices and draws against OpenTURNS, which shares no code with them (it has no Shapley ones)."""

import numpy as np
import openturns as ot
import pytest

import impactlab as il
from impactlab.methods.delta import first_orders
from impactlab.methods.hsic import _alike, _gaussian, r_squared
from impactlab.methods.hypercube import correlation_matrix

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


def test_the_copula_of_a_rank_correlation():
    pairs = [("a", "b", 0.6), ("b", "c", -0.3)]
    ranks = ot.CorrelationMatrix([[1, 0.6, 0], [0.6, 1, -0.3], [0, -0.3, 1]])
    theirs = ot.NormalCopula.GetCorrelationFromSpearmanCorrelation(ranks)
    np.testing.assert_allclose(correlation_matrix("abc", pairs), np.array(theirs), atol=1e-12)


def _ishigami(x1, x2, x3):
    return np.sin(x1) + 7 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1)


def _indices(sampling, tmp_path):
    ranges = {name: il.Uniform(-np.pi, np.pi) for name in ("x1", "x2", "x3")}
    function = il.Function(_ishigami, vectorized=True)
    study = il.Study(
        title="Ishigami", function=function, sampling=sampling(parameters=ranges), results=tmp_path
    )
    return il.analyse(study.run(workers=1)).isel(response=0)


@pytest.mark.parametrize("method", ["sobol", "fast"])
def test_first_and_total_orders_of_independent_inputs(method, tmp_path):
    """Each draws its own runs: they agree within our intervals and theirs."""
    ranges = ot.JointDistribution([ot.Uniform(-np.pi, np.pi)] * 3)
    code = "sin(x1) + 7 * sin(x2)^2 + 0.1 * x3^4 * sin(x1)"
    model = ot.SymbolicFunction(["x1", "x2", "x3"], [code])
    ot.RandomGenerator.SetSeed(1)
    if method == "sobol":
        size = 2**15
        runs = ot.SobolIndicesExperiment(ranges, size).generate()
        theirs = ot.JansenSensitivityAlgorithm(runs, model(runs), size)
        ours = _indices(lambda **section: il.Sobol(base_samples=1024, **section), tmp_path)
    else:
        theirs = ot.FAST(model, ranges, 4000)
        ours = _indices(lambda **section: il.Fast(samples=2000, **section), tmp_path)
    for order in ("first", "total"):
        values = ours[f"{order}_order"].values
        other = np.array(getattr(theirs, f"get{order.capitalize()}OrderIndices")())
        margins = ours[f"{order}_order_interval"].values + 0.01
        assert (np.abs(values - other) < margins).all(), (order, values, other, margins)
        assert margins.max() < 0.1
