"""Shards are found by content and never when damaged; runs by key; one process works at a time."""

import os
import shutil
import subprocess
import sys
from contextlib import closing
from zipfile import ZipFile

import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.study import store
from impactlab.study.inventory import removable_files
from impactlab.study.shard import KEY, Shard
from impactlab.study.solvers import kernels
from impactlab.study.store import (
    OutputSpec,
    RunIndex,
    Shards,
    holder,
    locked,
    run_keys,
    shard_files,
)

OUTPUT = OutputSpec(samples=11, profiles=True)
VERSION = kernels.SOLVER.version


def cases(*velocities, nodes=11):
    grid = il.Discretisation(nodes=nodes, points=3)
    return case_table(il.paper_impact(), grid, duration=2e-4, varied={"velocity": list(velocities)})


@pytest.fixture
def shards(tmp_path):
    return Shards(tmp_path, OUTPUT, VERSION)


def written(shards, table):
    columns = kernels.SOLVER.solve(table, OUTPUT)
    keys = run_keys(table, OUTPUT, VERSION)
    return keys, columns, shards.write(keys, columns)


def found_keys(shards):
    return {bytes(key) for keys, _ in shards.read() for key in keys}


def test_what_was_written_is_read_to_the_bit(shards):
    keys, columns, path = written(shards, cases(0.5, 1.0, 2.0))
    path.unlink()
    columns["key"] = np.array([3.0, 2.0, 1.0])  # as a response may be named
    shards.write(keys, columns)
    ((found, read),) = shards.read()
    assert found.tobytes() == keys.tobytes()
    assert read.keys() == columns.keys()
    assert all(read[name].tobytes() == columns[name].tobytes() for name in columns)


def test_keys_tell_apart_every_field_and_form():
    table = cases(0.5, 1.0)
    keys = set(run_keys(table, OUTPUT, VERSION))
    assert len(keys) == 2
    for name in table.dtype.names:
        other = table.copy()
        other[name] += 1
        assert keys.isdisjoint(run_keys(other, OUTPUT, VERSION)), name
    assert keys.isdisjoint(run_keys(table, OUTPUT, "other"))
    assert keys.isdisjoint(run_keys(table, OutputSpec(samples=12, profiles=True), VERSION))
    assert keys.isdisjoint(run_keys(table, OutputSpec(samples=11, profiles=False), VERSION))


def truncated(path, other):
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])


def flipped(path, other):
    content = bytearray(path.read_bytes())
    with closing(Shard(path)) as shard:
        force = shard.read("peak_force").tobytes()
    content[content.index(force)] ^= 1
    path.write_bytes(content)


def swapped(path, other):
    shutil.copy(other, path)


def stripped(path, other):
    with ZipFile(path) as shard:
        columns = {name: shard.read(name) for name in shard.namelist()[:-1]}
        comment = shard.comment
    with ZipFile(path, "w") as shard:
        shard.comment = comment
        for name, content in columns.items():
            shard.writestr(name, content)


def foreign(path, other):
    xr.Dataset({"key": ("run", [1.0])}).to_netcdf(path)


def empty(path, other):
    path.write_bytes(b"")


def folder(path, other):
    path.unlink()
    path.mkdir()


@pytest.mark.parametrize("damage", [truncated, flipped, swapped, stripped, foreign, empty, folder])
def test_damaged_shards_are_named_and_set_aside(shards, damage, caplog):
    keys, _, other = written(shards, cases(0.5))
    _, _, path = written(shards, cases(1.0))
    damage(path, other)
    ((found, _),) = shards.read()
    assert found.tobytes() == keys.tobytes()
    assert str(path) in caplog.text
    assert path.exists()  # reading changes nothing
    assert len(list(shards.recover())) == 1
    assert path.with_name(path.name + ".damaged").exists()
    assert shard_files(shards.folder) == [other]


