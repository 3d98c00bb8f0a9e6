"""Gaussian copula: rank correlations between columns of a sample whose margins stay as drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy  # its stats are loaded when first used

from impactlab.types import Floats

Correlations = Sequence[tuple[str, str, float]]
"""Two parameters and Spearman's rank correlation of them; pairs that are not listed have 0."""
_LEAST = 1e-8
"""Smallest eigenvalue of a matrix that counts as positive definite."""


def matrix(names: Sequence[str], correlations: Correlations) -> Floats:
    """Return the linear correlations of the normal variables, (names, names).

    They are 2 sin(π ρ / 6) of the rank correlations ρ: Pearson (1907), as in Kruskal (1958), J. Am.
    Stat. Assoc. 53, 814 (recalled, not read). Pairs with other names are left out.
    """
    found, place = np.eye(len(names)), {name: at for at, name in enumerate(names)}
    for one, other, rank in correlations:
        if one in place and other in place:
            linear = 2 * np.sin(np.pi * rank / 6)
            found[place[one], place[other]] = found[place[other], place[one]] = linear
    return found


def contradicting(names: Sequence[str], correlations: Correlations) -> list[str]:
    """Return the fewest of the names whose correlations exclude each other; none if all can be."""

    def possible(some: Sequence[str]) -> bool:
        return bool(np.linalg.eigvalsh(matrix(some, correlations)).min(initial=1) > _LEAST)

    kept = list(names)
    if possible(kept):
        return []
    for name in names:
        rest = [each for each in kept if each != name]
        kept = kept if possible(rest) else rest
    return kept


def correlated(unit: Floats, linear: Floats) -> Floats:
    """Return the sample with each column in another order, (runs, parameters).

    unit: independent draws in the unit cube, so even as they are; linear: as from `matrix`. The
    ranks are those of the normal variables with these correlations: Stein (1987), Technometrics 29,
    143, section 4 (recalled, not read). A column without partners keeps its order.
    """
    normal = scipy.stats.norm.ppf(unit) @ np.linalg.cholesky(linear).T
    ranks = normal.argsort(axis=0, kind="stable").argsort(axis=0)
    return np.asarray(np.take_along_axis(np.sort(unit, axis=0), ranks, axis=0))
