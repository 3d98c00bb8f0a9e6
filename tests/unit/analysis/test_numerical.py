"""The numerical bound on an index holds for errors whose effect on it is known."""

import numpy as np
import pytest
import xarray as xr

from impactlab.analysis.numerical import numerical

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
