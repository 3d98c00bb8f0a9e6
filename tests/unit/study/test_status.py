"""What is told of a study's progress is what lies on disk."""

import numpy as np
import pytest

from impactlab.study.engine import Engine
from impactlab.study.execution import execute
from impactlab.study.lock import held
from impactlab.study.status import disk_size, status
from impactlab.study.work import Work


def test_a_study_not_begun(small_design, tmp_path):
    found = status(small_design(1.0, 2.0), tmp_path / "shards")
    assert (found.runs, found.done, found.failed, found.size) == (4, 0, 0, 0)
    assert found.age is None
    assert found.holder == ""
    assert not (tmp_path / "shards").exists()


def test_a_study_that_grew(small_design, tmp_path):
    execute(small_design(1.0, 2.0), tmp_path, Engine())
    found = status(small_design(1.0, 2.0, 3.0, 3.0), tmp_path)
    assert (found.runs, found.done, found.failed) == (8, 4, 0)
    assert 0 <= found.age < 60
    assert found.size == sum(path.stat().st_size for path in tmp_path.rglob("*") if path.is_file())


def test_runs_without_an_asked_response_failed(small_design, tmp_path):
    unfinished = {"responses": ["contact_duration"]}
    design = small_design(1.0, 2.0, **unfinished).assign_coords(duration=1e-4)
    execute(design, tmp_path, Engine())
    assert status(design, tmp_path).failed == 4


def test_it_names_who_is_at_work(small_design, tmp_path):
    with held(tmp_path):
        assert "process" in status(small_design(1.0), tmp_path).holder


@pytest.mark.parametrize("chunk", [1, 3, 100])
def test_work_is_the_same_in_chunks(small_design, monkeypatch, chunk):
    whole = Work.of(small_design(1.0, 2.0, 3.0))
    monkeypatch.setattr("impactlab.study.work._CHUNK", chunk)
    parts = Work.of(small_design(1.0, 2.0, 3.0))
    assert parts.keys.tobytes() == whole.keys.tobytes()
    assert parts.cost.tobytes() == whole.cost.tobytes()
    picked = whole.cases(np.array([4, 1]))
    assert picked["velocity"].tolist() == [3.0, 1.0]
    assert picked["nodes"].tolist() == [11, 21]


def test_a_refused_run_is_named_by_its_number(small_design, monkeypatch):
    monkeypatch.setattr("impactlab.study.work._CHUNK", 2)
    with pytest.raises(ValueError, match=r"run 4: .*velocity"):
        Work.of(small_design(1.0, 2.0, -3.0))


def test_a_file_that_has_gone_has_no_size(tmp_path):
    (tmp_path / "here").write_bytes(b"123")
    assert disk_size([tmp_path / "here", tmp_path / "gone", tmp_path]) == 3
