from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from impactlab.figures import scales


@pytest.mark.parametrize(
    ("values", "scale"),
    [
        ([1.0, 100.0], "log"),
        ([1.0, 10.0], "linear"),
        ([0.0, 100.0], "linear"),
        ([-1.0, 100.0], "linear"),
        ([np.nan, 1.0, 100.0], "log"),
        ([], "linear"),
    ],
)
def test_wide_positive_ranges_are_logarithmic(values: list[float], scale: str) -> None:
    axes = Figure().subplots()
    scales.fit(axes, "y", values)
    assert axes.get_yscale() == scale
    assert axes.get_xscale() == "linear"


def test_short_logarithmic_axes_still_have_labels() -> None:
    axes = Figure().subplots()
    axes.plot([1, 2], [0.24, 0.55])
    scales.logarithmic(axes, "y", [0.24, 0.55])
    axes.figure.draw_without_rendering()  # type: ignore[union-attr]
    low, high = axes.get_ylim()
    shown = [
        label.get_text()
        for label, at in zip(axes.get_yticklabels(), axes.get_yticks(), strict=True)
        if low <= at <= high
    ]
    assert shown == ["0.25", "0.3", "0.4", "0.5"]


def test_positive_leaves_gaps() -> None:
    found = scales.positive([1.0, 0.0, -1.0, np.inf, np.nan, 1e-12], above=1e-9)
    np.testing.assert_array_equal(found, [1.0] + 5 * [np.nan])
