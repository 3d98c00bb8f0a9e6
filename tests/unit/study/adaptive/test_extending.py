from __future__ import annotations

import json
import math

import numpy as np
import pytest
import xarray as xr

from impactlab.analysis.analyse import analyse
from impactlab.study.adaptive.extension import extend_sample, largest_interval
from impactlab.study.design import design
from impactlab.study.schema.readers import study_of_text

RESPONSES = ["peak_force", "contact_duration", "number_of_contacts"]


def uniform(low, high):
    return {"distribution": "uniform", "low": low, "high": high}


@pytest.fixture
def sample():
    """The design of 64 base samples of two parameters, to be extended."""

    def make(**until):
        study = {
            "title": "-",
            "impact": {"base": "paper"},
            "duration": 1e-3,
            "responses": RESPONSES,
            "sampling": {
                "method": "sobol",
                "base_samples": 64,
                "second_order": False,
                "seed": 0,
                "until": {"interval": 0.05, "runs": 100_000} | until,
                "parameters": {"velocity": uniform(1, 2), "gravity": uniform(0, 10)},
            },
        }
        return design(study_of_text("some", json.dumps(study)))

    return make


@pytest.fixture
def solve():
    """Answers in closed form; notes the number of runs each time."""

    def solved(asked):
        solved.runs.append(asked.sizes["run"])
        v, g = asked["velocity"] - 1.5, asked["gravity"] / 10 - 0.5
        answers = {"peak_force": 2 * v + g, "contact_duration": v * g + v + g}
        answers["number_of_contacts"] = xr.ones_like(v)
        answers["status"] = xr.zeros_like(v, dtype=np.int32)
        return asked.assign(answers)

    solved.runs = []
    return solved


@pytest.fixture
def shrinking():
    """Intervals of 1.6/sqrt(N): a tenth at N = 256; that of the total order of the force, half."""

    def analysed(runs):
        width = 1.6 / np.sqrt(runs.attrs["base_samples"])
        widths = np.full((3, 2), width)
        widths[2] = np.nan
        flags = {"flag_values": [0, 2], "flag_descriptions": "usable: fine\nconstant: it is still"}
        dims = ("response", "parameter")
        return xr.Dataset(
            {
                "first_order_interval": (dims, widths * [[0.5], [1], [1]]),
                "total_order_interval": (dims, widths * [0.1, 0.2]),
                "sensitivity_verdict": ("response", [0, 0, 2], flags),
            },
            {"response": RESPONSES, "parameter": ["velocity", "gravity"]},
        )

    return analysed


def test_the_sample_grows_until_the_widest_interval_is_narrow_enough(sample, solve, shrinking):
    runs = extend_sample(sample(interval=0.1), solve, shrinking)
    assert solve.runs == [256, 512, 1024]  # N (D + 2)
    assert runs.attrs["base_samples"] == 256
    assert runs.attrs["until_reached"] == 1
    assert runs.attrs["until_reason"] == (
        "number_of_contacts has no indices (constant: it is still); "
        "the widest interval is that of the first-order index of contact_duration to velocity, "
        "± 0.1, within 0.1"
    )


def test_it_stops_before_there_are_more_runs_than_allowed(sample, solve, shrinking):
    runs = extend_sample(sample(interval=0.01, runs=2047), solve, shrinking)
    assert solve.runs == [256, 512, 1024]
    assert runs.attrs["until_reached"] == 0
    expected = "± 0.1, above 0.01, but twice as many runs are more than 2,047"
    assert runs.attrs["until_reason"].endswith(expected)


def test_as_many_runs_as_allowed_are_made(sample, solve, shrinking):
    extend_sample(sample(interval=0.01, runs=2048), solve, shrinking)
    assert solve.runs == [256, 512, 1024, 2048]


def test_only_the_responses_it_is_asked_of_count(sample, solve, shrinking):
    runs = extend_sample(sample(interval=0.1, responses=["peak_force"]), solve, shrinking)
    assert solve.runs == [256]
    assert runs.attrs["until_reason"].startswith("the widest")
    assert "peak_force" in runs.attrs["until_reason"]


def test_responses_without_indices_alone_ask_for_no_runs(sample, solve, shrinking):
    runs = extend_sample(sample(responses=["number_of_contacts"]), solve, shrinking)
    assert solve.runs == [256]
    assert runs.attrs["until_reached"] == 0
    expected = "; no response has indices that more runs could narrow"
    assert runs.attrs["until_reason"].endswith(expected)


def test_the_analysis_of_the_package_decides(sample, solve, tmp_path):
    """The same holds if the design and the runs have been in files."""
    sample(interval=0.08).to_netcdf(tmp_path / "design.nc")
    runs = extend_sample(xr.load_dataset(tmp_path / "design.nc"), solve, analyse)
    runs.to_netcdf(tmp_path / "runs.nc")
    analysis = analyse(xr.load_dataset(tmp_path / "runs.nc"))
    assert len(solve.runs) > 1
    widths = [analysis[f"{name}_order_interval"] for name in ("first", "total")]
    widest = max(width.max().item() for width in widths)
    assert widest <= 0.08
    assert f"± {widest:.3g}, within 0.08" in analysis.attrs["until_reason"]
    assert "number_of_contacts has no indices (constant: " in runs.attrs["until_reason"]
    # S = (a_i width_i)^2 / sum for a linear function
    first = analysis["first_order"].sel(response="peak_force")
    np.testing.assert_allclose(first, [0.8, 0.2], atol=0.08)


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


def widest(index, of):
    return f"the widest interval is that of the {index} index of {of}"


STILL = "still has no indices (constant: does not vary); "


def test_the_widest_is_named(analysis):
    found = largest_interval(analysis, ["force", "still", "time"])
    assert found == (0.5, f"{STILL}{widest('first-order', 'force to a')}, ± 0.5")


def test_only_what_is_asked_counts(analysis):
    found = largest_interval(analysis, ["time"])
    assert found == (0.4, f"{widest('first-order', 'time to b')}, ± 0.4")


def test_total_order_counts_too(analysis):
    analysis["first_order_interval"] *= 0
    found = largest_interval(analysis, ["time", "force"])
    assert found == (0.3, f"{widest('total-order', 'time to a')}, ± 0.3")


def test_without_any_index_there_is_none(analysis):
    half_width, words = largest_interval(analysis, ["still"])
    assert math.isnan(half_width)
    assert words == f"{STILL}no response has indices that more runs could narrow"


def test_a_gap_among_numbers_is_not_narrow(analysis):
    analysis["total_order_interval"][2, 1] = np.nan
    found = largest_interval(analysis, ["force", "time"])
    assert found == (math.inf, f"{widest('total-order', 'time to b')}, ± inf")
