"""Two processes on one study: one works, the other waits or says so, and no run is lost."""

import signal

import pytest
from chaos import (
    RUNS,
    SMALL,
    Command,
    assert_same_bits,
    complaint,
    resumed,
    run,
    solved_before,
    stored,
)

pytestmark = pytest.mark.chaos


def another(folder, *options):
    """A second command on the study; what it says lies apart."""
    elsewhere = folder / "another"
    elsewhere.mkdir(exist_ok=True)
    output = folder / "results" / "tough" / "runs.nc"
    study = folder / "studies" / "tough.yaml"
    return Command("run", study, "--output", output, *options, cwd=elsewhere)


def test_both_started_at_the_same_moment(folder, undisturbed):
    both = [run(folder, *SMALL), another(folder, *SMALL)]
    codes = sorted(command.end() for command in both)
    assert codes[0] == 0
    for command in both:
        assert "Traceback" not in command.said
    assert_same_bits(stored(folder), undisturbed)


def test_a_terminated_process_holds_up_nobody(folder, undisturbed):
    first = run(folder, *SMALL)
    first.wait_for_shards(2)
    first.send(signal.SIGTERM)
    first.end()
    runs, said = resumed(folder)
    assert 0 < solved_before(said) < RUNS
    assert_same_bits(runs, undisturbed)


def test_a_stopped_process_is_still_at_work(folder, undisturbed):
    """Ctrl-Z keeps the study, and a second one says who has it; it goes on when it is let."""
    first = run(folder, *SMALL)
    first.wait_for_shards(2)
    first.send(signal.SIGSTOP)
    second = another(folder)
    assert second.end() == 1, second.said
    assert str(first.process.pid) in complaint(second.said)
    first.send(signal.SIGCONT)
    assert first.end() == 0, first.said
    runs, said = resumed(folder)
    assert solved_before(said) == RUNS
    assert_same_bits(runs, undisturbed)
