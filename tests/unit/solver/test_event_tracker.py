"""Peaks and contact events between the steps."""

import numpy as np
import pytest

from impactlab.solver.contact import LAWS
from impactlab.solver.contact.history import CONTACT, Pair, force
from impactlab.solver.event_tracker import EVENTS, start, update_events, vertex
from impactlab.solver.leapfrog import contact_force

DT = 0.1


@pytest.fixture
def events():
    record = np.zeros(1, EVENTS)[0]
    start(record)
    return record


def follow(events, deltas, delta_r=0.0, velocities=None):
    """Watch a history of indentation, a step of DT each, from t = 0."""
    velocities = np.zeros(len(deltas)) if velocities is None else velocities
    for step, (delta, v_s) in enumerate(zip(deltas, velocities, strict=True)):
        update_events(events, delta, delta_r, 0.0, 0.0, v_s, step * DT, DT)


@pytest.mark.parametrize("top", [-0.4, 0.0, 0.3])
def test_vertex_of_a_parabola_is_exact(top):
    offset, value = vertex(*(7.0 - 3.0 * (x - top) ** 2 for x in (-1.0, 0.0, 1.0)))
    assert offset == pytest.approx(top, abs=1e-14)
    assert value == pytest.approx(7.0, rel=1e-14)


def test_vertex_of_a_straight_line_is_its_middle():
    assert vertex(2.0, 2.0, 2.0) == (0.0, 2.0)


@pytest.mark.parametrize(
    ("before", "delta", "largest", "passed"),
    [
        (1.0, 1.9, 2.0, True),
        (1.0, 2.1, 2.0, False),  # still growing
        (1.0, 1.9, 2.5, False),  # a lower peak than an earlier one
        (3.0, 1.9, 2.0, False),  # falling already
    ],
)
def test_a_peak_has_passed_where_the_largest_indentation_begins_to_fall(
    events, before, delta, largest, passed
):
    """Then it is taken at the top of the parabola, between the steps."""
    pair, contact = Pair(LAWS.index("hertz"), 1e11, 0.1, 3e8, 0.3), np.zeros(1, CONTACT)[0]
    force(contact, pair, largest)
    events.delta_before, events.delta = before, 2.0
    contact_force(contact, events, pair, delta, 7.0, DT)
    offset, peak = vertex(before, 2.0, delta)
    assert np.isnan(events.t_peak) != passed
    assert contact.delta_m == (peak if passed else max(largest, delta))
    if passed:
        assert events.t_peak == pytest.approx(7.0 + (offset - 1.0) * DT, rel=1e-14)


def test_the_first_contact_begins_at_zero(events):
    assert (events.contacts, events.touching) == (1, 1)
    follow(events, [0.0])
    assert events.touching == 1
    assert np.isnan([events.t_first_end, events.v_exit, events.t_peak]).all()


def test_a_contact_ends_between_the_steps(events):
    """A parabola of indentation is straight enough: linear interpolation between the steps."""
    follow(events, [0.0, 2.0, 1.0, -3.0], velocities=[4.0, 3.0, 2.0, 1.0])
    assert events.touching == 0
    assert events.t_first_end == pytest.approx(2.25 * DT, rel=1e-14)
    assert events.time_in_contact == pytest.approx(2.25 * DT, rel=1e-14)
    assert events.v_exit == 1.0


def test_it_ends_at_the_dent_and_not_at_zero(events):
    follow(events, [0.0, 2.0, 1.0], delta_r=1.5)
    assert events.t_first_end == pytest.approx(1.5 * DT, rel=1e-14)


def test_a_second_contact_is_counted_and_the_first_duration_kept(events):
    follow(events, [0.0, 1.0, -1.0, -1.0, 3.0, 1.0, -1.0], velocities=[0, 0, -5, 0, 0, 0, -7])
    assert events.contacts == 2
    assert events.t_first_end == pytest.approx(1.5 * DT)
    assert events.t_touch == pytest.approx(3.25 * DT)
    assert events.time_in_contact == pytest.approx((1.5 + 5.5 - 3.25) * DT)
    assert events.v_exit == -7


def test_a_contact_that_goes_on_has_no_end(events):
    follow(events, [0.0, 1.0, -1.0, 1.0, 2.0])
    assert events.contacts == 2
    assert events.touching == 1
    assert events.time_in_contact == pytest.approx(1.5 * DT)


def test_the_largest_deflection_is_the_top_of_its_parabola(events):
    time = DT * np.arange(50)
    for w in np.where(time < 2, 1 - (time - 1.03) ** 2, 2 - (time - 3.04) ** 2):
        update_events(events, 0.0, 0.0, w, 0.0, 0.0, 0.0, DT)
    assert events.w_max == pytest.approx(2.0, rel=1e-12)


def test_a_deflection_that_only_grows_has_no_peak(events):
    for w in np.arange(10.0):
        update_events(events, 0.0, 0.0, w, 0.0, 0.0, 0.0, DT)
    assert events.w_max == 0.0


def test_impulse_is_the_trapezoidal_sum(events):
    forces = np.array([0.0, 3.0, 5.0, 2.0])
    for F in forces:
        update_events(events, 0.0, 0.0, 0.0, F, 0.0, 0.0, DT)
    # the first step begins at zero force
    assert events.impulse == pytest.approx(np.trapezoid(forces, dx=DT))
