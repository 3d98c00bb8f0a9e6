"""A study changed between interrupted runs: only what still fits is reused."""

import shutil
import signal

import pytest
from chaos import (
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

SHORT = STUDY.replace("number: 160", "number: 40")
SMALLER = ("--workers", "1", "--batch-seconds", "0.01")
CHANGES = {
    "other duration": ("8 ms", "8.5 ms", False),
    "other points": ("points: 5", "points: 6", False),
    "other beam": ("base: paper", "base: paper, gravity: 9.8", False),
    "other samples": ("samples: 50", "samples: 51", False),
    "other title": ("Tough", "Tougher", True),
    "fewer responses": ("store:", "responses: [peak_force]\nstore:", True),
}


@pytest.fixture(scope="module")
def half_done(tmp_path_factory):
    """A study of which some shards are on disk."""
    folder = new_study(tmp_path_factory.mktemp("half_done"), SHORT)
    broken_off(folder)
    return folder


@pytest.mark.parametrize("change", CHANGES)
def test_what_still_fits_is_reused(tmp_path, half_done, change):
    """All of the runs or none, and in both cases the answers of a fresh study."""
    old, new, fits = CHANGES[change]
    folder = shutil.copytree(half_done, tmp_path / "copy")
    before = len(keys_on_disk(folder))
    text = SHORT.replace(old, new)
    changed, said = resumed(new_study(folder, text))
    assert solved_before(said) == (before if fits else 0)
    fresh, _ = resumed(new_study(tmp_path / "fresh", text))
    assert_same_bits(changed, fresh)


def test_the_runs_in_common_are_reused(folder, tmp_path_factory):
    """Every second velocity, interrupted again, then all of them with more nodes."""
    broken_off(new_study(folder, SHORT))
    text = SHORT.replace("{start: 0.5, stop: 10, number: 40}", "[0.5, 1, 2, 3]")
    _, said = resumed(new_study(folder, text))
    assert 0 < solved_before(said) < 12
    text = SHORT.replace("141]", "141, 161]").replace("number: 40", "number: 20")
    broken_off(new_study(folder, text))
    changed, said = resumed(folder)
    assert 0 < solved_before(said) < 80
    fresh, _ = resumed(new_study(tmp_path_factory.mktemp("fresh"), text))
    assert_same_bits(changed, fresh)


def broken_off(folder):
    """Killed when it has solved a part."""
    begun = len(shards(folder))
    command = run(folder, *SMALLER)
    command.wait_for_shards(begun + 4)
    command.send(signal.SIGKILL)
    command.end()
