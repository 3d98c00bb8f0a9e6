"""Figures of contact laws, and of what shear changes."""

from itertools import combinations

import numpy as np
import pytest
import xarray as xr
from drawings import curve

from impactlab.figures.catalogue import CATALOGUE
from impactlab.solver.contact import LAWS

NONE = xr.Dataset()
LAWS_FIGURE, SHEAR_FIGURE = CATALOGUE["contact_laws"], CATALOGUE["shear"]
DEPTHS = np.array([0.01, 0.02, 0.04, 0.08])


def _look(line):
    return line.get_color(), line._unscaled_dash_pattern, line.get_marker()


def test_every_law_has_a_curve_of_its_own_look_in_every_panel(laws_study):
    for ax in LAWS_FIGURE.plot(*laws_study).axes:
        lines = [line for line in ax.lines if not str(line.get_label()).startswith("_")]
        assert len(lines) == len(LAWS)
        looks = [_look(line) for line in lines]
        assert all(one != other for one, other in combinations(looks, 2))
    # it needs three laws on a grid
    runs, analysis = laws_study
    assert LAWS_FIGURE.applies(runs, analysis)
    assert not LAWS_FIGURE.applies(runs.isel(contact=slice(2)), analysis)
    assert not LAWS_FIGURE.applies(runs.isel(velocity=[0]), analysis)


def test_curves_are_the_stored_values(laws_study):
    runs, _ = laws_study
    ax = LAWS_FIGURE.plot(runs, NONE).axes[1]
    (line,) = (line for line in ax.lines if line.get_label() == "Modified Jackson and Green")
    assert line.get_xdata().tolist() == [0.1, 1.0, 10.0]
    assert line.get_ydata().tolist() == runs["restitution"].sel(contact="mjg").values.tolist()
    # runs beyond a laws range are open and the caption says so
    ax = LAWS_FIGURE.plot(runs, NONE).axes[1]
    points = [line for line in ax.lines if line.get_label() == "_open" and line.get_xdata().size]
    assert len(points) == 1
    assert points[0].get_xdata().tolist() == [10.0]
    assert points[0].get_markerfacecolor() == "white"
    assert "Open markers: beyond the range" in LAWS_FIGURE.caption(runs, NONE)
    sound = runs.assign(status=0 * runs["status"])
    assert "Open" not in LAWS_FIGURE.caption(sound, NONE)


def test_changes_in_per_cent_against_depth_over_span(shear_study):
    axes = SHEAR_FIGURE.plot(*shear_study).axes
    for ax, change in zip(axes[:2], (-30.0 * DEPTHS, 240.0 * DEPTHS), strict=True):
        x, y = curve(ax, "5 m/s")
        assert x == pytest.approx(DEPTHS / 0.78)
        assert y == pytest.approx(change)
    # below the same against depth over the duration without shear
    runs, _ = shear_study
    x, y = curve(SHEAR_FIGURE.plot(runs, NONE).axes[2], "0.25 m/s")
    durations = runs["contact_duration"].sel(velocity=0.25, beam_model="euler_bernoulli").values
    assert x == pytest.approx(DEPTHS / durations)
    assert y == pytest.approx(-30.0 * DEPTHS)
    # the caption says by the data when shear matters
    text = SHEAR_FIGURE.caption(runs, NONE)
    assert "peak force changes by −2.4 to −0.3 %, by 1 % or more in 4 of 8 impacts" in text
    assert "(depth over span 0.051 to 0.1)" in text
    assert "contact duration changes by 2.4 to 19 %, by 1 % or more in 8 of 8 impacts" in text
    # it needs three depths and both models of yielding fibres
    assert SHEAR_FIGURE.applies(runs, NONE)
    assert not SHEAR_FIGURE.applies(runs.isel(beam_depth=slice(2)), NONE)
    assert not SHEAR_FIGURE.applies(runs.isel(beam_model=[1]), NONE)
    elastic = runs.assign_coords(beam_model=["elastic", "timoshenko"])
    assert not SHEAR_FIGURE.applies(elastic, NONE)
    assert not SHEAR_FIGURE.applies(runs.drop_vars("contact_duration"), NONE)


def test_a_failed_run_leaves_a_gap_and_is_counted(shear_study, failing):
    runs = failing(shear_study[0], {"velocity": 1, "beam_depth": 2, "beam_model": 0})
    _, y = curve(SHEAR_FIGURE.plot(runs, NONE).axes[0], "5 m/s")
    assert np.isnan(y).tolist() == [False, False, True, False]
    assert "in 3 of 7 impacts" in SHEAR_FIGURE.caption(runs, NONE)
    assert "1 of 16 runs is missing" in SHEAR_FIGURE.caption(runs, NONE)
