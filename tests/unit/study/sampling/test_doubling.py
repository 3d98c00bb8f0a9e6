from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from impactlab.study.runs import Work
from impactlab.study.sampling.design import doubled


@pytest.mark.parametrize("second_order", [True, False])
@pytest.mark.parametrize("seed", [0, 1])
def test_runs_are_found_again_in_twice_as_many(sampled, second_order, seed):
    """By their keys, under which shards keep the answers: no run is solved twice."""
    normal = {"distribution": "normal", "mean": 0.06, "standard_deviation": 0.001}
    small = sampled(
        "sobol",
        {"beam_width": normal},
        base_samples=16,
        second_order=second_order,
        seed=seed,
        groups={"section": ["beam_depth", "beam_width"]},
    )
    large = doubled(small)
    keys, more = (Work.of(each).keys for each in (small, large))
    assert more.size == 2 * keys.size
    assert np.array_equal(more[: keys.size], keys)
    assert doubled(large).attrs["base_samples"] == 64
    changed = {key for key in large.attrs if large.attrs[key] != small.attrs[key]}
    assert changed == {"base_samples"}


def test_it_goes_on_from_a_stored_design(sampled, tmp_path):
    small = sampled("sobol", base_samples=16, seed=0)
    small.to_netcdf(tmp_path / "design.nc")
    with xr.open_dataset(tmp_path / "design.nc") as kept:
        np.testing.assert_array_equal(doubled(kept)["velocity"], doubled(small)["velocity"])


def test_a_design_drawn_in_another_way_is_refused(sampled):
    small = sampled("sobol", base_samples=16)
    other = small.assign_coords(gravity=small["gravity"] + 1e-12)
    with pytest.raises(
        ValueError, match=r"'some' was drawn by another version .*\(gravity differs"
    ):
        doubled(other)


def test_only_sobols_sample_can_be_doubled(sampled):
    with pytest.raises(ValueError, match="only a sample with method: sobol can be extended"):
        doubled(sampled("delta", samples=64))