def test_a_flipped_bit_changes_no_answer_wherever_it_is(shards):
    """The shard is as good as before, or damaged, and never a crash."""
    keys, columns, path = written(shards, cases(0.5))
    whole = path.read_bytes()
    for place in range(0, len(whole), 29):
        content = bytearray(whole)
        content[place] ^= 1 << place % 8
        path.write_bytes(content)
        for found, read in shards.read():
            assert found.tobytes() == keys.tobytes()
            assert all(read[name].tobytes() == columns[name].tobytes() for name in columns)


def test_a_shard_of_another_folder_is_found_out(shards, tmp_path, caplog):
    *_, path = written(shards, cases(0.5))
    for form in ((OUTPUT, "another version"), (OutputSpec(samples=0, profiles=False), VERSION)):
        other = Shards(tmp_path, *form)
        assert list(other.read()) == []
        assert "damaged" not in caplog.text
        other.folder.mkdir()
        shutil.copy(path, other.folder)
        assert list(other.read()) == []
        assert "damaged" in caplog.text
        caplog.clear()


def test_one_shard_takes_the_place_of_all_small_ones(shards, monkeypatch, tmp_path):
    first, columns, _ = written(shards, cases(0.5, 1.0))
    with monkeypatch.context() as any_is_large:
        any_is_large.setattr(store, "_SMALL", 0)
        *_, large = written(Shards(tmp_path, OUTPUT, VERSION), cases(2.0))
    second, *_ = written(shards, cases(1.0, 3.0))
    shards.merge()
    assert large in shard_files(shards.folder)
    assert len(shard_files(shards.folder)) == 2
    assert found_keys(shards) == {*first, *second, *run_keys(cases(2.0), OUTPUT, VERSION)}
    (merged,) = [part for part in shards.read() if part[0].size == 3]
    at = merged[0].tolist().index(first[0])
    assert merged[1]["peak_force"][at] == columns["peak_force"][0]


def test_small_shards_are_merged_while_they_come(shards, monkeypatch):
    monkeypatch.setattr(store, "_MANY", 4)
    velocities = np.linspace(1, 2, 10)
    for velocity in velocities:
        written(shards, cases(velocity))
        assert len(shard_files(shards.folder)) <= 4
    assert found_keys(shards) == set(run_keys(cases(*velocities), OUTPUT, VERSION))


def test_what_is_merged_while_it_is_read_is_neither_lost_nor_called_damaged(shards, caplog):
    for velocity in (1.0, 2.0, 3.0):
        written(shards, cases(velocity))
    reading = Shards.read(shards)
    found = {bytes(key) for key in next(reading)[0]}
    shards.merge()
    found |= {bytes(key) for keys, _ in reading for key in keys}
    assert found == set(run_keys(cases(1.0, 2.0, 3.0), OUTPUT, VERSION))
    assert not caplog.text


def test_a_crash_between_merging_and_clearing_loses_nothing(shards, monkeypatch, tmp_path):
    keys = {key for velocity in (1.0, 2.0) for key in written(shards, cases(velocity))[0]}
    with monkeypatch.context() as crash:
        crash.setattr(type(tmp_path), "unlink", crashing)
        with pytest.raises(KeyboardInterrupt):
            shards.merge()
    assert len(shard_files(shards.folder)) == 3
    again = Shards(tmp_path, OUTPUT, VERSION)
    list(again.recover())
    again.merge()
    assert len(shard_files(again.folder)) == 1
    assert found_keys(again) == keys
    assert sum(found.size for found, _ in again.read()) == 2


def crashing(path, missing_ok=False):
    """In the place of Path.unlink; temporary names are cleared with missing_ok."""
    if not missing_ok:
        raise KeyboardInterrupt


def test_what_was_not_written_to_its_end_is_cleared(shards):
    *_, path = written(shards, cases(0.5))
    (path.parent / f".some.npz.{32 * 'a'}").write_bytes(b"half")
    assert len(list(shards.recover())) == 1
    assert list(path.parent.iterdir()) == [path]


def keys(*numbers):
    """Return keys, some of which end in zero bytes, as hashes do."""
    return np.array([number.to_bytes(2, "big") + bytes(14) for number in numbers], dtype=KEY)


