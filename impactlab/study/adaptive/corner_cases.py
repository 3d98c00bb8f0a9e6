"""The corner cases of a study: its numbers at their extremes, in every combination of a few.

With more than four numbers all corners would be too many. Then the columns of a Hadamard matrix
and their negatives are taken (a two-level design of resolution IV: any three parameters meet in
all eight combinations of their extremes; Box, Hunter and Hunter (2005), Statistics for
Experimenters, ch. 6), and the case in the middle with them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import hadamard

from impactlab.model.parameters import Value
from impactlab.study.declaration import Grid, Study

_ALL = 4
"""Up to so many numbers all corners are taken."""
_TAIL = 0.005
"""Where a distribution has no end, its extremes are the quantiles of this and of its complement."""
NUMERICS = ("nodes", "points", "courant")
"""What the discretisation is sought in: not varied between cases."""


def corner_cases(study: Study) -> dict[str, list[Value]]:
    """Values by parameter, one a case: numbers at their extremes and in the middle, each word.

    Where only the discretisation is varied, the study's own impact is the one case.
    """
    ends = {name: values for name, values in _extremes(study).items() if name not in NUMERICS}
    words = {name: values for name, values in ends.items() if isinstance(values[0], str)}
    numbers = {name: values for name, values in ends.items() if name not in words}
    signs = corners(len(numbers))
    rows = [
        (
            *combination,
            *(values[1 + sign] for values, sign in zip(numbers.values(), row, strict=True)),
        )
        for combination in product(*words.values())
        for row in signs.tolist()
    ]
    names = [*words, *numbers]
    if not names:
        return {"velocity": [study.impact.velocity]}
    return {name: [row[at] for row in rows] for at, name in enumerate(names)}


def corners(count: int) -> NDArray[np.int64]:
    """Signs (cases, count) of the corners of a cube, or of some, and the middle (zeros) last."""
    middle = np.zeros((1, count), dtype=np.int64)
    if count == 0:
        return middle
    if count <= _ALL:
        signs = np.array(list(product((-1, 1), repeat=count)))
    else:
        half = hadamard(1 << (count - 1).bit_length())[:, :count]
        signs = np.concatenate([half, -half])
    return np.concatenate([signs, middle])


def _extremes(study: Study) -> Mapping[str, Sequence[Any]]:
    """(least, middle, greatest) of each number, all words of the others."""
    sampling = study.sampling
    if isinstance(sampling, Grid):
        return {name: _of_values(values) for name, values in sampling.parameters.items()}
    chances = np.array([_TAIL, 0.5, 1.0 - _TAIL])
    found = {}
    for name, given in sampling.varied.items():
        low, middle, high = given.quantile(chances).tolist()
        ends = given.bounds()
        found[name] = (ends.get("low", low), middle, ends.get("high", high))
    return found


def _of_values(values: Sequence[Any]) -> Sequence[Any]:
    if isinstance(values[0], str):
        return values
    ordered = sorted(values)
    return ordered[0], ordered[len(ordered) // 2], ordered[-1]
