"""Shapley effects from given data: shares of the variance, of correlated parameters, too.

The effect of a parameter is the mean, over all orders in which the parameters become known, of what
knowing it adds to the explained variance V_u = Var(E[Y | X_u]) (Owen 2014). Effects are not below
zero and add up to 1, whatever the correlations and interactions; what correlated parameters explain
together is divided between them.

V_u is the mean of c_i c_j' over the runs, c the centred response, j the neighbour of run i that is
nearest in the parameters u, as in Broto et al. (2020), and c_j' = c_j + m(x_i) - m(x_j) what the
neighbour would have had in the place of i, as in matching (Abadie and Imbens 2011): m is a
regression on the parameters u, with squares and products where there are enough runs. Distances are
between normal scores of the ranks; runs of another word are farther than all others. All parameters
together explain all of the variance, for the solver has no noise.

An effect is a mean over the runs, too, which gives its standard error. What is left of the bias
that neighbours some way off make falls slowly with the runs, so that it is about what changes from
halves of the sample to the whole; the interval adds that, times SAFETY.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy  # its parts are loaded when first used
from threadpoolctl import threadpool_limits

from impactlab.methods.hypercube import Hypercube
from impactlab.methods.record import Family, IndexVariable, Indices, Measure, by_width
from impactlab.methods.runs import Sample
from impactlab.types import Floats

Mask = npt.NDArray[np.bool_]
MOST = 10
"""Most parameters: subsets double with each."""
SAFETY = 2.4  # bias over change, of a bias that falls with the root of the runs
ROWS = 4  # runs for each term of the regression
_APART = 1e3  # distance of words; scores lie within 10 of each other
_SOURCE = (
    "Broto et al. (2020), SIAM/ASA J. Uncertainty Quantification 8, 693, nearest neighbours of "
    "given data, with the regression of Abadie and Imbens (2011), J. Bus. Econ. Stat. 29, 1"
)
_VARIABLES = {
    "shapley": IndexVariable(
        "Shapley effect, share of the variance",
        _SOURCE,
        comment="effects add up to 1; the interval includes the change from half of the runs",
    )
}
FAMILY = Family(
    "shapley_effects",
    "Shapley effects",
    (Measure("shapley", "Shapley effect"),),
    "Share of the variance (–)",
    "Shares of the variance that add up to 1, with interactions and what correlated parameters "
    "explain together divided between the parameters (Owen 2014).",
    if_correlated="what correlated parameters explain together is divided between them",
)


def _estimate(outputs: Floats, sample: Sample, response: str) -> dict[str, Floats]:
    categorical = np.array([name in sample.words for name in sample.parameters])
    order = sample.rng("halves").permutation(len(outputs))
    with threadpool_limits(limits=1):  # the same bits on any number of processors
        effects, errors = shapley_effects(sample.inputs, outputs, categorical)
        halves = [
            shapley_effects(sample.inputs[rows], outputs[rows], categorical)[0]
            for rows in (order[::2], order[1::2])
        ]
    change = np.abs(np.mean(halves, axis=0) - effects)
    return {"shapley": effects, "shapley_interval": sample.quantile * errors + SAFETY * change}


def shapley_effects(inputs: Floats, outputs: Floats, categorical: Mask) -> tuple[Floats, Floats]:
    """Return the effects of each parameter and their standard errors, (parameters,).

    inputs: (runs, parameters); outputs: (runs,); categorical: (parameters,), whose values have no
    order.
    """
    parameters = inputs.shape[1]
    columns = [
        _codes(values) if of_words else _scores(values)
        for values, of_words in zip(inputs.T, categorical, strict=True)
    ]
    centred = outputs - outputs.mean()
    shares = centred**2 / centred.var()  # of every run in the variance
    effects = np.zeros((parameters, len(outputs)))
    for subset in range(1, 2**parameters):
        members = [p for p in range(parameters) if subset >> p & 1]
        if len(members) < parameters:
            explained = _explained([columns[p] for p in members], categorical[members], centred)
        else:
            explained = shares
        size = len(members)
        joined = 1.0 / (parameters * math.comb(parameters - 1, size - 1))
        for p in range(parameters):
            if p in members:
                effects[p] += joined * explained
            else:
                effects[p] -= explained / (parameters * math.comb(parameters - 1, size))
    values = effects.mean(axis=1)
    influence = effects - values[:, np.newaxis] * shares
    return values, np.sqrt(influence.var(axis=1) / len(outputs))


def _explained(columns: list[Floats], categorical: Mask, centred: Floats) -> Floats:
    """Return what each run adds to the share that these parameters explain, (runs,)."""
    scales = [_APART if of_words else 1.0 for of_words in categorical]
    places = np.column_stack([s * column for s, column in zip(scales, columns, strict=True)])
    _, nearest = scipy.spatial.KDTree(places).query(places, k=2)
    runs = np.arange(len(centred))
    other = np.where(nearest[:, 1] == runs, nearest[:, 0], nearest[:, 1])
    terms = [np.ones((len(centred), 1)), *columns]
    squares = [
        (first[:, :, np.newaxis] * second[:, np.newaxis]).reshape(len(centred), -1)
        for i, first in enumerate(columns)
        for second in columns[i + (categorical[i] > 0) :]
    ]
    quadratic = np.column_stack([*terms, *squares])
    regressors = quadratic if ROWS * quadratic.shape[1] <= len(centred) else np.column_stack(terms)
    coefficients, *_ = np.linalg.lstsq(regressors, centred, rcond=None)
    trend = regressors @ coefficients
    return np.asarray(centred * (centred[other] + trend - trend[other]) / centred.var())


def _scores(values: Floats) -> Floats:
    """Return the normal scores of the ranks, (runs, 1)."""
    ranks = scipy.stats.rankdata(values)
    return np.asarray(scipy.stats.norm.ppf((ranks - 0.5) / len(values)))[:, np.newaxis]


def _codes(values: Floats) -> Floats:
    """Return columns that tell words apart, (runs, words)."""
    return np.asarray(values[:, np.newaxis] == np.unique(values), float)


INDICES = Indices(
    "shapley",
    _VARIABLES,
    FAMILY,
    Sample.ungrouped,
    _estimate,
    by_width("shapley"),
    fewest=128,
    most=MOST,
)


@dataclass(frozen=True, kw_only=True)
class Shapley(Hypercube):
    """A Latin hypercube for Shapley effects, shares of the variance of correlated parameters, too.

    Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter; at most ten vary.
    seed : int, default 1
        Equal seeds give equal runs.
    samples : int
        Number of runs, at least 128.
    correlations : sequence of (str, str, float), optional
        Pairs of parameters with their rank correlation, `[("beam_depth", "velocity", 0.5)]`; other
        pairs are independent.
    until : mapping, optional
        As of `Pawn`: runs placed for the probability that the response exceeds its limit.

    References
    ----------
    Owen (2014), SIAM/ASA J. Uncertainty Quantification 2, 245; Broto et al. (2020), ibid. 8, 693.

    Examples
    --------
    >>> speed, depth = il.Uniform(1, 5), il.Uniform("26 mm", "29 mm")
    >>> sample = il.Shapley(
    ...     samples=256, correlations=[("velocity", "beam_depth", 0.5)],
    ...     parameters={"velocity": speed, "beam_depth": depth})
    """

    records = (INDICES,)
    label = "Latin hypercube for Shapley effects"
