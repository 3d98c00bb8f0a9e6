"""Answers are read from shards, column by column; what is lost meanwhile is an error, no hole."""

import numpy as np
import pytest

from impactlab.study.answers import Answers
from impactlab.study.ledger import Ledger
from impactlab.study.storage import Form, Shards

KEYS = np.array([b"a" * 16, b"b" * 16, b"c" * 16, b"b" * 16])


@pytest.fixture
def shards(tmp_path):
    kept = Shards(tmp_path, Form(0, False), "version")
    kept.write(KEYS[[2]], {"force": np.array([3.0]), "status": np.array([1], np.int32)})
    kept.write(KEYS[[1, 0]], {"force": np.array([2.0, 1.0]), "status": np.zeros(2, np.int32)})
    return kept


@pytest.mark.parametrize("opened", [0, 1, 2])
def test_columns_are_in_the_order_of_the_runs(shards, monkeypatch, opened):
    """opened: shards that may stay so, of two."""
    monkeypatch.setattr("impactlab.study.answers._OPEN", opened)
    with Answers(shards, Ledger(KEYS)) as answers:
        columns = answers.columns(["status", "force"])
        assert [*columns] == ["status", "force"]
        assert columns["force"].compute().tolist() == [1.0, 2.0, 3.0, 2.0]
        assert columns["status"].compute().tolist() == [0, 0, 1, 0]
        assert columns["status"].dtype == np.int32


def test_a_run_without_answers_is_an_error(shards):
    with pytest.raises(OSError, match="run the same command again"):
        Answers(shards, Ledger(np.append(KEYS, [b"d" * 16])))


def test_a_shard_that_is_damaged_meanwhile_is_an_error(shards):
    first, second = shards.files()
    with Answers(shards, Ledger(KEYS)) as answers:
        columns = answers.columns(["force"])
        first.write_bytes(second.read_bytes())
        with pytest.raises(OSError, match=f"{first.name} was damaged"):
            columns["force"].compute(scheduler="synchronous")
