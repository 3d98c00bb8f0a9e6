"""Folders that cannot be written to: one clear line."""

import os
import shutil
import subprocess
from contextlib import contextmanager
from pathlib import Path

import pytest
from chaos import complaint, run

pytestmark = pytest.mark.chaos


ROOT = Path(__file__).parents[3]


@contextmanager
def read_only(place):
    """Let nobody write to a folder, not even root."""
    if os.geteuid() != 0:
        place.chmod(0o555)
        yield
        place.chmod(0o755)
        return
    mounts = ["mount", "--bind", place, place], ["mount", "-o", "remount,bind,ro", place]
    if any(subprocess.run(mount, capture_output=True).returncode != 0 for mount in mounts):
        pytest.skip("root can write everywhere where mounting is not allowed")
    yield
    subprocess.run(["umount", "--lazy", place], check=True)


@pytest.fixture
def results(folder):
    """The folder of results, which nobody can write to."""
    results = folder / "results"
    results.mkdir()
    with read_only(results):
        yield results


def test_a_checkout_that_cannot_be_written(tmp_path):
    """It ends before it installs anything, and names the folder and the remedy."""
    checkout = tmp_path / "checkout"
    checkout.mkdir()
    shutil.copy(ROOT / "Makefile", checkout)
    # apart from a make that runs the tests
    env = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
    with read_only(checkout):
        command = subprocess.run(
            ["make", "study"], cwd=checkout, env=env, capture_output=True, text=True
        )
    assert command.returncode == 2
    problem, remedy = command.stdout.splitlines()
    assert problem.startswith(f"You cannot write to {checkout}")
    assert f"git clone {checkout}" in remedy
    assert command.stderr.count("\n") == 1


def test_results_that_cannot_be_written(folder, results):
    """It ends before it solves, and names the folder and the remedy."""
    command = run(folder)
    assert command.end() == 1, command.said
    line = complaint(command.said)
    assert str(results / "tough") in line
    assert "run it in a folder that you may write to" in line
    assert "solved before" not in command.said
