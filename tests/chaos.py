"""A short study, the command line in separate processes, and helpers to inspect the disk."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np
import psutil
import xarray as xr
from command_line import done

STUDY = """
title: Tough
impact: {base: paper}
discretisation: {points: 5}
duration: 8 ms
sampling:
  method: grid
  parameters:
    velocity: {start: 0.5, stop: 10, number: 160}
    nodes: [101, 121, 141]
store: {histories: true, samples: 50}
"""
RUNS = 480
SMALL = ("--batch-seconds", "0.03")
"""About eighty batches."""
PATIENCE = 120.0
"""Seconds to wait before a test counts as stuck."""


class Command:
    """A running `impactlab ...` in a session of its own, and its output."""

    def __init__(self, *args, cwd, **env):
        self.said_to = Path(cwd) / "said.txt"
        # a shell starts its background jobs deaf to Ctrl-C, and these tests may run in one
        hear = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
        with self.said_to.open("w") as said:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "impactlab", *map(str, args)],
                cwd=cwd,
                env=os.environ | env,
                stdin=subprocess.DEVNULL,
                stdout=said,
                stderr=said,
                start_new_session=True,
                preexec_fn=hear,
            )

    @property
    def said(self):
        return self.said_to.read_text()

    @property
    def ended(self):
        return self.process.poll() is not None

    def wait_until(self, true):
        """Wait for a condition or for the command to end."""
        deadline = time.monotonic() + PATIENCE
        while not (self.ended or true()):
            assert time.monotonic() < deadline, f"stuck: {self.said}"
            time.sleep(0.005)

    def pause(self):
        """Wait a moment, or less if the command ends."""
        with suppress(subprocess.TimeoutExpired):
            self.process.wait(timeout=0.2)

    def wait_until_it_solves(self):
        self.wait_until(lambda: "solved before" in self.said)

    def wait_for_shards(self, number):
        folder = self.said_to.parent
        self.wait_until(lambda: len(shards(folder)) >= number)

    def send(self, how):
        if not self.ended:
            os.kill(self.process.pid, how)

    def end(self):
        """Wait for the command and return its exit code."""
        return self.process.wait(timeout=PATIENCE)

    def others(self):
        """Return the live processes of its session except itself."""
        return [
            process
            for process in psutil.process_iter(["pid", "status"])
            if process.pid != self.process.pid
            and _session(process.pid) == self.process.pid
            and process.info["status"] != psutil.STATUS_ZOMBIE
        ]

    def workers(self):
        """Return its worker processes, which solve the runs."""
        return [process for process in self.others() if "spawn_main" in _line(process)]


def _session(pid):
    try:
        return os.getsid(pid)
    except ProcessLookupError:
        return None


def _line(process):
    try:
        return " ".join(process.cmdline())
    except psutil.NoSuchProcess:
        return ""


def new_study(folder, text=STUDY):
    """Write studies/tough.yaml and return the folder."""
    (folder / "studies").mkdir(parents=True, exist_ok=True)
    (folder / "studies" / "tough.yaml").write_text(text)
    return folder


def run(folder, *args, **env):
    """Start `impactlab run` on the study of a folder."""
    return Command("run", "studies/tough.yaml", *args, cwd=folder, **env)


def resumed(folder, *args):
    """Return runs.nc and the log of a last, undisturbed `impactlab run`, in this process."""
    said = done("run", "studies/tough.yaml", *args, cwd=folder).stderr
    return stored(folder), said


def stored(folder):
    return xr.load_dataset(folder / "results" / "tough" / "runs.nc")


def shards(folder):
    """Return the files of finished batches."""
    return sorted((folder / "results" / "tough" / "shards").glob("*/*.npz"))


def keys_on_disk(folder):
    """Return the key of every run that is in a shard."""
    return {key for path in shards(folder) for key in keys_in(path)}


def keys_in(path):
    """Return the key of every run in one shard, read without impactlab."""
    with np.load(path) as shard:
        return {key.tobytes() for key in shard["run key"]}


def solved_before(said):
    """Return the number of runs that a command found on disk, from its output."""
    return int(said.split(" of them solved before")[0].split()[-1])


def complaint(said):
    """Return the error message of a command: one line after its log, without a traceback."""
    assert "Traceback" not in said, said
    (line,) = [line for line in said.splitlines() if line.startswith("ERROR: ")]
    return line


def assert_same_bits(ours, theirs):
    """Compare every variable and coordinate; the attributes may differ."""
    assert ours.sizes == theirs.sizes
    assert set(ours.variables) == set(theirs.variables)
    for name, values in theirs.variables.items():
        mine = ours.variables[name]
        assert mine.dims == values.dims
        assert mine.dtype == values.dtype
        assert mine.values.tobytes() == values.values.tobytes(), name
