"""Least angle regression: the order in which terms enter a sparse fit.

Efron, Hastie, Johnstone and Tibshirani (2004), Ann. Stat. 32, 407. Step by step, the fit moves in
the direction that makes equal angles with all terms taken so far, until another term correlates as
much with what is left. Every choice at the limits of round-off is that of scikit-learn 1.9
(`lars_path_gram`, BSD-3-Clause): the same operations, so that terms, and stored results, are those
that it gives. Among them: a term that depends on those taken is left out, and its place in the
Gram matrix stays exchanged; where a coefficient changes its sign, a step follows that takes no
term.
"""

from typing import Any

import numpy as np
import scipy  # its linalg is loaded when first used
from numpy.typing import NDArray

from impactlab.types import Floats

_EPS = float(np.finfo(float).eps)
_DEPENDENT = 1e-7  # least length of what a term adds to those taken
_NO_CORRELATION = float(np.finfo(np.float32).eps)  # at which nothing is left to explain
_TINY = np.finfo(np.float32).tiny  # so that nothing is divided by zero
_DECIMALS = np.finfo(float).precision


def terms_in_order(correlations: Floats, gram: Floats, most: int) -> list[int]:
    """Return the numbers of the terms in the order in which they enter, after `most` steps.

    correlations: of each term with the values, (terms,); gram: products of the terms, which are of
    norm one, (terms, terms).
    """
    gram, left = gram.copy(), correlations.copy()  # left: of the terms not taken
    places, active = np.arange(left.size), list[int]()
    factor = np.zeros((min(most, left.size),) * 2)  # lower Cholesky factor of the taken terms
    signs, coefficients = np.zeros(len(factor)), np.zeros(left.size)
    step, enters = 0, True
    while left.size and step < most and len(active) < places.size:
        number, best = len(active), int(np.argmax(np.abs(left)))
        largest = np.abs(left[best])
        if largest <= _NO_CORRELATION:
            break
        if enters:
            signs[number] = np.sign(left[best])
            for pair in (gram, gram.T, places):
                _exchange(pair, number, number + best)
            if not _extend(factor, gram, number):
                left[best] = 0.0
                continue
            _exchange(left, 0, best)
            left = left[1:]
            active.append(int(places[number]))
            number += 1
        direction, unit = _equiangular(factor[:number, :number], signs[:number])
        slopes = np.around(np.dot(gram[:number, number:].T, direction), _DECIMALS)
        length = min(
            _least_positive((largest - left) / (unit - slopes + _TINY)),
            _least_positive((largest + left) / (unit + slopes + _TINY)),
            largest / unit,
        )
        to_zero = -coefficients[active] / (direction + _TINY)
        nearest = _least_positive(to_zero)
        enters = not nearest < length
        if not enters:
            signs[np.flatnonzero(to_zero == nearest)] *= -1.0
        coefficients[active] += length * direction
        left = left - length * slopes
        step += 1
    return active


def _exchange(array: NDArray[Any], first: int, second: int) -> None:
    array[[first, second]] = array[[second, first]]


def _extend(factor: Floats, gram: Floats, number: int) -> bool:
    """Add a term to the Cholesky factor; return False where it depends on the others."""
    row = factor[number]
    row[:number] = gram[number, :number]
    if number:
        row[:number] = scipy.linalg.solve_triangular(
            factor[:number, :number], row[:number], lower=True
        )
    added = gram[number, number] - np.dot(row[:number], row[:number])
    row[number] = max(np.sqrt(np.abs(added)), _EPS)
    return bool(row[number] >= _DEPENDENT)


def _equiangular(factor: Floats, signs: Floats) -> tuple[Floats, float]:
    """Return the coefficients of the equiangular direction, and its product with every term."""
    direction, _ = scipy.linalg.lapack.dpotrs(factor, signs, lower=True)
    square, shift = np.sum(direction * signs), _EPS
    while not square > 0.0:  # the factor is singular but for round-off
        factor = factor + shift * np.eye(len(factor))
        direction, _ = scipy.linalg.lapack.dpotrs(factor, signs, lower=True)
        square, shift = max(np.sum(direction * signs), _EPS), 2.0 * shift
    unit = 1.0 / np.sqrt(square)
    return direction * unit, float(unit)


def _least_positive(values: Floats) -> float:
    return float(values[values > 0.0].min(initial=np.finfo(float).max))
