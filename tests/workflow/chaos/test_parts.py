"""Parts as processes: one killed, one tripled, one lost; same bits, and no run twice."""

import random
import re
import subprocess
import sys
import time

import numpy as np
import pytest
from chaos import PATIENCE, RUNS, assert_same_bits, complaint, keys_in, stored
from command_line import called, done

pytestmark = pytest.mark.chaos

PARTS = 4
KILLED, TRIPLED, LOST = 4, 2, 3
TO_THE_END = 3.0
"""Seconds that a part takes, most of them to begin."""
MERGE = ("merge", "studies/tough.yaml")


def part(folder, number):
    command = ["run", "studies/tough.yaml", "--part", f"{number}/{PARTS}", "--workers", "1"]
    return subprocess.Popen(
        [sys.executable, "-m", "impactlab", *command],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def blocks(folder):
    return sorted((folder / "results" / "tough" / "parts").glob("*/*.npz"))


def numbers_of(message):
    """Return the parts that a message names as an array of Slurm's."""
    (listed,) = re.findall(r"--array=([\d,-]*\d), then", message)
    ranges = [[int(end) for end in entry.split("-")] for entry in listed.split(",")]
    return [number for ends in ranges for number in range(ends[0], ends[-1] + 1)]


def test_parts_that_are_killed_tripled_and_lost(folder, undisturbed):
    together = [part(folder, number) for number in (1, TRIPLED, TRIPLED, TRIPLED, LOST)]
    assert {process.wait(PATIENCE) for process in together} == {0}
    *_, lost = sound = blocks(folder)
    assert sorted(lost.parent.iterdir()) == sound  # each file once, and none that is unfinished
    for path in sound:
        with np.load(path) as block:
            assert {block[name].shape[0] for name in block.files} == {RUNS // PARTS}
    lost.unlink()
    victim = part(folder, KILLED)
    time.sleep(random.Random(1).uniform(0.5, 1.0) * TO_THE_END)
    victim.kill()
    victim.wait()
    refused = called(*MERGE, cwd=folder)
    assert refused.returncode == 1
    missing = numbers_of(complaint(refused.stderr))
    assert LOST in missing
    assert {*missing} <= {LOST, KILLED}
    for number in missing:
        assert part(folder, number).wait(PATIENCE) == 0
    done(*MERGE, cwd=folder)
    assert_same_bits(stored(folder), undisturbed)
    assert sum(len(keys_in(path)) for path in blocks(folder)) == RUNS
    assert len(set().union(*map(keys_in, blocks(folder)))) == RUNS
