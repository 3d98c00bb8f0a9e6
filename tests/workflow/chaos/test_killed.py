"""kill -9 at drawn moments: nothing that was on disk is solved again, and no bit differs."""

import random
import shutil
import signal
import time

import pytest
from chaos import RUNS, SMALL, assert_same_bits, keys_on_disk, resumed, run, solved_before, stored

pytestmark = pytest.mark.chaos

KILLS = 10
SOLVING = 2.5
"""Seconds that all runs take, about."""
AROUND = 1.0
"""Seconds that a command takes beside, before its first batch and after its last."""


def disturbed(folder, moments):
    """Return whether the study was killed at a drawn moment of its remaining work."""
    before = len(keys_on_disk(folder))
    command = run(folder, "--workers", "1", *SMALL)
    command.wait_until_it_solves()
    time.sleep(moments.uniform(0, AROUND + SOLVING * (1 - before / RUNS)))
    command.send(signal.SIGKILL)
    code = command.end()
    assert code in (0, -signal.SIGKILL), command.said
    assert solved_before(command.said) == before
    return code != 0


def test_killed_studies_go_on(folder, undisturbed):
    """A study that ends before its moment is checked, and begun anew."""
    moments = random.Random(0)
    kills = 0
    while kills < KILLS:
        if disturbed(folder, moments):
            kills += 1
        else:
            assert_same_bits(stored(folder), undisturbed)
            shutil.rmtree(folder / "results")
    before = len(keys_on_disk(folder))
    runs, said = resumed(folder, "--workers", "1")
    assert solved_before(said) == before
    assert_same_bits(runs, undisturbed)
