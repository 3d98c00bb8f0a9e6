"""Impulses between matched nodes: gaps closed, momentum kept, losses counted."""

from __future__ import annotations

import numpy as np
import pytest

from impactlab.fem3d.solver.system import close_gaps

DT = 0.1


@pytest.fixture
def two():
    """Two pairs after a predicted step: the first overlaps by 0.02, the second is apart by 0.01."""
    mass = np.array([2.0, 3.0, 5.0, 7.0])
    x = np.array([[0, 0, -0.01], [0, 0, 0.01], [1, 0, 0.02], [1, 0, 0.01]], dtype=float)
    v = np.zeros((4, 3))
    v[:, 2] = [-1.0, 0.5, -2.0, 0.0]
    return np.array([[0, 1], [2, 3]], np.int32), mass, x, v


def closed(pairs, mass, x, v, approach, rim=(False, False)):
    inverse = np.repeat(1.0 / mass[:, None], 3, axis=1)
    return close_gaps(pairs, np.array(rim), inverse, x, v, DT, approach)


def test_an_overlap_is_closed_to_zero_and_momentum_stays(two):
    pairs, mass, x, v = two
    before, momentum = v.copy(), np.sum(mass * v[:, 2])
    impulse, _, beyond = closed(pairs, mass, x, v, np.zeros(2))
    assert x[0, 2] == x[1, 2]
    assert np.sum(mass * v[:, 2]) == pytest.approx(momentum, rel=1e-14)
    assert impulse == pytest.approx(mass[0] * (v[0, 2] - before[0, 2]), rel=1e-14)
    assert impulse > 0.0
    assert not beyond


def test_a_gap_is_left_alone(two):
    pairs, mass, x, v = two
    closed(pairs, mass, x, v, np.zeros(2))
    assert np.array_equal(x[2:, 2], [0.02, 0.01])
    assert np.array_equal(v[2:, 2], [-2.0, 0.0])


def test_what_two_nodes_lose_when_they_meet_is_counted(two):
    """They touch at the step's end and stay together in the next: a perfectly plastic impact."""
    pairs, mass, x, v = two
    pairs = pairs[:1]
    approach = np.array([1.5])
    start = 0.5 * np.sum(mass[:2] * v[:2, 2] ** 2)
    lost = 0.0
    for _ in range(2):
        lost += closed(pairs, mass, x, v, approach, (False,))[1]
        x[:, 2] += DT * v[:, 2]
    assert v[0, 2] == pytest.approx(v[1, 2])
    plastic = 0.5 * 2.0 * 3.0 / 5.0 * 1.5**2
    assert lost == pytest.approx(plastic, rel=1e-12)
    assert start - 0.5 * np.sum(mass[:2] * v[:2, 2] ** 2) == pytest.approx(plastic, rel=1e-12)


def test_a_pair_on_the_rim_is_told_of_when_it_touches(two):
    pairs, mass, x, v = two
    assert not closed(pairs, mass, x.copy(), v.copy(), np.zeros(2), (False, True))[2]
    x[2, 2] = 0.0  # both overlap
    assert closed(pairs, mass, x, v, np.zeros(2), (True, False))[2]
