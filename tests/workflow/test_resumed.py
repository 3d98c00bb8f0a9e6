"""Runs solved before an interruption are kept."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
import xarray as xr
from command_line import SMALL
from command_line import done as impactlab

SLOW = SMALL.replace("[11, 21, 41]", "[201, 203, 205, 207, 209, 211]").replace("1 ms", "20 ms")


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_an_interrupted_study_goes_on(folder, how):
    (folder / "studies" / "slow.yaml").write_text(SLOW)
    command = [sys.executable, "-m", "impactlab", "run", "studies/slow.yaml", "--workers", "1"]
    # a shell starts its background jobs deaf to Ctrl-C, and these tests may run in one
    hear = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    started = subprocess.Popen(
        command, cwd=folder, stderr=subprocess.PIPE, text=True, preexec_fn=hear
    )
    shards = folder / "results" / "slow" / "shards"
    deadline = time.monotonic() + 120
    while not list(shards.glob("*/*.npz")) and time.monotonic() < deadline:
        time.sleep(0.01)
    os.kill(started.pid, how)
    _, said = started.communicate(timeout=60)
    if how == signal.SIGINT:
        assert started.returncode == 130, said
        assert "the same command goes on" in said
        assert "Traceback" not in said
    assert not (folder / "results" / "slow" / "runs.nc").exists()
    again = impactlab("run", "studies/slow.yaml", cwd=folder).stderr
    before = int(again.split(" of them solved before")[0].split()[-1])
    assert 0 < before < 18
    first = xr.load_dataset(folder / "results" / "slow" / "runs.nc")
    (folder / "results").rename(folder / "elsewhere")
    impactlab("run", "studies/slow.yaml", cwd=folder)
    fresh = xr.load_dataset(Path(folder) / "results" / "slow" / "runs.nc")
    assert fresh.drop_attrs().identical(first.drop_attrs())
