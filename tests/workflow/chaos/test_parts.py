"""Forty parts as processes: some killed, some doubled, one lost; same bits, and no run twice."""

import random
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from chaos import PATIENCE, RUNS, assert_same_bits, complaint, keys_in, stored

pytestmark = pytest.mark.chaos

PARTS = 40
AT_ONCE = 4
KILLED = 10
TWICE = (7, 23)
LOST = 31
BEFORE_THE_END = 3.0
"""Seconds that a part takes at least, most of them to begin."""


def part(folder, number):
    command = ["run", "studies/tough.yaml", "--part", f"{number}/{PARTS}", "--workers", "1"]
    return subprocess.Popen(
        [sys.executable, "-m", "impactlab", *command],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def merged(folder):
    """Return exit code and output of `impactlab merge`."""
    done = subprocess.run(
        [sys.executable, "-m", "impactlab", "merge", "studies/tough.yaml"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    return done.returncode, done.stdout + done.stderr


def solve(folder, numbers, moments=None, victims=()):
    """Solve parts, a few at a time; victims: those that are killed at drawn moments."""
    waiting, running = list(numbers), []
    deadline = time.monotonic() + 40 * PATIENCE
    while waiting or running:
        assert time.monotonic() < deadline
        while waiting and len(running) < AT_ONCE:
            number = waiting.pop(0)
            until = None
            if number in victims:
                until = time.monotonic() + moments.uniform(0, BEFORE_THE_END)
            running.append((part(folder, number), until))
        for process, until in running:
            if until and time.monotonic() > until and process.poll() is None:
                process.send_signal(signal.SIGKILL)
        for process, until in running:
            if (code := process.poll()) is not None:
                assert code == 0 or (until and code == -signal.SIGKILL)
        running = [entry for entry in running if entry[0].poll() is None]
        time.sleep(0.02)


def blocks(folder):
    return sorted((folder / "results" / "tough" / "parts").glob("*/*.npz"))


def numbers_of(message):
    """Return the parts that a message names as an array of Slurm's."""
    (listed,) = re.findall(r"--array=([\d,-]*\d), then", message)
    ranges = [[int(end) for end in entry.split("-")] for entry in listed.split(",")]
    return [number for ends in ranges for number in range(ends[0], ends[-1] + 1)]


def test_forty_parts(folder, undisturbed):
    moments = random.Random(1)
    victims = moments.sample(sorted({*range(1, PARTS + 1)} - {*TWICE, LOST}), KILLED)
    order = moments.sample(range(1, PARTS + 1), PARTS)
    for number in TWICE:  # one after the other, so at the same time
        order.insert(order.index(number), number)
    solve(folder, order, moments, victims)
    first = RUNS * (LOST - 1) // PARTS
    (lost,) = [path for path in blocks(folder) if path.name.startswith(f"{first}-")]
    lost.unlink()
    code, said = merged(folder)
    assert code == 1
    missing = numbers_of(complaint(said))
    assert LOST in missing
    assert {*missing} <= {LOST, *victims}
    solve(folder, missing)
    code, said = merged(folder)
    assert code == 0, said
    assert_same_bits(stored(folder), undisturbed)
    sizes = [len(keys_in(path)) for path in blocks(folder)]
    assert sum(sizes) == RUNS
    assert len(set().union(*map(keys_in, blocks(folder)))) == RUNS


def test_one_part_several_times_at_once(folder):
    """All of them write the same file, and any of them may be the last."""
    together = [part(folder, 1) for _ in range(AT_ONCE)]
    assert {process.wait(PATIENCE) for process in together} == {0}
    (path,) = blocks(folder)
    assert len(keys_in(path)) == RUNS // PARTS
    assert [*path.parent.iterdir()] == [path]  # no unfinished file
    with np.load(path) as block:
        assert {block[name].shape[0] for name in block.files} == {RUNS // PARTS}
