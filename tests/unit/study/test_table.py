"""Answers find their runs by key, in whatever order they come."""

import numpy as np

from impactlab.study.shard import KEY
from impactlab.study.table import Table


def keys(*numbers):
    """Some end in zero bytes, as hashes do."""
    return np.array([number.to_bytes(2, "big") + bytes(14) for number in numbers], dtype=KEY)


def test_answers_take_the_rows_of_their_keys():
    table = Table(keys(256, 1, 512, 2), ["value"])
    assert table.missing().tolist() == [0, 1, 2, 3]
    table.fill(keys(2, 999, 256), {"value": np.array([4.0, -1.0, 1.0]), "other": np.zeros(3)})
    assert table.missing().tolist() == [1, 2]
    table.fill(keys(512, 1, 0), {"value": np.array([3.0, 2.0, -1.0])})
    assert table.missing().size == 0
    assert table.columns()["value"].tolist() == [1.0, 2.0, 3.0, 4.0]
    assert list(table.columns()) == ["value"]


def test_the_first_of_equal_runs_stands_for_all():
    table = Table(keys(7, 3, 7, 3, 7), ["value"])
    assert table.missing().tolist() == [0, 1]
    table.fill(keys(3, 7), {"value": np.array([[3.0, 30.0], [7.0, 70.0]])})
    assert table.columns()["value"][:, 1].tolist() == [70.0, 30.0, 70.0, 30.0, 70.0]


def test_keys_beyond_the_last_are_not_taken_for_it():
    table = Table(keys(1, 2), ["value"])
    table.fill(keys(3), {"value": np.array([9.0])})
    assert table.missing().tolist() == [0, 1]
