from __future__ import annotations

import numpy as np
import pytest

from impactlab.report.indices import with_margin


@pytest.mark.parametrize(
    ("value", "margin", "text"),
    [
        (0.7123, 0.03, "0.71 ± 0.03"),
        (0.0213, 0.0021, "0.021 ± 0.002"),
        (-0.004, 0.02, "0.00 ± 0.02"),
        (-0.034, 0.02, "−0.03 ± 0.02"),
        (0.0002, 0.0004, "below 0.001"),
        (0.0002, 0.01, "0.00 ± 0.01"),
        (0.5, np.inf, "0.50"),
        (np.nan, 0.1, "undefined"),
    ],
)
def test_digits_follow_the_interval(value: float, margin: float, text: str) -> None:
    assert with_margin(value, margin) == text
