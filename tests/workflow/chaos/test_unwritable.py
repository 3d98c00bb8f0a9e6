"""Folders that cannot be written to: one clear line, and the same bits without kept kernels."""

import os
import subprocess

import pytest
from chaos import assert_same_bits, complaint, run, stored

pytestmark = pytest.mark.chaos


@pytest.fixture
def results(folder):
    """The folder of results, which nobody can write to, not even root."""
    results = folder / "results"
    results.mkdir()
    if os.geteuid() != 0:
        results.chmod(0o555)
        yield results
        results.chmod(0o755)
        return
    mount = ["mount", "-t", "tmpfs", "-o", "ro", "tmpfs", str(results)]
    if subprocess.run(mount, capture_output=True).returncode != 0:
        pytest.skip("root can write everywhere where mounting is not allowed")
    yield results
    subprocess.run(["umount", "--lazy", str(results)], check=True)


def test_results_that_cannot_be_written(folder, results):
    """It ends before it solves, and names the folder and the remedy."""
    command = run(folder)
    assert command.end() == 1, command.said
    line = complaint(command.said)
    assert str(results / "tough") in line
    assert "run it in a folder that you may write to" in line
    assert "solved before" not in command.said


def test_no_folder_for_kernels(folder, undisturbed, monkeypatch):
    """Each process compiles its own, says so, and has the same bits."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    nowhere = {"HOME": "/proc/nowhere", "XDG_CACHE_HOME": "/proc/nowhere"}
    command = run(folder, "--workers", "1", **nowhere)
    assert command.end() == 0, command.said
    assert "NUMBA_CACHE_DIR may name another folder" in command.said
    assert_same_bits(stored(folder), undisturbed)
