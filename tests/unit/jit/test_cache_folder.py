"""The folder of compiled kernels: whose it is, when it is removed, and what happens without one."""

import os
import time
from pathlib import Path

import numba
import pytest

from impactlab import jit

SOURCES, OTHERS = 64 * "a", 64 * "b"


@pytest.fixture
def root(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path / "cache"


def left_alone(folder, days):
    """The folder as if nobody had looked into it for so long."""
    (folder / "code.kernel").touch()
    then = time.time() - 24 * 3600 * days
    os.utime(folder, (then, then))
    return folder


def test_other_sources_and_another_processor_have_other_folders(root, monkeypatch):
    mine = jit.cache_folder(SOURCES)
    assert mine == jit.cache_folder(SOURCES)
    others = jit.cache_folder(OTHERS)
    monkeypatch.setattr(numba.config, "CPU_NAME", "another")
    elsewhere = jit.cache_folder(SOURCES)
    monkeypatch.setattr(numba.config, "CPU_FEATURES", "")
    plain = jit.cache_folder(SOURCES)
    assert set(root.iterdir()) == {mine, others, elsewhere, plain}
    assert len({mine, others, elsewhere, plain}) == 4


def test_a_new_folder_takes_away_those_unused_for_a_month(root):
    old = left_alone(jit.cache_folder(SOURCES), days=31)
    young = left_alone(jit.cache_folder(OTHERS), days=29)
    new = jit.cache_folder(64 * "c")
    assert set(root.iterdir()) == {young, new}
    assert not old.exists()
    assert (young / "code.kernel").exists()
    # a folder in use is not unused
    folder = left_alone(jit.cache_folder(SOURCES), days=31)
    assert jit.cache_folder(SOURCES) == folder
    jit.cache_folder(OTHERS)
    assert (folder / "code.kernel").exists()


def test_what_is_not_ours_stays(root, tmp_path):
    root.mkdir()
    (tmp_path / "elsewhere").mkdir()
    for name in ("numba", "kernels-0123", "kernels-" + 16 * "g", "kernels"):
        (root / name).mkdir()
    (root / f"kernels-{16 * 'a'}").write_text("a file")
    (root / f"kernels-{16 * 'b'}").symlink_to(tmp_path / "elsewhere")
    there = set(root.iterdir())
    for path in there:
        os.utime(path, (0, 0))
    new = jit.cache_folder(64 * "c")
    assert set(root.iterdir()) == there | {new}
    assert (tmp_path / "elsewhere").exists()


def test_what_an_interrupted_clean_up_left_goes_with_the_next(root):
    root.mkdir()
    half = root / f"kernels-{16 * 'a'}-{8 * 'b'}.{32 * 'c'}"
    half.mkdir()
    left_alone(half, days=31)
    new = jit.cache_folder(SOURCES)
    assert list(root.iterdir()) == [new]


def test_a_folder_that_cannot_go_is_no_hindrance(root, monkeypatch):
    old = left_alone(jit.cache_folder(SOURCES), days=31)

    def refuse(self, target):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "rename", refuse)
    assert jit.cache_folder(OTHERS).is_dir()
    assert old.exists()


def test_where_nothing_can_be_kept_a_word_says_so(tmp_path, monkeypatch, caplog):
    (tmp_path / "file").touch()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    assert jit.cache_folder(SOURCES) is None
    (message,) = caplog.messages
    assert str(tmp_path / "file") in message
    assert "NUMBA_CACHE_DIR" in message


def test_a_full_disk_is_no_place(root, monkeypatch, caplog):
    def full(**_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(jit.tempfile, "TemporaryFile", full)
    assert jit.cache_folder(SOURCES) is None
    assert "No space left on device" in caplog.text
