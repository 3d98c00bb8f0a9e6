"""Status and remarks in sentences."""

import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab.solver import outputs


def runs(status, remarks):
    """Runs with these bits, of two responses."""
    values = {
        "peak_force": np.ones(np.shape(status)),
        "rebound_velocity": np.ones(np.shape(status)),
    }
    values |= {"status": np.array(status), "remarks": np.array(remarks)}
    return xr.Dataset({name: (("run",)[: value.ndim], value) for name, value in values.items()})


def test_one_run():
    bits = outputs.SPHERE_NOT_LEAVING | outputs.OUTSIDE_CONTACT_LAW
    missing, mark, remark = il.explain(runs(bits, outputs.ROUND_TOP))
    assert missing == (
        "Missing because the duration ends before the sphere moves upwards and away from the beam: "
        "rebound_velocity."
    )
    assert mark.startswith("The largest indentation is beyond the range of the contact law")
    assert remark.startswith("The beam is round where the sphere strikes")


def test_many_runs_are_counted():
    diverged, round_top = il.explain(
        runs([0, outputs.DIVERGED, 0], [outputs.ROUND_TOP, 0, outputs.ROUND_TOP])
    )
    assert diverged == "1 of 3 runs: the run diverged; every response is missing."
    assert round_top.startswith("2 of 3 runs: the beam is round")


def test_nothing_to_say():
    assert il.explain(runs([0, 0], [0, 0])) == []


def test_an_analysis_is_refused():
    with pytest.raises(ValueError, match=r"explain: the dataset has no `status`: take the runs"):
        il.explain(xr.Dataset({"total_order": 1.0}))
