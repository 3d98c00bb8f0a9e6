"""A dask cluster of separate processes, as started by hand from a shell."""

import json
import os
import subprocess
import sys
import time

from distributed import Client

SOON = {"DASK_DISTRIBUTED__COMM__TIMEOUTS__TCP": "12s"}
"""Give up a silent connection after 12 s, not 30 s; dask allows no less than 11 s."""


class Cluster:
    """`dask scheduler` and `dask worker`s; ended at the end of a `with`."""

    def __init__(self, folder, host="127.0.0.1", protocol="tcp", **env):
        self._folder, self._env = folder, os.environ | env
        self.workers = []
        file = folder / "scheduler.json"
        options = ("--host", host, "--port", "0", "--protocol", protocol, "--no-dashboard")
        self.scheduler = self._started("scheduler", *options, "--scheduler-file", file)
        deadline = time.monotonic() + 60
        while not (file.exists() and file.read_text()):
            assert time.monotonic() < deadline, self.said
            time.sleep(0.05)
        self.address = json.loads(file.read_text())["address"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait(timeout=30)

    @property
    def said(self):
        return (self._folder / "cluster.txt").read_text()

    def add(self, number=1, inside=()):
        """Start workers of one thread each; inside: a command that wraps theirs."""
        options = (self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard")
        here = ("--local-directory", self._folder)
        for _ in range(number):
            self.workers.append(self._started("worker", *options, *here, inside=inside))

    def wait_for(self, workers):
        """Wait for this number of workers."""
        with Client(self.address, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=60)

    def _started(self, what, *options, inside=()):
        command = [*inside, sys.executable, "-m", "dask", what, *map(str, options)]
        with (self._folder / "cluster.txt").open("a") as said:
            return subprocess.Popen(command, env=self._env, stdout=said, stderr=said)
