"""Which discretisations are tried: rungs along each axis, the study's own among them."""

from __future__ import annotations

from dataclasses import dataclass

from impactlab.model.discretisation import Discretisation

_COARSEST, _FINEST = 50, 800
"""Spans between nodes: the finer the last rung, the less has to be added for what lies beyond."""
_POINTS = (3, 5, 7, 9, 13, 17, 25)
_COURANTS = (0.9, 0.45, 0.225)


@dataclass(frozen=True)
class Ladders:
    """Rungs of each axis, rising in cost."""

    nodes: tuple[int, ...]
    points: tuple[int, ...]
    courant: tuple[float, ...]


def ladders(own: Discretisation) -> Ladders:
    """The rungs to try for a study of this discretisation.

    Spacings fall by half, with one about half-way between. The study's own, a half and a quarter
    of it are among them, if need be beyond the finest: its error is told from finer ones.
    """
    spans = {(own.nodes - 1) * factor for factor in (1, 2, 4)}
    at = _COARSEST
    while at <= _FINEST:
        spans |= {at, 3 * at // 4 * 2}
        at *= 2
    most = max(_FINEST, 4 * (own.nodes - 1))
    return Ladders(
        tuple(sorted(each + 1 for each in spans if each <= most)),
        tuple(sorted({*_POINTS, own.points})),
        tuple(sorted({own.courant / factor for factor in (1, 2, 4)} | {*_COURANTS}, reverse=True)),
    )
