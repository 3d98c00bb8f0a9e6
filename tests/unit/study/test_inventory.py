"""A study's answers, progress and removable files, from its shards."""

import numpy as np
import pytest

from impactlab.study.engine import Engine
from impactlab.study.execute import execute
from impactlab.study.inventory import Work, file_stats, open_answers, removable_files, status
from impactlab.study.store import OutputSpec, RunIndex, Shards, locked

OTHER_SOLVER = "belongs to another version of the solver, or another output"
KEYS = np.array([b"a" * 16, b"b" * 16, b"c" * 16, b"b" * 16])


@pytest.fixture
def shards(tmp_path):
    kept = Shards(tmp_path, OutputSpec(0, False), "version")
    kept.write(KEYS[[2]], {"force": np.array([3.0]), "status": np.array([1], np.int32)})
    kept.write(KEYS[[1, 0]], {"force": np.array([2.0, 1.0]), "status": np.zeros(2, np.int32)})
    return kept


@pytest.mark.parametrize("opened", [0, 1, 2])
def test_columns_are_in_the_order_of_the_runs(shards, monkeypatch, opened):
    """opened: shards that may stay so, of two."""
    monkeypatch.setattr("impactlab.study.inventory._OPEN", opened)
    with open_answers(shards, RunIndex(KEYS), ["status", "force"]) as columns:
        assert [*columns] == ["status", "force"]
        assert columns["force"].compute().tolist() == [1.0, 2.0, 3.0, 2.0]
        assert columns["status"].compute().tolist() == [0, 0, 1, 0]
        assert columns["status"].dtype == np.int32


def test_a_run_without_answers_is_an_error(shards):
    index = RunIndex(np.append(KEYS, [b"d" * 16]))
    with (
        pytest.raises(OSError, match="run the same command again"),
        open_answers(shards, index, ["force"]),
    ):
        pass
    # a shard that is damaged meanwhile is an error
    keys = np.array([f"{run:016}".encode() for run in range(10_000)])
    path = shards.write(keys, {"force": np.zeros(keys.size)})  # larger than a buffer of its file
    with open_answers(shards, RunIndex(np.append(KEYS, keys)), ["force"]) as columns:
        content = bytearray(path.read_bytes())
        content[-1000] ^= 1
        path.write_bytes(content)
        with pytest.raises(OSError, match=f"{path.name} was damaged"):
            columns["force"].compute(scheduler="synchronous")


def test_a_study_not_begun_and_one_that_grew(small_design, tmp_path):
    folder = tmp_path / "shards"
    found = status(small_design(1.0, 2.0), folder)
    assert (found.runs, found.done, found.failed, found.size) == (4, 0, 0, 0)
    assert found.age is None
    assert found.holder == ""
    assert not folder.exists()
    execute(small_design(1.0, 2.0), folder, Engine())
    found = status(small_design(1.0, 2.0, 3.0, 3.0), folder)
    assert (found.runs, found.done, found.failed) == (8, 4, 0)
    assert 0 <= found.age < 60
    sizes = [path.stat().st_size for path in folder.rglob("*") if path.is_file()]
    assert found.size == sum(sizes)
    with locked(folder):
        assert "process" in status(small_design(1.0), folder).holder


def test_runs_without_an_asked_response_failed(small_design, tmp_path):
    unfinished = {"responses": ["contact_duration"]}
    design = small_design(1.0, 2.0, **unfinished).assign_coords(duration=1e-4)
    execute(design, tmp_path, Engine())
    assert status(design, tmp_path).failed == 4


@pytest.mark.parametrize("chunk", [1, 3, 100])
def test_work_is_the_same_in_chunks(small_design, monkeypatch, chunk):
    whole = Work.of(small_design(1.0, 2.0, 3.0))
    monkeypatch.setattr("impactlab.study.inventory._CHUNK", chunk)
    parts = Work.of(small_design(1.0, 2.0, 3.0))
    assert parts.keys.tobytes() == whole.keys.tobytes()
    assert parts.cost.tobytes() == whole.cost.tobytes()
    picked = whole.solver.cases(whole.design, np.array([4, 1]))
    assert picked["velocity"].tolist() == [3.0, 1.0]
    assert picked["nodes"].tolist() == [11, 21]


def test_a_refused_run_is_named_by_its_number(small_design, monkeypatch):
    monkeypatch.setattr("impactlab.study.inventory._CHUNK", 2)
    with pytest.raises(
        ValueError, match=r"^run 4 \(velocity = -3\.0, nodes = 11\): .*velocity.*zero$"
    ):
        Work.of(small_design(1.0, 2.0, -3.0))


def test_a_file_that_has_gone_has_no_size(tmp_path):
    (tmp_path / "here").write_bytes(b"123")
    found = list(file_stats([tmp_path / "here", tmp_path / "gone", tmp_path]))
    assert [each.st_size for each in found] == [3]


def test_what_is_asked_for_stays_and_the_rest_is_named_with_the_reason(small_design, tmp_path):
    execute(small_design(1.0, 2.0), tmp_path, Engine())
    assert removable_files(tmp_path, [small_design(1.0, 2.0)]) == {}
    assert removable_files(tmp_path, [small_design(7.0), small_design(2.0)]) == {}
    (shard,) = tmp_path.glob("*/*.npz")
    assert removable_files(tmp_path, [small_design(3.0)]) == {shard: "holds no run of the study"}
    assert removable_files(tmp_path, [small_design(1.0, profiles=1)]) == {shard: OTHER_SOLVER}


def test_left_overs_can_go_and_what_cannot_be_read_stays(small_design, tmp_path, caplog):
    execute(small_design(1.0), tmp_path, Engine())
    (shard,) = tmp_path.glob("*/*.npz")
    unfinished = shard.with_name(f".some.npz.{32 * 'a'}")
    damaged = shard.with_name("some.npz.damaged")
    unfinished.touch()
    damaged.touch()
    shard.write_bytes(shard.read_bytes()[:-10])
    expected = {unfinished: "is unfinished", damaged: "was damaged and set aside"}
    assert removable_files(tmp_path, [small_design(3.0)]) == expected
    assert str(shard) in caplog.text


def test_of_runs_beside_a_study_only_those_of_another_solver_can_go(small_design, tmp_path):
    execute(small_design(1.0), tmp_path, Engine())
    assert removable_files(tmp_path, None) == {}
    (shard,) = tmp_path.glob("*/*.npz")
    other = shard.parent.with_name("0" * 16)
    shard.parent.rename(other)
    former = (other / shard.name).with_suffix(".nc")
    former.touch()
    assert removable_files(tmp_path, None) == {
        other / shard.name: OTHER_SOLVER,
        former: OTHER_SOLVER,
    }
