"""Only what no study asks for can go."""

from impactlab.study.engine import Engine
from impactlab.study.execution import execute
from impactlab.study.stale import (
    NO_STUDY,
    OTHER_RUNS,
    OTHER_SOLVER,
    SET_ASIDE,
    UNFINISHED,
    outdated,
    stale,
)


def test_what_is_asked_for_stays(small_design, tmp_path):
    execute(small_design(1.0, 2.0), tmp_path, Engine())
    assert stale(tmp_path, [small_design(1.0, 2.0)]) == {}
    assert stale(tmp_path, [small_design(7.0), small_design(2.0)]) == {}


def test_what_is_not_is_named_with_the_reason(small_design, tmp_path):
    execute(small_design(1.0, 2.0), tmp_path, Engine())
    (shard,) = tmp_path.glob("*/*.nc")
    assert stale(tmp_path, [small_design(3.0)]) == {shard: OTHER_RUNS}
    assert stale(tmp_path, [small_design(1.0, profiles=1)]) == {shard: OTHER_SOLVER}
    assert stale(tmp_path, []) == {shard: NO_STUDY}


def test_left_overs_can_go_and_what_cannot_be_read_stays(small_design, tmp_path, caplog):
    execute(small_design(1.0), tmp_path, Engine())
    (shard,) = tmp_path.glob("*/*.nc")
    unfinished, damaged = shard.with_name(".some.nc.12"), shard.with_name("some.nc.damaged")
    unfinished.touch()
    damaged.touch()
    shard.write_bytes(shard.read_bytes()[:-10])
    expected = {unfinished: UNFINISHED, damaged: SET_ASIDE}
    assert stale(tmp_path, [small_design(3.0)]) == expected
    assert str(shard) in caplog.text


def test_of_runs_beside_a_study_only_those_of_another_solver_can_go(small_design, tmp_path):
    execute(small_design(1.0), tmp_path, Engine())
    assert outdated(tmp_path) == {}
    (shard,) = tmp_path.glob("*/*.nc")
    other = shard.parent.with_name("0" * 16)
    shard.parent.rename(other)
    assert outdated(tmp_path) == {other / shard.name: OTHER_SOLVER}
