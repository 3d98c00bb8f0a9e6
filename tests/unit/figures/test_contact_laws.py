"""The figure of all contact laws."""

from __future__ import annotations

from itertools import combinations

import xarray as xr

from impactlab.figures.catalogue import CATALOGUE
from impactlab.solver.contact import LAWS

NONE = xr.Dataset()
FIGURE = CATALOGUE["contact_laws"]


def _look(line):
    return line.get_color(), line._unscaled_dash_pattern, line.get_marker()


def test_every_law_has_a_curve_of_its_own_look_in_every_panel(laws_study):
    for ax in FIGURE.plot(*laws_study).axes:
        lines = [line for line in ax.lines if not str(line.get_label()).startswith("_")]
        assert len(lines) == len(LAWS)
        looks = [
            (line.get_color(), line._unscaled_dash_pattern, line.get_marker()) for line in lines
        ]
        assert all(one != other for one, other in combinations(looks, 2))


def test_curves_are_the_stored_values(laws_study):
    runs, _ = laws_study
    ax = FIGURE.plot(runs, NONE).axes[1]
    (line,) = (line for line in ax.lines if line.get_label() == "MJG")
    assert line.get_xdata().tolist() == [0.1, 1.0, 10.0]
    assert line.get_ydata().tolist() == runs["restitution"].sel(contact="mjg").values.tolist()


def test_runs_beyond_a_laws_range_are_open_and_the_caption_says_so(laws_study):
    runs, _ = laws_study
    ax = FIGURE.plot(runs, NONE).axes[1]
    points = [line for line in ax.lines if line.get_label() == "_open" and line.get_xdata().size]
    assert len(points) == 1
    assert points[0].get_xdata().tolist() == [10.0]
    assert points[0].get_markerfacecolor() == "white"
    assert "Open markers: beyond the range" in FIGURE.caption(runs, NONE)
    sound = runs.assign(status=0 * runs["status"])
    assert "Open" not in FIGURE.caption(sound, NONE)


def test_it_needs_three_laws_on_a_grid(laws_study):
    runs, analysis = laws_study
    assert FIGURE.applies(runs, analysis)
    assert not FIGURE.applies(runs.isel(contact=slice(2)), analysis)
    assert not FIGURE.applies(runs.isel(velocity=[0]), analysis)
