"""Errors against the most points, the points needed, and the verdicts on them."""

import numpy as np
import pytest

from impactlab.analysis.analyse import analyse
from impactlab.analysis.convergence import points as in_points

POINTS = [2, 3, 5, 9, 17]
CASES = [
    # value at each number of points, points needed, verdict
    ([3.0, 1.5, 1.05, 1.002, 1.0], 9, "converged"),
    ([3.0, 1.002, 1.05, 1.002, 1.0], 9, "converged"),
    ([1.0, 1.0, 1.0, 1.002, 1.0], 2, "converged"),
    ([3.0, 1.5, 1.05, 1.003, 1.0], 17, "converged"),  # 0.3 % off the most, they 0.9 % uncertain
    ([3.0, 1.5, 1.05, 1.005, 1.0], np.nan, "not_yet_converged"),
    ([3.0, 1.5, 1.3, 1.2, 1.0], np.nan, "not_yet_converged"),
    ([3.0, 1.0, 1.0, 1.2, 1.0], np.nan, "not_yet_converged"),
    ([0.0, 0.0, 0.0, 0.0, 0.0], 2, "at_round_off"),
    ([-4.0, -4.0, -4.0, -4.0, -4.0 - 1e-9], 2, "at_round_off"),
    ([1e-3, 1e-4, 0.0, 0.0, 0.0], 5, "converged"),
    ([np.nan, 0.0, 0.0, 0.0, 0.0], 3, "converged"),
    ([1e-3, 1e-4, 0.0, 1e-5, 0.0], np.nan, "not_yet_converged"),
    ([np.nan, 1.5, 1.0, 1.0, 1.0], 5, "converged"),
    ([3.0, np.nan, 1.0, 1.0, 1.0], 5, "converged"),
    ([3.0, 1.5, 1.0, np.nan, 1.0], np.nan, "undetermined"),
    ([3.0, 1.5, 1.0, 1.0, np.nan], np.nan, "undetermined"),
]


@pytest.mark.parametrize(("values", "needed", "verdict"), CASES)
def test_every_verdict(grid_runs, verdicts_of, values, needed, verdict):
    lookup = dict(zip(POINTS, values, strict=True))
    runs = grid_runs(
        {"points": POINTS}, peak_force=lambda points: [lookup[p] for p in points.values]
    )
    found = in_points.analysis(runs)
    assert found["points_needed"].item() == pytest.approx(needed, nan_ok=True)
    assert verdicts_of(found["points_verdict"]) == [verdict]
    assert np.isfinite(values[-1]) == bool((found["points_error"][0, -1] == 0).item())


def test_errors_are_relative_to_the_most_points(grid_runs, verdicts_of):
    runs = grid_runs(
        {"rule": ["lobatto", "layers"], "points": [9, 3, 33, 5], "velocity": [1.0, 2.0]},
        maximum_deflection=lambda rule, points, velocity: (
            -velocity * (1 + (rule == "layers") * points**-3.0)
        ),
    )
    found = in_points.analysis(runs)
    error = found["points_error"]
    assert error.dims == ("response", "rule", "points", "velocity")
    assert error["points"].values.tolist() == [9, 3, 33, 5]
    expected = (1 / 27 - 33**-3.0) / (1 + 33**-3.0)
    layers = error.sel(response="maximum_deflection", rule="layers")
    np.testing.assert_allclose(layers.sel(points=3), expected)
    assert (layers.sel(points=33) == 0).all()
    needed = found["points_needed"].sel(response="maximum_deflection")
    assert needed.dims == ("rule", "velocity")
    assert needed.values.tolist() == [[3, 3], [9, 9]]
    assert verdicts_of(found["points_summary"]) == ["converged"]
    assert verdicts_of(found["points_verdict"]) == [[["at_round_off"] * 2, ["converged"] * 2]]


def test_a_reference_of_zero_makes_other_values_infinitely_wrong(grid_runs):
    runs = grid_runs({"points": [2, 3]}, peak_plastic_strain=lambda points: 1e-3 * (points < 3))
    found = in_points.analysis(runs)
    assert found["points_error"].values.tolist() == [[np.inf, 0.0]]
    # uncertainty with the most points is relative
    runs = grid_runs({"points": [5, 3]}, peak_force=lambda points: 2.0 + 0.1 * (points < 5))
    found = in_points.analysis(runs)
    assert found["points_uncertainty"].item() == pytest.approx(0.15)


@pytest.mark.parametrize(("points", "applies"), [([3], False), ([3, 5], True)])
def test_needs_two_values(grid_runs, points, applies):
    runs = grid_runs({"points": points}, peak_force=lambda points: points)
    assert ("points_error" in analyse(runs)) is applies


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([1.0, 1.1, 0.8], [0.3, 0.3, 0.6]),
        ([1.0, 1.1, 1.0], [0.3, 0.3, 0.3]),  # a chance hit is no certainty
        ([1.0, 1.1, np.nan], [0.3, 0.3, np.inf]),
        ([1.0, np.nan, 1.1], [np.inf] * 3),
        ([1.0], [np.inf]),
    ],
)
def test_uncertainty_of_each_number_of_points(values, expected):
    np.testing.assert_allclose(in_points.numerical_uncertainty(values), expected)
