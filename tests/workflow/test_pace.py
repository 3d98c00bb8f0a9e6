"""The time left of a workflow, on the steps of `make study` as recorded on two cores."""

import csv
import runpy
from collections import Counter
from pathlib import Path

import pytest

PACE = Path(__file__).parents[2] / "workflow" / "rules" / "pace.smk"
RECORD = Path(__file__).with_suffix(".csv")
"""Study, rule, start and duration (s) of each step."""
SLOWER = 3.0
"""Of another machine, or of a step that takes longer than before."""


@pytest.fixture(scope="module")
def steps():
    with RECORD.open() as file:
        return [
            (row["rule"], row["study"], float(row["start"]), float(row["seconds"]))
            for row in csv.DictReader(file)
        ]


def estimates(steps, recorded):
    """Yield time, true and estimated seconds left as each step begins."""
    rules = runpy.run_path(str(PACE))
    pace = rules["Pace"](Counter(rule for rule, *_ in steps), recorded, cores=2)
    begins = [(start, 1, rule, study) for rule, study, start, _ in steps]
    ends = [(start + seconds, 0, rule, study) for rule, study, start, seconds in steps]
    end = max(ends)[0]
    for now, begin, rule, study in sorted(begins + ends):
        if begin:
            yield now, end - now, pace.left(now)
            pace.start((rule, study), rule, study, now)
        else:
            pace.finish((rule, study), now)


def right(steps, recorded):
    """Return the share of lines right within a factor of two, the last 10 s left out."""
    lines = [(true, left) for _, true, left in estimates(steps, recorded) if true > 10]
    return sum(left is not None and true / 2 <= left <= 2 * true for true, left in lines) / len(
        lines
    )


def test_without_an_earlier_run_the_time_left_is_soon_known(steps):
    """Within a factor of two, although steps of all cores come first."""
    assert right(steps, {}) > 0.85
    said = [left for _, _, left in estimates(steps, {})]
    assert said[:2] == [None] * 2
    assert None not in said[4:]


def test_an_earlier_run_tells_from_the_start(steps):
    recorded = {(rule, study): seconds for rule, study, _, seconds in steps}
    assert right(steps, recorded) > 0.95
    _, true, left = next(estimates(steps, recorded))
    assert true / 2 < left < 2 * true


def test_a_slower_machine_is_noticed(steps):
    """The earlier run was three times as fast."""
    recorded = {(rule, study): seconds / SLOWER for rule, study, _, seconds in steps}
    assert right(steps, recorded) > 0.85


@pytest.mark.parametrize("rule", ["verify", "runs"])
def test_one_slow_step_misleads_no_other(steps, rule):
    """Here it took three times as long in the earlier run: it is the only step misjudged."""
    recorded = {(name, study): seconds for name, study, _, seconds in steps}
    slow = next(key for key in recorded if key[0] == rule)
    recorded[slow] *= SLOWER
    assert right(steps, recorded) > 0.85
    later = [
        (true, left) for now, true, left in estimates(steps, recorded) if now > 150 and true > 10
    ]
    assert all(true / 2 < left < 2 * true for true, left in later)


def test_durations_are_in_round_words():
    words = runpy.run_path(str(PACE))["duration"]
    texts = {3: "10 s", 44: "40 s", 89: "90 s", 95: "2 min", 600: "10 min"}
    assert {seconds: words(seconds) for seconds in texts} == texts
