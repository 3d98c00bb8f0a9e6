from __future__ import annotations

import pytest

from impactlab.study.words import amount, time


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.0021, "2.1 ms"),
        (12.3, "12 s"),
        (90, "1.5 minutes"),
        (7200, "2 hours"),
        (4e9, "130 years"),
    ],
)
def test_times(seconds, words):
    assert time(seconds) == words


@pytest.mark.parametrize(
    ("size", "words"), [(12, "12 bytes"), (1.26e9, "1.3 GB"), (2e18, "2,000 PB")]
)
def test_amounts(size, words):
    assert amount(size) == words
