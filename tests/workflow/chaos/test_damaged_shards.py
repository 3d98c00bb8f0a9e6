"""Truncated, flipped, swapped and foreign shards: found, named, solved again, never merged."""

import random
import shutil
import signal

import pytest
from chaos import (
    SMALL,
    STUDY,
    assert_same_bits,
    keys_in,
    keys_on_disk,
    new_study,
    resumed,
    run,
    shards,
    solved_before,
)

pytestmark = pytest.mark.chaos

SOME = 12
"""Shards on disk, at least, when they are damaged."""


@pytest.fixture(scope="module")
def half_done(tmp_path_factory):
    """A study of which some shards are on disk."""
    folder = new_study(tmp_path_factory.mktemp("half_done"))
    broken_off(folder)
    return folder


@pytest.fixture(scope="module")
def foreign(tmp_path_factory):
    """A sound shard of other runs of the same form."""
    other = STUDY.replace("start: 0.5", "start: 0.6")
    folder = new_study(tmp_path_factory.mktemp("foreign"), other)
    broken_off(folder)
    return shards(folder)[0]


def broken_off(folder):
    command = run(folder, "--workers", "1", *SMALL)
    command.wait_for_shards(SOME)
    command.send(signal.SIGKILL)
    command.end()


def truncate(paths, foreign, drawn):
    whole = paths[0].read_bytes()
    paths[0].write_bytes(whole[: drawn.randrange(len(whole))])
    return paths[:1]


def empty(paths, foreign, drawn):
    paths[0].write_bytes(b"")
    return paths[:1]


def garbage(paths, foreign, drawn):
    paths[0].write_bytes(drawn.randbytes(30_000))
    return paths[:1]


def swap(paths, foreign, drawn):
    first, second = paths[0].read_bytes(), paths[1].read_bytes()
    paths[0].write_bytes(second)
    paths[1].write_bytes(first)
    return paths[:2]


def take_anothers_place(paths, foreign, drawn):
    shutil.copy(foreign, paths[0])
    return paths[:1]


def be_a_folder(paths, foreign, drawn):
    paths[0].unlink()
    paths[0].mkdir()
    return paths[:1]


DAMAGES = [truncate, empty, garbage, swap, take_anothers_place, be_a_folder]


def test_damaged_shards_are_solved_again(tmp_path, half_done, foreign, undisturbed):
    """Every damage, each to shards of its own; a foreign shard does no harm under its own name."""
    folder, drawn = shutil.copytree(half_done, tmp_path / "copy"), random.Random(0)
    before, paths, damaged = keys_on_disk(folder), shards(folder), []
    for damage in DAMAGES:
        damaged += damage(paths[len(damaged) :], foreign, drawn)
    shutil.copy(foreign, paths[0].parent)
    lost = {key for path in damaged for key in keys_in(half_done / path.relative_to(folder))}
    runs, said = resumed(folder, "--workers", "1")
    assert solved_before(said) == len(before - lost) > 0
    assert all(path.name in said for path in damaged)
    assert_same_bits(runs, undisturbed)
    runs, said = resumed(folder, "--workers", "1")
    assert solved_before(said) == len(runs["velocity"]) * len(runs["nodes"])
    assert "damaged" not in said  # it was put right, once and for all


def test_flipped_bits_change_no_answer(tmp_path, half_done, undisturbed):
    """A bit in every shard: wherever it is, the file is as good as before or solved again."""
    drawn = random.Random(6)
    folder = shutil.copytree(half_done, tmp_path / "copy")
    before = len(keys_on_disk(folder))
    for path in shards(folder):
        flip(path, drawn)
    runs, said = resumed(folder, "--workers", "1")
    assert solved_before(said) < before
    assert "damaged" in said
    assert_same_bits(runs, undisturbed)


def flip(path, drawn):
    content = bytearray(path.read_bytes())
    content[drawn.randrange(len(content))] ^= 1 << drawn.randrange(8)
    path.write_bytes(content)
