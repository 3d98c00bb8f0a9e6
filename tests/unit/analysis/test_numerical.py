"""The bound on an index, or its measured uncertainty, holds errors whose effect on it is known."""

import numpy as np
import pytest
import xarray as xr

from impactlab.analysis.analyse import measured, numerical
from impactlab.study.adaptive.extension import refine_cases
from impactlab.study.design import design
from impactlab.study.schema.readers import study_of_text

RUNS = 4096
ATTRS = {"study": "some", "study_sha256": "f", "responses": ["y"]}
GRID = {"nodes": 101, "points": 9, "courant": 0.9}


def runs_of(y):
    data = {"y": ("run", y), "status": ("run", np.zeros(y.size, int))}
    return xr.Dataset(data, coords=GRID, attrs=ATTRS)


def resolution_of(amounts, **attrs):
    amounts = np.array([amounts])
    grid = {f"grid_{name}": value for name, value in GRID.items()}
    return xr.Dataset(
        {
            "grid_uncertainty": (("response", "case"), amounts),
            "grid_relative": ("response", [0.02]),
        },
        coords={"response": ["y"]},
        attrs=grid | {"study_sha256": "f"} | attrs,
    )


def first_order(x, y):
    """Var E[y | x]/Var y of x that takes few values, each as often."""
    means = [y[x == value].mean() for value in np.unique(x)]
    return np.var(means) / np.var(y)


@pytest.mark.parametrize("weight", [0.0, 0.1, 1.0, 3.0])
@pytest.mark.parametrize("sign", [-1, 1])
def test_no_error_of_that_size_moves_an_index_further(weight, sign):
    a, b = np.divmod(np.arange(RUNS), 64)
    y = weight * (a - 31.5) + (b - 31.5)
    error = 0.05 * sign * np.sign(a - 31.5) * y.std()  # all of it along a: the worst there is
    exact, moved = first_order(a, y), first_order(a, y + error)
    analysis = xr.Dataset(
        {"first_order": (("response", "parameter"), [[exact]])},
        coords={"response": ["y"], "parameter": ["a"]},
    )
    found = numerical(runs_of(y), analysis, resolution_of([0.05 * y.std()] * 3))
    assert found["numerical_share"].item() == pytest.approx(0.05**2)
    bound = found["first_order_numerical"].item()
    assert abs(moved - exact) <= bound * 1.06  # of first order in the error's own variance
    assert bound <= 2 * 0.05 + 0.05**2


def test_no_bound_is_infinite_and_no_error_is_none():
    analysis = xr.Dataset(
        {"total_order": (("response", "parameter"), [[0.5, np.nan]])},
        coords={"response": ["y"], "parameter": ["a", "b"]},
    )
    y = np.arange(10.0)
    unbounded = numerical(runs_of(y), analysis, resolution_of([0.1, np.inf]))
    assert np.isinf(unbounded["numerical_share"].item())
    assert unbounded["total_order_numerical"].values[0, 0] == 0.5  # it may still be 0 or 1
    assert unbounded["numerical_from"].attrs["flag_meanings"].split()[2] == "nothing"
    assert unbounded["numerical_from"].item() == 2
    assert np.isnan(unbounded["total_order_numerical"].values[0, 1])
    exact = numerical(runs_of(y), analysis, resolution_of([0.0, 0.0]))
    assert exact["total_order_numerical"].values[0, 0] == 0
    constant = numerical(runs_of(np.ones(10)), analysis, resolution_of([0.0, 0.0]))
    assert constant["numerical_share"].item() == 0


@pytest.mark.parametrize(
    "wrong", [{"grid_nodes": 201}, {"grid_courant": 0.5}, {"study_sha256": "g"}]
)
def test_a_resolution_of_other_runs_is_refused(wrong):
    with pytest.raises(ValueError, match=r"make it again \(impactlab recommend studies/some.yaml"):
        numerical(runs_of(np.arange(5.0)), xr.Dataset(), resolution_of([0.1], **wrong))


NODES, POINTS = 51, 9
LIMIT = np.array([3.0, 2.0, 1.0])
"""Slopes of a linear function at no spacing: its indices are the shares of their squares."""
UNIFORM = "{distribution: uniform, low: 1, high: 2}"
STUDY = f"""
title: Linear
impact: {{base: paper}}
discretisation: {{nodes: {NODES}, points: {POINTS}}}
duration: 1 ms
responses: [peak_force]
sampling:
  method: sobol
  base_samples: 256
  second_order: SECOND
  parameters: {{velocity: {UNIFORM}, gravity: {UNIFORM}, beam_width: {UNIFORM}}}
"""


def slopes(nodes, points, order):
    """The error falls with the spacing to this power, and with the points squared."""
    spacing = (NODES - 1) / (nodes - 1)
    by_points = np.array([0.2, 0.0, 0.0]) * (POINTS / points) ** 2
    return LIMIT + np.array([-0.3, 0.2, 0.1]) * spacing**order + by_points


