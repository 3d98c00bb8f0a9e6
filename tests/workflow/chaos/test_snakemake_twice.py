"""Snakemake killed, and started while its job goes on: one clear line, the same bits in the end."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from chaos import PATIENCE, assert_same_bits, keys_on_disk, solved_before, stored

pytestmark = pytest.mark.chaos

ROOT = Path(__file__).parents[3]


@pytest.fixture
def project(folder):
    """The study with the workflow."""
    shutil.copytree(ROOT / "workflow", folder / "workflow")
    for name in ("Snakefile", "environment.yaml"):
        shutil.copy(ROOT / name, folder)
    return folder


class Snakemake:
    """Snakemake on the runs of the study, and what it prints."""

    def __init__(self, folder, name, *args):
        self.output = folder / name
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        command = [sys.executable, "-m", "snakemake", "--cores", "1", "--rerun-incomplete"]
        with self.output.open("w") as output:
            self.process = subprocess.Popen(
                [*command, *args, "results/tough/runs.nc"],
                cwd=folder,
                env=os.environ | {"PATH": path},
                stdout=output,
                stderr=output,
                start_new_session=True,
            )

    def wait_until_it_solves(self):
        deadline = time.monotonic() + PATIENCE
        while "solved before" not in self.printed:
            assert self.process.poll() is None, self.printed
            assert time.monotonic() < deadline
            time.sleep(0.01)

    def send(self, how):
        """Send a signal to it and its job."""
        os.killpg(self.process.pid, how)

    def end(self):
        return self.process.wait(timeout=PATIENCE)

    @property
    def printed(self):
        return self.output.read_text()


def unlock(project):
    """Unlock the folder, as a second Snakemake says."""
    locked = Snakemake(project, "locked.txt")
    assert locked.end() == 1
    assert "cannot be locked" in locked.printed
    assert "--unlock" in locked.printed
    assert "Traceback" not in locked.printed
    assert Snakemake(project, "unlocked.txt", "--unlock").end() == 0


def test_killed_before_and_with_its_job(project, undisturbed):
    """While the job goes on, the same command says that it is at work; then it goes on from it."""
    first = Snakemake(project, "first.txt")
    first.wait_until_it_solves()
    first.send(signal.SIGSTOP)
    first.process.kill()
    first.end()
    unlock(project)
    second = Snakemake(project, "second.txt")
    assert second.end() == 1
    assert "at work" in second.printed
    assert "Traceback" not in second.printed
    first.send(signal.SIGKILL)
    before = len(keys_on_disk(project))
    last = Snakemake(project, "last.txt")
    assert last.end() == 0, last.printed
    assert solved_before(last.printed) == before
    assert_same_bits(stored(project), undisturbed)
