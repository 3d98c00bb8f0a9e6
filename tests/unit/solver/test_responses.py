"""The answers of a run, read off states made by hand."""

import numpy as np
import pytest

from impactlab.solver import outputs
from impactlab.solver.beam import make_grid
from impactlab.solver.contact.history import CONTACT, load, make_pair
from impactlab.solver.event_tracker import EVENTS, start, update_events
from impactlab.solver.jit import compiled
from impactlab.solver.outputs import RESPONSE, blank
from impactlab.solver.responses import (
    read_beam,
    read_contact,
    read_rebound,
)
from impactlab.variables import RESPONSES

DX = 0.01
GRID = make_grid(41, DX, 1e-6, 13.0, 2e4)
MID = GRID.mid


@pytest.fixture
def case(make_case):
    return make_case(beam_depth=0.0278)


@pytest.fixture
def answer():
    return blank(1)[0]


@pytest.fixture
def events():
    """Return that of a run that ended well: one contact, over, and the beam on its way back."""
    record = np.zeros(1, EVENTS)[0]
    record.contacts, record.touching = 1, 0
    record.t_first_end, record.time_in_contact, record.t_peak = 3e-4, 3e-4, 1e-4
    record.delta, record.w, record.w_max = -1e-4, 1e-4, 2e-4
    record.v_exit, record.v_s, record.v_mid, record.impulse = -0.4, -0.4, -0.1, 2.0
    return record


@pytest.fixture
def contact(case):
    record = np.zeros(1, CONTACT)[0]
    load(record, make_pair(case), 1e-4)
    return record


@pytest.mark.parametrize(
    ("pause", "duration"),
    [(0.02, 2.02), (0.04, 2.04), (0.06, 1.0)],
)
def test_a_pause_below_a_twentieth_does_not_end_the_first_contact(pause, duration):
    """The surfaces part at 1, for the pause, then touch for 1; steps of 1e-3."""

    @compiled
    def march(events, contact, pause):
        start(events, contact, 0)
        for step in range(1, 4000):
            t = 1e-3 * step
            delta = max(1.0 - t, min(t - 1.0 - pause, 2.0 + pause - t))
            update_events(events, delta, 0.0, 0.0, 1.0, 0.0, t, 1e-3)

    events = np.zeros(1, EVENTS)[0]
    march(events, np.zeros(1, CONTACT)[0], pause)
    assert events.t_first_end == pytest.approx(duration, abs=1e-3)
    assert events.contacts == 2
    assert events.time_in_contact == pytest.approx(2.0, abs=1e-2)


def read_everything(answer, case, events, contact, peeq):
    read_contact(answer, events, contact, make_pair(case))
    read_rebound(answer, case, events)
    read_beam(answer, case, events, peeq, np.ones(2), GRID, 0.7)


@pytest.fixture
def peeq():
    """Return that of a half beam, two fibres per section; indices as in solver/beam.py."""
    return np.zeros((MID + 3, 2))


def test_answers_are_the_responses_of_the_dataset():
    assert RESPONSE.names == ("status", "remarks", *RESPONSES)
    # blank records have no number and no bit
    records = blank(2)
    assert (records["status"] == 0).all()
    assert (records["remarks"] == 0).all()
    assert np.isnan([records[name] for name in RESPONSES]).all()


def test_a_run_that_ended_well_gives_every_answer(answer, case, events, contact, peeq):
    read_everything(answer, case, events, contact, peeq)
    assert answer.status == 0
    assert answer.peak_force == contact.F_m
    assert answer.time_of_peak_force == 1e-4
    assert answer.maximum_indentation == 1e-4
    assert answer.permanent_indentation == contact.delta_r > 0
    assert answer.contact_duration == answer.total_contact_time == 3e-4
    assert answer.number_of_contacts == 1
    assert answer.impulse == 2.0
    assert answer.contact_dissipation > 0
    assert answer.rebound_velocity == 0.4
    assert answer.restitution == pytest.approx(0.4 / 0.99)
    assert answer.maximum_deflection == 2e-4
    assert answer.plastic_dissipation == 0.7
    # the last one, energy_error, is the time loop's own
    assert [name for name in RESPONSES if np.isnan(answer[name])] == ["energy_error"]


@pytest.mark.parametrize(
    ("law", "times", "creates", "bulges"),
    [
        ("hertz", 1.5, False, False),
        ("stronge", 0.99, False, False),
        ("stronge", 1.01, True, True),
        ("stronge", 1.99, True, True),
        ("stronge", 2.01, True, False),
        ("stronge", 2.66, True, False),
        ("stronge", 2.69, False, False),
    ],
)
def test_flaws_of_the_contact_law_are_marked(
    answer, make_case, events, law, times, creates, bulges
):
    """times: largest indentation over that of first yield."""
    pair = make_pair(make_case(contact=law))
    yield_indentation = (0.75 * np.pi * 1.1 * pair.S_y / pair.E) ** 2 * pair.R
    contact = np.zeros(1, CONTACT)[0]
    load(contact, pair, times * yield_indentation)
    read_contact(answer, events, contact, pair)
    assert bool(answer.remarks & outputs.CONTACT_CREATED_ENERGY) == creates
    assert bool(answer.remarks & outputs.CONTACT_LEFT_A_BULGE) == bulges
    assert (answer.permanent_indentation < 0) == bulges
    assert (answer.contact_dissipation < -1e-4 * contact.work) == creates


def test_no_remark_on_an_answer_that_is_missing(answer, make_case, events):
    pair = make_pair(make_case(contact="stronge"))
    contact = np.zeros(1, CONTACT)[0]
    load(contact, pair, 1.5 * (0.75 * np.pi * 1.1 * pair.S_y / pair.E) ** 2 * pair.R)
    events.touching = 1
    read_contact(answer, events, contact, pair)
    assert answer.remarks == 0
