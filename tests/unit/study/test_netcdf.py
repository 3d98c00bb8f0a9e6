"""Datasets on disk: all of a file or none of it."""

import pytest
import xarray as xr

from impactlab.study.netcdf import read_netcdf, write_netcdf


def test_failed_write_leaves_the_old_file_and_no_rubbish(tmp_path):
    path = tmp_path / "runs.nc"
    write_netcdf(xr.Dataset({"a": 1.0}), path)
    with pytest.raises((TypeError, ValueError)):
        write_netcdf(xr.Dataset({"a": ((), object())}), path)
    assert read_netcdf(path)["a"].item() == 1.0
    assert [entry.name for entry in tmp_path.iterdir()] == ["runs.nc"]
