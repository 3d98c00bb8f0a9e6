"""Answers find their runs by key, in whatever order they come."""

import numpy as np

from impactlab.study.ledger import Ledger
from impactlab.study.shard import KEY


def keys(*numbers):
    """Some end in zero bytes, as hashes do."""
    return np.array([number.to_bytes(2, "big") + bytes(14) for number in numbers], dtype=KEY)


def test_answers_find_the_runs_of_their_keys():
    ledger = Ledger(keys(256, 1, 512, 2))
    assert ledger.missing().tolist() == [0, 1, 2, 3]
    asked, runs = ledger.find(keys(2, 999, 256))
    assert asked.tolist() == [True, False, True]
    assert runs.tolist() == [3, 0]
    ledger.mark(runs)
    assert ledger.missing().tolist() == [1, 2]
    assert ledger.left() == 2


def test_the_first_of_equal_runs_stands_for_all():
    ledger = Ledger(keys(7, 3, 7, 3, 7))
    assert ledger.missing().tolist() == [0, 1]
    assert ledger.left() == 5
    assert ledger.distinct == 2
    ledger.mark(ledger.find(keys(3))[1])
    assert ledger.left() == 3
    values = np.array([[7.0, 70.0], [3.0, 30.0], [0, 0], [0, 0], [0, 0]])
    assert ledger.spread(values)[:, 1].tolist() == [70.0, 30.0, 70.0, 30.0, 70.0]


def test_keys_beyond_the_last_are_not_taken_for_it():
    asked, runs = Ledger(keys(1, 2)).find(keys(3))
    assert not asked.any()
    assert runs.size == 0
