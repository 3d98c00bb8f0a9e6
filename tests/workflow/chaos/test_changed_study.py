"""A study changed between interrupted runs: only what still fits is reused."""

import signal

import pytest
from chaos import (
    STUDY,
    assert_same_bits,
    new_study,
    resumed,
    run,
    shards,
    solved_before,
)

pytestmark = pytest.mark.chaos

SHORT = STUDY.replace("number: 160", "number: 40")


def test_the_runs_in_common_are_reused(folder, tmp_path):
    """Every second velocity, interrupted again, then all of them with more nodes."""
    broken_off(new_study(folder, SHORT))
    text = SHORT.replace("{start: 0.5, stop: 10, number: 40}", "[0.5, 1, 2, 3]")
    _, said = resumed(new_study(folder, text))
    assert 0 < solved_before(said) < 12
    text = SHORT.replace("141]", "141, 161]").replace("number: 40", "number: 20")
    broken_off(new_study(folder, text))
    changed, said = resumed(folder)
    assert 0 < solved_before(said) < 80
    fresh, _ = resumed(new_study(tmp_path / "fresh", text))
    assert_same_bits(changed, fresh)


def broken_off(folder):
    """Killed when it has solved a part."""
    begun = len(shards(folder))
    command = run(folder, "--workers", "1", "--batch-seconds", "0.01")
    command.wait_for_shards(begun + 4)
    command.send(signal.SIGKILL)
    command.end()
