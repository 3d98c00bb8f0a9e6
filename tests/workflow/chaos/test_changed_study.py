"""A study changed between interrupted runs: only what still fits is reused."""

import signal

import pytest
from chaos import (
    SMALL,
    STUDY,
    assert_same_bits,
    keys_on_disk,
    new_study,
    resumed,
    run,
    shards,
    solved_before,
)

pytestmark = pytest.mark.chaos

CHANGES = {
    "other duration": ("16 ms", "16.5 ms", False),
    "other points": ("points: 5", "points: 6", False),
    "other beam": ("base: paper", "base: paper, gravity: 9.8", False),
    "other samples": ("samples: 50", "samples: 51", False),
    "other title": ("Tough", "Tougher", True),
    "fewer responses": ("store:", "responses: [peak_force]\nstore:", True),
}


@pytest.mark.parametrize("change", CHANGES)
def test_what_still_fits_is_reused(folder, tmp_path_factory, change):
    """All of the runs or none, and in both cases the answers of a fresh study."""
    old, new, fits = CHANGES[change]
    broken_off(folder)
    before = len(keys_on_disk(folder))
    text = STUDY.replace(old, new)
    changed, said = resumed(new_study(folder, text))
    assert solved_before(said) == (before if fits else 0)
    fresh, _ = resumed(new_study(tmp_path_factory.mktemp("fresh"), text))
    assert_same_bits(changed, fresh)


def test_the_runs_in_common_are_reused(folder, tmp_path_factory):
    """Every second velocity, interrupted again, then all of them with more nodes."""
    broken_off(folder)
    text = STUDY.replace("{start: 0.5, stop: 10, number: 160}", "[0.5, 1, 2, 3]")
    _, said = resumed(new_study(folder, text))
    assert 0 < solved_before(said) < 12
    text = STUDY.replace("141]", "141, 161]").replace("number: 160", "number: 40")
    broken_off(new_study(folder, text))
    changed, said = resumed(folder)
    assert 0 < solved_before(said) < 160
    fresh, _ = resumed(new_study(tmp_path_factory.mktemp("fresh"), text))
    assert_same_bits(changed, fresh)


def broken_off(folder):
    """Killed when it has solved a part."""
    begun = len(shards(folder))
    command = run(folder, "--workers", "1", *SMALL)
    command.wait_for_shards(begun + 8)
    command.send(signal.SIGKILL)
    command.end()