def solver(order=1.0, common=0.0, own=1.0, lost=()):
    """common: an error that moves all runs alike, a spacing; own: of the slopes, times `slopes`'.

    lost: (grid, run) that fail.
    """

    def solve(asked):
        grids = zip(np.atleast_1d(asked["nodes"]), np.atleast_1d(asked["points"]), strict=True)
        slope = LIMIT + own * (np.array([slopes(*grid, order) for grid in grids]) - LIMIT)
        scale = 1.0 + common / (np.atleast_1d(asked["nodes"]) - 1)
        x = np.stack([asked[name].values for name in ("velocity", "gravity", "beam_width")])
        y = scale * (x.T @ slope.T)
        dims = ("run", "grid") if "grid" in asked.dims else ("run",)
        y = y if "grid" in asked.dims else y[:, 0]
        for grid, run in lost if "grid" in asked.dims else ():
            y[run, list(asked["grid"].values).index(grid)] = np.nan
        status = np.zeros(y.shape, int)
        return asked.assign(peak_force=(dims, y), status=(dims, status))

    return solve


def shares(slope):
    return slope**2 / (slope**2).sum()


def sample_of(solve, second="false"):
    return solve(design(study_of_text("some", STUDY.replace("SECOND", second))))


@pytest.mark.parametrize("order", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("second", ["false", "true"])
def test_the_indices_of_the_limit_are_within_the_uncertainty(order, second):
    solve = solver(order)
    refinement = refine_cases(sample_of(solve, second), solve)
    found = measured(refinement).sel(response="peak_force")
    here, finer = (shares(slopes(nodes, POINTS, order)) for nodes in (NODES, 2 * NODES - 1))
    for name in ("first_order", "total_order"):
        change, width = found[f"{name}_change"], found[f"{name}_change_interval"]
        assert (abs(change - (finer - here)) <= 1.5 * width + 1e-12).all()
        away = abs(shares(LIMIT) - here)
        assert (away <= found[name]).all()
        assert (found[name] <= 6 * away + 4 * width + 0.01).all()


def test_an_error_common_to_all_runs_moves_no_index():
    """It is the wide bound of such an error that a refinement takes away."""

    solve = solver(common=20.0, own=0.0)
    runs = sample_of(solve)
    found = measured(refine_cases(runs, solve))
    assert float(found["first_order"].max()) < 1e-12
    assert float(found["total_order"].max()) < 1e-12
    # one more coarse grid tells that the changes fall
    solve = solver(order=2.0)
    refinement = refine_cases(sample_of(solve), solve)
    with_it = measured(refinement)["total_order"]
    without = measured(refinement.sel(grid=["used", "finer", "more_points"]))["total_order"]
    change = abs(measured(refinement)["total_order_change"])
    np.testing.assert_allclose(without - with_it, (3.0 - 1.25) * change, rtol=1e-9)
    # Nodes change nothing here, for the runs of all grids but one are those of the used grid.
    solve = solver()
    refinement = refine_cases(sample_of(solve), solve)
    used = refinement["peak_force"].sel(grid="used", drop=True)
    more = refinement["grid"] == "more_points"
    refinement["peak_force"] = refinement["peak_force"].where(more, used)
    found = measured(refinement).sel(response="peak_force")
    few, many = (shares(slopes(NODES, points, 1.0)) for points in (POINTS, 10**6))
    assert (found["first_order_change"] == 0).all()
    assert (abs(many - few) <= found["total_order"]).all()
    assert found["total_order"].sel(parameter="velocity") >= 3 * 0.75 * abs(many - few)[0]


@pytest.mark.parametrize(("policy", "given"), [("fail", False), ("impute", True)])
def test_failed_runs_are_dealt_with_as_the_study_says(policy, given):
    solve = solver(lost=[("finer", 3)])
    runs = sample_of(solve).assign_attrs(failed_runs=policy)
    found = measured(refine_cases(runs, solve))
    assert bool(np.isfinite(found["first_order"]).all()) is given


def analysis_of(index):
    return xr.Dataset(
        {"total_order": (("response", "parameter"), [index])},
        coords={"response": ["peak_force"], "parameter": ["velocity", "gravity", "beam_width"]},
    )


def test_it_takes_the_place_of_the_bound_where_it_is_known():
    solve = solver()
    runs = sample_of(solve)
    found = numerical(runs, analysis_of([0.6, np.nan, 0.1]), None, refine_cases(runs, solve))
    expected = measured(refine_cases(runs, solve))["total_order"]
    amounts = found["total_order_numerical"].values[0]
    np.testing.assert_allclose(amounts, expected.values[0] * [1, np.nan, 1])
    assert found["numerical_from"].item() == 0
    failing = solver(lost=[("finer", 3)])
    left = numerical(runs, analysis_of([0.6, 0.3, 0.1]), None, refine_cases(runs, failing))
    assert left["numerical_from"].item() == 2
    np.testing.assert_array_equal(left["total_order_numerical"].values[0], [0.6, 0.7, 0.9])
    # a refinement of other runs is refused
    runs = sample_of(solver())
    other = refine_cases(sample_of(solver(common=1.0)), solver(common=1.0))
    with pytest.raises(ValueError, match=r"impactlab refine results/some/runs.nc"):
        numerical(runs, analysis_of([0.6, 0.3, 0.1]), None, other)
