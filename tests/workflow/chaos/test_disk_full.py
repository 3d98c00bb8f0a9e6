"""A disk that fills up: one clear line, what was on disk stays, and it goes on with room."""

import os
import shutil
import subprocess

import pytest
from chaos import (
    SMALL,
    assert_same_bits,
    complaint,
    keys_on_disk,
    new_study,
    resumed,
    run,
    solved_before,
    stored,
)
from command_line import called, done

pytestmark = pytest.mark.chaos

BALLAST = "ballast"


@pytest.fixture
def small_disk(folder):
    """The study, with results/ on a disk of its own of 32 MiB."""
    results = folder / "results"
    results.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=32m", "tmpfs", str(results)]
    if os.geteuid() != 0 or subprocess.run(mount, capture_output=True).returncode != 0:
        pytest.skip("a small disk can only be mounted by root, where mounting is allowed")
    yield folder
    subprocess.run(["umount", "--lazy", str(results)], check=True)


def fill(folder, left):
    """Leave that many bytes."""
    results = folder / "results"
    size = shutil.disk_usage(results).free - left
    (results / BALLAST).write_bytes(bytes(size))


def make_room(folder):
    (folder / "results" / BALLAST).unlink()


def forced(folder, *options):
    """A study that is told beforehand to need more room than there is, started all the same."""
    return run(folder, "--force", *options)


def complains(command, *words):
    """Assert that it ends in one line with these words."""
    assert command.end() == 1, command.said
    said = complaint(command.said)
    for word in words:
        assert word in said, said


@pytest.mark.parametrize("left", [50_000, 600_000])
def test_while_shards_are_written(small_disk, left, undisturbed):
    fill(small_disk, left)
    complains(forced(small_disk, "--workers", "2", *SMALL), "shards", "free")
    before = len(keys_on_disk(small_disk))  # reads every shard: all are whole
    assert before > 0 or left < 100_000
    make_room(small_disk)
    runs, said = resumed(small_disk)
    assert solved_before(said) == before
    assert_same_bits(runs, undisturbed)
    assert not list((small_disk / "results" / "tough").glob("**/.*.nc.*"))


def test_while_shards_are_merged(small_disk, undisturbed):
    """Room for every shard, and none for a second copy of all."""
    fill(small_disk, 1_300_000)
    complains(forced(small_disk, "--workers", "1", *SMALL), "free")
    before = len(keys_on_disk(small_disk))
    make_room(small_disk)
    runs, said = resumed(small_disk)
    assert solved_before(said) == before
    assert_same_bits(runs, undisturbed)


def test_while_the_runs_are_written(small_disk, undisturbed):
    """An older file stays."""
    resumed(small_disk)
    fill(small_disk, 20_000)
    complains(forced(small_disk), "runs.nc", "free")
    assert_same_bits(stored(small_disk), undisturbed)


FEW = """
title: Tough
impact: {base: paper, beam_model: rigid}
duration: 1 ms
sampling: {method: grid, parameters: {velocity: [1, 2, 3, 4]}}
responses: [peak_force]
"""
STEPS = [
    ("analyse", "runs.nc"),
    ("figures", "runs.nc", "analysis.nc"),
    ("report", "runs.nc", "analysis.nc"),
]
"""What is made of the runs, in order."""


def test_while_later_steps_are_written(small_disk):
    resumed(new_study(small_disk, FEW))
    for name, *files in STEPS:
        step = (name, *(f"results/tough/{file}" for file in files))
        fill(small_disk, 4_096)
        refused = called(*step, cwd=small_disk)
        assert refused.returncode == 1
        for word in ("tough", "free"):
            assert word in complaint(refused.stderr)
        make_room(small_disk)
        done(*step, cwd=small_disk)
