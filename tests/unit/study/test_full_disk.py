"""Files whole or not at all, and words for a disk that is full."""

import os
import subprocess

import numpy as np
import pytest
import xarray as xr

from impactlab.files import read_netcdf, write_netcdf
from impactlab.study.store import OutputSpec, Shards


def noise(size):
    return xr.Dataset({"a": ("run", np.random.default_rng(1).uniform(size=size))})


def test_unreadable_files_are_named(tmp_path):
    (tmp_path / "x.nc").write_text("no such thing")
    with pytest.raises(OSError, match=r"x\.nc: cannot be read as netCDF"):
        read_netcdf(tmp_path / "x.nc", "runs")
    (tmp_path / "x.yaml").write_text("title: X")
    with pytest.raises(OSError, match=r"x\.yaml: is a study file: name its results, such as"):
        read_netcdf(tmp_path / "x.yaml", "runs")


def test_a_failed_write_leaves_the_old_file_and_no_rubbish(tmp_path):
    path = tmp_path / "runs.nc"
    write_netcdf(xr.Dataset({"a": 1.0}), path, "runs")
    with pytest.raises((TypeError, ValueError)):
        write_netcdf(xr.Dataset({"a": ((), object())}), path, "runs")
    assert read_netcdf(path, "runs")["a"].item() == 1.0
    assert [entry.name for entry in tmp_path.iterdir()] == ["runs.nc"]


def test_what_is_synced_is_open_for_writing(tmp_path, monkeypatch):
    """Windows refuses to sync a file that may only be read."""
    synced = []
    monkeypatch.setattr(os, "fsync", lambda file: synced.append(os.write(file, b"")))
    write_netcdf(noise(10), tmp_path / "x.nc", "runs")
    assert synced == [0]


@pytest.fixture
def tiny_disk(tmp_path):
    """A file system of 1 MB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(folder)]
    if subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("mounting is not permitted here")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


def test_a_full_disk_is_told_and_the_older_file_stays(tiny_disk):
    write_netcdf(noise(1000), tiny_disk / "x.nc", "runs")
    with pytest.raises(OSError, match=r"x\.nc: could not be written .* are free .* needed"):
        write_netcdf(noise(1_000_000), tiny_disk / "x.nc", "runs")
    assert read_netcdf(tiny_disk / "x.nc", "runs").equals(noise(1000))
    assert [path.name for path in tiny_disk.iterdir()] == ["x.nc"]


def test_a_shard_on_a_full_disk_is_told_and_the_others_stay(tiny_disk):
    shards = Shards(tiny_disk, OutputSpec(0, False), "version")
    keys = np.array([bytes([at]) * 16 for at in range(200)], dtype="S16")
    shards.write(keys[:2], {"status": np.zeros(2)})
    with pytest.raises(OSError, match=r"\.npz: could not be written .* are free .* needed"):
        shards.write(keys, {"contact_force": np.zeros((200, 1000))})
    (kept,) = Shards(tiny_disk, OutputSpec(0, False), "version").recover()
    assert kept.tobytes() == keys[:2].tobytes()
