"""Truncated, flipped and foreign shards: found, named, solved again, never merged."""

import random
import shutil
import signal

import pytest
from chaos import (
    RUNS,
    SMALL,
    STUDY,
    assert_same_bits,
    keys_on_disk,
    new_study,
    resumed,
    run,
    shards,
    solved_before,
)

pytestmark = pytest.mark.chaos


def broken_off(folder):
    """Return the shards of a study killed when it has solved a part."""
    command = run(folder, "--workers", "1", *SMALL)
    command.wait_for_shards(12)
    command.send(signal.SIGKILL)
    command.end()
    return shards(folder)


def flip(path, drawn):
    content = bytearray(path.read_bytes())
    content[drawn.randrange(len(content))] ^= 1 << drawn.randrange(8)
    path.write_bytes(content)


def test_damaged_shards_change_no_answer(folder, tmp_path, undisturbed):
    """A flipped bit, wherever it is, leaves a file as good as before or solved again."""
    truncated, _, *flipped = broken_off(folder)  # the second stays whole
    before, drawn = len(keys_on_disk(folder)), random.Random(6)
    truncated.write_bytes(truncated.read_bytes()[:-500])
    for path in flipped:
        flip(path, drawn)
    other = STUDY.replace("start: 0.5", "start: 0.6")
    foreign, *_ = broken_off(new_study(tmp_path / "foreign", other))
    shutil.copy(foreign, truncated.parent)
    runs, said = resumed(folder, "--workers", "1")
    assert 0 < solved_before(said) < before
    assert f"{truncated.name}" in said
    assert_same_bits(runs, undisturbed)
    _, said = resumed(folder, "--workers", "1")
    assert solved_before(said) == RUNS
    assert "damaged" not in said  # it was put right, once and for all
