from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr

from impactlab.study.adaptive.widest import widest

NAN = [np.nan, np.nan]


@pytest.fixture
def analysis():
    """Intervals of three responses, of which `still` has none."""
    dims = ("response", "parameter")
    flags = {"flag_values": [0, 2], "flag_descriptions": "usable: fine\nconstant: does not vary"}
    return xr.Dataset(
        {
            "total_order_interval": (dims, [[0.1, 0.2], NAN, [0.3, 0.1]]),
            "first_order_interval": (dims, [[0.5, 0.2], NAN, [0.3, 0.4]]),
            "sensitivity_verdict": ("response", [0, 2, 0], flags),
        },
        {"response": ["force", "still", "time"], "parameter": ["a", "b"]},
    )


def test_the_widest_is_named(analysis):
    found = widest(analysis, ["force", "still", "time"])
    assert found.half_width == 0.5
    assert (found.index, found.response, found.parameter) == ("first_order", "force", "a")
    assert found.left_out == ("still (constant: does not vary)",)
    assert str(found) == (
        "the widest interval is that of the first-order index of force to a, ± 0.5"
    )


def test_only_what_is_asked_counts(analysis):
    found = widest(analysis, ["time"])
    assert (found.half_width, found.index, found.parameter) == (0.4, "first_order", "b")
    assert found.left_out == ()


def test_total_order_counts_too(analysis):
    analysis["first_order_interval"] *= 0
    assert widest(analysis, ["time", "force"]).index == "total_order"


def test_without_any_index_there_is_none(analysis):
    found = widest(analysis, ["still"])
    assert math.isnan(found.half_width)
    assert (found.index, found.response, found.parameter) == ("", "", "")
    assert found.left_out == ("still (constant: does not vary)",)


def test_a_gap_among_numbers_is_not_narrow(analysis):
    analysis["total_order_interval"][2, 1] = np.nan
    found = widest(analysis, ["force", "time"])
    assert (found.half_width, found.response, found.parameter) == (math.inf, "time", "b")
