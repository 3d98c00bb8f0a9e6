"""One process at a time, and it says who."""

import os
import subprocess
import sys

import pytest

from impactlab.study.lock import held, holder

HOLD = """
import sys
from pathlib import Path
from impactlab.study.lock import held
with held(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def other(tmp_path):
    """Another process at work in the folder."""
    command = [sys.executable, "-c", HOLD, str(tmp_path)]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.communicate()


def test_a_second_process_is_told_who_works(tmp_path, other):
    assert f"process {other.pid} on " in holder(tmp_path)
    with pytest.raises(BlockingIOError, match=rf"process {other.pid} on .*wait"), held(tmp_path):
        pass


def test_a_killed_process_leaves_the_folder_free(tmp_path, other, caplog):
    caplog.set_level("INFO")
    other.kill()
    other.wait()
    assert holder(tmp_path) == ""
    with held(tmp_path):
        assert f"process {other.pid}" in caplog.text
    caplog.clear()
    with held(tmp_path):
        assert not caplog.text


def test_steps_within_a_longer_work_leave_the_folder_held(tmp_path, caplog):
    caplog.set_level("INFO")
    with held(tmp_path):
        for _ in range(2):
            with held(tmp_path):
                pass
            assert f"process {os.getpid()} on " in holder(tmp_path)
    assert holder(tmp_path) == ""
    assert not caplog.text


def test_a_disk_too_full_for_a_note_is_left_to_what_is_more_than_one(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(type(tmp_path), "write_text", full)
    with held(tmp_path):
        assert holder(tmp_path) == "another process"


def test_nobody_works_in_an_unknown_folder(tmp_path):
    assert holder(tmp_path / "none") == ""
    assert not (tmp_path / "none").exists()
