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


CONSTANT = "number_of_contacts has no indices (constant: it is still); "
WIDEST = "first-order index of contact_duration to velocity, ± 0.1"


@pytest.mark.parametrize(
    ("until", "counts", "reached", "reason"),
    [
        (
            {"interval": 0.1},
            [256, 512, 1024],
            1,
            f"{CONSTANT}the widest interval is that of the {WIDEST}, within 0.1",
        ),
        (
            {"interval": 0.01, "runs": 2047},
            [256, 512, 1024],
            0,
            f"{WIDEST}, above 0.01, but twice as many runs are more than 2,047",
        ),
        ({"interval": 0.01, "runs": 2048}, [256, 512, 1024, 2048], 0, "are more than 2,048"),
        ({"interval": 0.1, "responses": ["peak_force"]}, [256], 1, "± 0.1, within 0.1"),
        (
            {"responses": ["number_of_contacts"]},
            [256],
            0,
            f"{CONSTANT}no response has indices that more runs could narrow",
        ),
    ],
)
def test_the_sample_grows_until_the_widest_interval_is_narrow_enough(
    sample, solve, shrinking, until, counts, reached, reason
):
    """Or the next step has more runs than are allowed; N (D + 2) runs each time."""
    runs = extend_sample(sample(**until), solve, shrinking)
    assert solve.runs == counts
    assert runs.attrs["base_samples"] == counts[-1] // 4
    assert runs.attrs["until_reached"] == reached
    assert runs.attrs["until_reason"].endswith(reason)
    named = "contact_duration" in runs.attrs["until_reason"]
    assert named == ("responses" not in until)


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


@pytest.mark.parametrize(
    ("change", "responses", "half_width", "words"),
    [
        (None, "force still time", 0.5, f"{STILL}{widest('first-order', 'force to a')}, ± 0.5"),
        (None, "time", 0.4, f"{widest('first-order', 'time to b')}, ± 0.4"),
        ("no first", "time force", 0.3, f"{widest('total-order', 'time to a')}, ± 0.3"),
        ("gap", "force time", math.inf, f"{widest('total-order', 'time to b')}, ± inf"),
        (None, "still", math.nan, f"{STILL}no response has indices that more runs could narrow"),
    ],
)
def test_the_widest_is_named(analysis, change, responses, half_width, words):
    """A gap among numbers is not narrow; without any index there is no half-width."""
    if change == "no first":
        analysis["first_order_interval"] *= 0
    if change == "gap":
        analysis["total_order_interval"][2, 1] = np.nan
    expected = pytest.approx(half_width, rel=0, abs=0, nan_ok=True), words
    assert largest_interval(analysis, responses.split()) == expected
