"""Ctrl-C at drawn moments: workers end, the bar closes, one line says how to go on."""

import os
import pty
import random
import signal
import sys
import time

import psutil
import pytest
from chaos import SMALL, assert_same_bits, keys_on_disk, resumed, run, shards, solved_before

pytestmark = pytest.mark.chaos

HIDE_CURSOR, SHOW_CURSOR = "\x1b[?25l", "\x1b[?25h"


def gone(processes):
    _, alive = psutil.wait_procs(processes, timeout=10)
    return not alive


def interrupted(folder, at_work, moments, to_all, *engine):
    """Return the messages of a study interrupted at a drawn moment, as it starts or at work."""
    begun = len(shards(folder))
    command = run(folder, "--workers", "2", *engine, *SMALL)
    command.wait_until_it_solves()
    if at_work:
        command.wait_for_shards(begun + 1)
    time.sleep(moments.uniform(0, 0.1))
    workers = command.others()
    (os.killpg if to_all else os.kill)(command.process.pid, signal.SIGINT)
    assert command.end() == 130, command.said
    assert gone(workers), f"still there: {workers}"
    assert gone(command.others())  # multiprocessing's tracker outlives the workers for a moment
    return command.said


@pytest.mark.parametrize(
    ("engine", "to_all"),
    [((), False), (("--processes",), False), (("--processes",), True)],
    ids=["threads", "processes", "processes as a group"],
)
def test_interrupted_studies_go_on(folder, engine, to_all, undisturbed):
    moments = random.Random(f"{engine} {to_all}")
    before = 0
    for at_work in (False, True):
        *log, last = interrupted(folder, at_work, moments, to_all, *engine).splitlines()
        assert "the same command goes on from here" in last
        assert all(line.startswith("INFO: ") for line in log)  # nothing of what was broken off
        assert solved_before(" ".join(log)) == before
        before = len(keys_on_disk(folder))
    runs, said = resumed(folder)
    assert solved_before(said) == before
    assert_same_bits(runs, undisturbed)


@pytest.mark.parametrize("moment", [0.2, 0.6])
def test_interrupted_before_it_solves(folder, moment):
    command = run(folder)
    time.sleep(moment)
    command.send(signal.SIGINT)
    assert command.end() == 130, command.said
    assert "Traceback" not in command.said
    assert "interrupted" in command.said


def test_the_bar_closes(folder):
    """On a terminal: the cursor, hidden by the bar, is there again."""
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(folder)
        command = [sys.executable, "-m", "impactlab", "run", "studies/tough.yaml", *SMALL]
        os.execv(sys.executable, command)
    said = b""
    while HIDE_CURSOR.encode() not in said:
        said += os.read(terminal, 1000)
    time.sleep(0.2)
    os.write(terminal, b"\x03")
    said += b"".join(iter(lambda: _rest(terminal), b""))
    _, status = os.waitpid(pid, 0)
    assert os.waitstatus_to_exitcode(status) == 130
    assert SHOW_CURSOR in said.decode().split(HIDE_CURSOR)[-1]
    assert said.decode().rstrip().endswith("the same command goes on from here")


def _rest(terminal):
    try:
        return os.read(terminal, 1000)
    except OSError:  # the other end is closed
        return b""
