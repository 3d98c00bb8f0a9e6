"""The answers of a run, read off states made by hand."""

import numpy as np
import pytest

from impactlab.solver import outputs
from impactlab.solver.beam import make_grid
from impactlab.solver.contact.history import CONTACT, load, make_pair
from impactlab.solver.event_tracker import EVENTS
from impactlab.solver.outputs import RESPONSE, blank
from impactlab.solver.responses import (
    PLASTIC_ZONE_STRAIN,
    read_beam,
    read_contact,
    read_rebound,
    share_above,
)
from impactlab.variables import RESPONSES, STATUS_FLAGS

DX = 0.01
GRID = make_grid(20, DX, 1e-6, 13.0, 2e4)
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


def read_everything(answer, case, events, contact, peeq):
    read_contact(answer, events, contact, make_pair(case))
    read_rebound(answer, case, events)
    read_beam(answer, case, events, peeq, GRID, 0.7)


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


UNFINISHED = {
    "in contact": ({"touching": 1}, outputs.IN_CONTACT_AT_END | outputs.SPHERE_NOT_LEAVING),
    "first contact": ({"t_first_end": np.nan}, outputs.FIRST_CONTACT_UNFINISHED),
    "loading": ({"delta": 1e-4}, outputs.INDENTATION_STILL_GROWING),
    "bending": ({"w": 3e-4}, outputs.DEFLECTION_STILL_GROWING),
}


@pytest.mark.parametrize(("changes", "bits"), UNFINISHED.values(), ids=UNFINISHED)
def test_what_is_missing_is_what_the_status_explains(
    answer, case, events, contact, peeq, changes, bits
):
    for name, value in changes.items():
        events[name] = value
    read_everything(answer, case, events, contact, peeq)
    assert answer.status == bits
    flags = {bit: name for name, (bit, _) in STATUS_FLAGS.items()}
    expected = {
        name
        for name, entry in RESPONSES.items()
        if any(entry.missing == flags[b] for b in split(bits))
    }
    missing = {name for name in RESPONSES if np.isnan(answer[name])} - {"energy_error"}
    assert missing == expected


def split(bits):
    return [1 << power for power in range(32) if bits >> power & 1]


@pytest.mark.parametrize(
    ("v_s", "v_mid", "leaves"),
    [(-0.4, -0.1, True), (0.1, 0.2, False), (-0.1, -0.4, False), (0.0, 0.5, False)],
    ids=["up and away", "down", "up, the beam faster", "at rest"],
)
def test_the_rebound_is_over_once_the_sphere_moves_up_and_away(
    answer, case, events, v_s, v_mid, leaves
):
    events.v_s, events.v_mid = v_s, v_mid
    read_rebound(answer, case, events)
    assert np.isfinite(answer.rebound_velocity) == leaves
    assert answer.status == (0 if leaves else outputs.SPHERE_NOT_LEAVING)


def test_strains_of_the_beam(answer, case, events, peeq):
    """The peak in any fibre; the remote one farther than a depth (2.78 DX) from mid-span."""
    peeq[MID - 3, 0] = 3e-3
    peeq[MID - 2, 1] = 9e-3
    peeq[MID, 0] = 7e-3
    read_beam(answer, case, events, peeq, GRID, 0.0)
    assert answer.peak_plastic_strain == 9e-3
    assert answer.remote_plastic_strain == 3e-3


def test_plastic_zone_is_measured_between_the_nodes(answer, case, events, peeq):
    """PEEQ linear in x around mid-span, zero from 6 DX on either side."""
    slope = 4e-5
    peeq[: MID + 1, 0] = slope * np.maximum(6.0 - np.arange(MID, -1, -1), 0)
    read_beam(answer, case, events, peeq, GRID, 0.0)
    reaches = 6.0 - PLASTIC_ZONE_STRAIN / slope
    assert answer.plastic_zone_length == pytest.approx(2 * reaches * DX, rel=1e-12)
    assert PLASTIC_ZONE_STRAIN == 1e-5  # as dataset.py tells the reader


@pytest.mark.parametrize(
    ("left", "right", "share"),
    [(2, 3, 1), (0, 0.5, 0), (0, 4, 0.75), (4, 0, 0.75), (1, 1, 1), (0, 1, 0), (1, 2, 1)],
)
def test_share_of_a_cell_above_the_threshold(left, right, share):
    assert share_above(float(left), float(right), 1.0) == share