def test_answers_find_the_runs_of_their_keys():
    index = RunIndex(keys(256, 1, 512, 2))
    assert np.flatnonzero(~index.done).tolist() == [0, 1, 2, 3]
    requested, runs = index.find(keys(2, 999, 256))
    assert requested.tolist() == [True, False, True]
    assert runs.tolist() == [3, 0]
    beyond_the_last, none = RunIndex(keys(1, 2)).find(keys(3))
    assert not beyond_the_last.any()
    assert none.size == 0
    index.done[runs] = True
    assert np.flatnonzero(~index.done).tolist() == [1, 2]


def test_the_first_of_equal_runs_stands_for_all():
    index = RunIndex(keys(7, 3, 7, 3, 7))
    assert np.flatnonzero(~index.done).tolist() == [0, 1]
    assert not index.spread(index.done.copy()).any()
    assert index.distinct == 2
    index.done[index.find(keys(3))[1]] = True
    assert index.spread(index.done.copy()).tolist() == [False, True, False, True, False]
    values = np.array([[7.0, 70.0], [3.0, 30.0], [0, 0], [0, 0], [0, 0]])
    assert index.spread(values)[:, 1].tolist() == [70.0, 30.0, 70.0, 30.0, 70.0]


HOLD = """
import sys
from pathlib import Path
from impactlab.study.store import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def other(tmp_path):
    """Start another process at work in the folder."""
    command = [sys.executable, "-c", HOLD, str(tmp_path)]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.communicate()


def test_a_second_process_is_told_who_works(tmp_path, other):
    assert f"process {other.pid} on " in holder(tmp_path)
    with pytest.raises(BlockingIOError, match=rf"process {other.pid} on .*wait"), locked(tmp_path):
        pass


def test_a_killed_process_leaves_the_folder_free(tmp_path, other, caplog):
    caplog.set_level("INFO")
    other.kill()
    other.wait()
    assert holder(tmp_path) == ""
    with locked(tmp_path):
        assert f"process {other.pid}" in caplog.text
    caplog.clear()
    with locked(tmp_path):
        assert not caplog.text


def test_steps_within_a_longer_work_leave_the_folder_held(tmp_path, caplog):
    caplog.set_level("INFO")
    assert holder(tmp_path / "none") == ""
    assert not (tmp_path / "none").exists()
    with locked(tmp_path):
        for _ in range(2):
            with locked(tmp_path):
                pass
            assert f"process {os.getpid()} on " in holder(tmp_path)
    assert holder(tmp_path) == ""
    assert not caplog.text


def test_a_disk_too_full_for_a_note_is_left_to_what_is_more_than_one(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(type(tmp_path), "write_text", full)
    with locked(tmp_path):
        assert holder(tmp_path) == "another process"


@pytest.mark.parametrize("owner", [b"\xff\x00" * 9999, b"", b"\x1b[31m" + b"[" * 500, None])
def test_garbage_for_an_owner_blocks_nothing(tmp_path, owner, caplog):
    caplog.set_level("INFO")
    if owner is None:
        (tmp_path / "owner").mkdir()
    else:
        (tmp_path / "owner").write_bytes(owner)
    with locked(tmp_path):
        pass
    assert caplog.messages == ["another process did not finish: resuming where it stopped"]
    assert holder(tmp_path) == ""
    assert (tmp_path / "owner").exists() == (owner is None)


def test_what_people_left_among_shards_stays_as_it_is(shards, caplog):
    _, _, path = written(shards, cases(0.5, 1.0))
    (path.parent / ".notes").write_text("mine")
    (path.parent / ".cache").mkdir()
    (path.parent / "folder.npz").mkdir()
    (path.parent / "copy.npz").write_bytes(path.read_bytes())
    before = sorted(path.parent.iterdir())
    assert [found.size for found in shards.recover()] == [2]
    assert sorted(path.parent.iterdir()) == before
    assert removable_files(path.parents[1], []).keys() == {path}
    assert caplog.messages == []
