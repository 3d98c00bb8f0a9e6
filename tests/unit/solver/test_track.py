"""Peaks and contact events between the steps."""

from __future__ import annotations

import numpy as np
import pytest

from impactlab.solver.track import (
    TRACK,
    passed_peak,
    shift,
    start,
    vertex,
    watch_contact,
    watch_deflection,
)

DT = 0.1


@pytest.fixture
def track():
    record = np.zeros(1, TRACK)[0]
    start(record)
    return record


def follow(track, deltas, delta_r=0.0, velocities=None):
    """Watch a history of indentation, a step of DT each, from t = 0."""
    velocities = np.zeros(len(deltas)) if velocities is None else velocities
    for step, (delta, v_s) in enumerate(zip(deltas, velocities, strict=True)):
        watch_contact(track, delta, delta_r, v_s, step * DT, DT)
        shift(track, delta, 0.0, 0.0, DT)


@pytest.mark.parametrize("top", [-0.4, 0.0, 0.3])
def test_vertex_of_a_parabola_is_exact(top):
    offset, value = vertex(*(7.0 - 3.0 * (x - top) ** 2 for x in (-1.0, 0.0, 1.0)))
    assert offset == pytest.approx(top, abs=1e-14)
    assert value == pytest.approx(7.0, rel=1e-14)


def test_vertex_of_a_straight_line_is_its_middle():
    assert vertex(2.0, 2.0, 2.0) == (0.0, 2.0)


def test_a_peak_has_passed_where_the_largest_indentation_begins_to_fall(track):
    track.delta_before, track.delta = 1.0, 2.0
    assert passed_peak(track, 1.9, 2.0)
    assert not passed_peak(track, 2.1, 2.0)  # still growing
    assert not passed_peak(track, 1.9, 2.5)  # a lower peak than an earlier one
    track.delta_before = 3.0
    assert not passed_peak(track, 1.9, 2.0)  # falling already


def test_the_first_contact_begins_at_zero(track):
    assert track.contacts == 1
    assert track.touching == 1
    follow(track, [0.0])
    assert track.touching == 1
    assert np.isnan([track.t_first_end, track.v_exit, track.t_peak]).all()


def test_a_contact_ends_between_the_steps(track):
    """A parabola of indentation is straight enough: linear interpolation between the steps."""
    follow(track, [0.0, 2.0, 1.0, -3.0], velocities=[4.0, 3.0, 2.0, 1.0])
    assert track.touching == 0
    assert track.t_first_end == pytest.approx(2.25 * DT, rel=1e-14)
    assert track.time_in_contact == pytest.approx(2.25 * DT, rel=1e-14)
    assert track.v_exit == 1.0


def test_it_ends_at_the_dent_and_not_at_zero(track):
    follow(track, [0.0, 2.0, 1.0], delta_r=1.5)
    assert track.t_first_end == pytest.approx(1.5 * DT, rel=1e-14)


def test_a_second_contact_is_counted_and_the_first_duration_kept(track):
    follow(track, [0.0, 1.0, -1.0, -1.0, 3.0, 1.0, -1.0], velocities=[0, 0, -5, 0, 0, 0, -7])
    assert track.contacts == 2
    assert track.t_first_end == pytest.approx(1.5 * DT)
    assert track.t_touch == pytest.approx(3.25 * DT)
    assert track.time_in_contact == pytest.approx((1.5 + 5.5 - 3.25) * DT)
    assert track.v_exit == -7


def test_a_contact_that_goes_on_has_no_end(track):
    follow(track, [0.0, 1.0, -1.0, 1.0, 2.0])
    assert track.contacts == 2
    assert track.touching == 1
    assert track.time_in_contact == pytest.approx(1.5 * DT)


def test_the_largest_deflection_is_the_top_of_its_parabola(track):
    time = DT * np.arange(50)
    for w in np.where(time < 2, 1 - (time - 1.03) ** 2, 2 - (time - 3.04) ** 2):
        watch_deflection(track, w)
        shift(track, 0.0, w, 0.0, DT)
    assert track.w_max == pytest.approx(2.0, rel=1e-12)


def test_a_deflection_that_only_grows_has_no_peak(track):
    for w in np.arange(10.0):
        watch_deflection(track, w)
        shift(track, 0.0, w, 0.0, DT)
    assert track.w_max == 0.0


def test_impulse_is_the_trapezoidal_sum(track):
    forces = np.array([0.0, 3.0, 5.0, 2.0])
    for F in forces:
        shift(track, 0.0, 0.0, F, DT)
    # the first step begins at zero force
    assert track.impulse == pytest.approx(np.trapezoid(forces, dx=DT))
