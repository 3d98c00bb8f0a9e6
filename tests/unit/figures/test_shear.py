"""The figure of what shear and rotary inertia change."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from impactlab.figures.catalogue import CATALOGUE
from impactlab.model.paper import paper_impact
from impactlab.verification.solutions.shear import impact_share

NONE = xr.Dataset()
FIGURE = CATALOGUE["shear"]
DEPTHS = np.array([0.01, 0.02, 0.04, 0.08])


def _curve(ax, label):
    (line,) = (line for line in ax.lines if line.get_label() == label)
    return np.asarray(line.get_xdata()), np.asarray(line.get_ydata())


def test_changes_in_per_cent_against_depth_over_span(shear_study):
    axes = FIGURE.plot(*shear_study).axes
    for ax, change in zip(axes[:2], (-30.0 * DEPTHS, 240.0 * DEPTHS), strict=True):
        x, y = _curve(ax, "5 m/s")
        assert x == pytest.approx(DEPTHS / 0.78)
        assert y == pytest.approx(change)


def test_below_the_same_against_the_share_of_the_contact_without_shear(shear_study):
    runs, _ = shear_study
    x, y = _curve(FIGURE.plot(runs, NONE).axes[2], "0.25 m/s")
    durations = runs["contact_duration"].sel(velocity=0.25, beam_model="euler_bernoulli").values
    beams = [replace(paper_impact().beam, depth=depth) for depth in DEPTHS.tolist()]
    shares = [impact_share(beam, time) for beam, time in zip(beams, durations, strict=True)]
    assert x == pytest.approx(100.0 * np.array(shares))
    assert y == pytest.approx(-30.0 * DEPTHS)


def test_the_caption_says_by_the_data_when_shear_matters(shear_study):
    runs, _ = shear_study
    text = FIGURE.caption(runs, NONE)
    assert "peak force changes by −2.4 to −0.3 %, by 1 % or more in 4 of 8 impacts" in text
    assert "(depth over span 0.051 to 0.1)" in text
    assert "contact duration changes by 2.4 to 19 %, by 1 % or more in 8 of 8 impacts" in text


def test_a_failed_run_leaves_a_gap_and_is_counted(shear_study, failing):
    runs = failing(shear_study[0], {"velocity": 1, "beam_depth": 2, "beam_model": 0})
    _, y = _curve(FIGURE.plot(runs, NONE).axes[0], "5 m/s")
    assert np.isnan(y).tolist() == [False, False, True, False]
    assert "in 3 of 7 impacts" in FIGURE.caption(runs, NONE)
    assert "1 of 16 runs is missing" in FIGURE.caption(runs, NONE)


def test_it_needs_three_depths_and_both_models_of_yielding_fibres(shear_study):
    runs, _ = shear_study
    assert FIGURE.applies(runs, NONE)
    assert not FIGURE.applies(runs.isel(beam_depth=slice(2)), NONE)
    assert not FIGURE.applies(runs.isel(beam_model=[1]), NONE)
    elastic = runs.assign_coords(beam_model=["elastic", "timoshenko"])
    assert not FIGURE.applies(elastic, NONE)
    assert not FIGURE.applies(runs.drop_vars("contact_duration"), NONE)
