"""The analyses that apply, and the way through netCDF."""

import sys
import tracemalloc
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab.analysis import ANALYSES, AnalysisEntry
from impactlab.analysis.analyse import analyse
from impactlab.analysis.surrogate import chaos
from impactlab.files import write_netcdf
from impactlab.methods import saltelli
from impactlab.study.steps import analyse_runs

IN_UNITS_OF_RESPONSES = (
    "nodes_extrapolated",
    "nodes_fit_extrapolated",
    "mean",
    "mean_interval",
    "standard_deviation",
    "standard_deviation_interval",
    "quantile",
    "quantile_low",
    "quantile_high",
)
AXES = {"rule": ["lobatto", "layers"], "nodes": [101, 51, 201], "points": [9, 3]}


@pytest.fixture
def discretisation(grid_runs):
    return grid_runs(
        AXES,
        peak_force=lambda rule, nodes, points: 1e4 * (1 + nodes**-2.0) * (1 + points**-4.0),
        peak_plastic_strain=lambda rule, nodes, points: 1e-6 * nodes * (rule == "lobatto"),
    )


@pytest.fixture
def sample(sample_runs):
    values = np.random.default_rng(3).normal(size=(2, 32 * 6))
    outputs = dict(zip(("peak_force", "impulse"), values, strict=True))
    return sample_runs(["velocity", "beam_depth"], 32, **outputs)


def test_a_grid_study_gets_both_axes(discretisation):
    found = analyse(discretisation)
    assert found["nodes_verdict"].dims == ("response", "rule", "points")
    assert found["points_verdict"].dims == ("response", "rule", "nodes")
    assert found["points_error"].dims == ("response", "rule", "nodes", "points")
    assert "first_order" not in found
    assert found.attrs == discretisation.attrs
    # coordinates keep their attributes
    found = analyse(discretisation)
    for name in ("nodes", "points", "rule", "beam_span"):
        assert found[name].attrs == discretisation[name].attrs != {}
    assert found["response"].attrs["long_name"]
    # only the wanted analyses are made
    found = analyse(discretisation.assign_attrs(analyses=["convergence_in_points"]))
    assert "points_verdict" in found
    assert "nodes_verdict" not in found


def test_a_sample_study_gets_indices(sample):
    found = analyse(sample)
    assert found["first_order"].dims == ("response", "parameter")
    assert not [name for name in found if str(name).startswith(("nodes", "points"))]
    assert "run" not in found.dims


def test_a_study_without_either_gets_its_responses_alone(grid_runs):
    runs = grid_runs({"velocity": [1.0, 2.0]}, peak_force=lambda velocity: velocity)
    found = analyse(runs)
    assert found["response"].values.tolist() == ["peak_force"]
    assert not found.data_vars
    # names a response that the runs do not hold
    runs = grid_runs({"velocity": [1.0, 2.0]}, peak_force=lambda velocity: velocity)
    runs.attrs["responses"] = ["peak_force", "impulse"]
    with pytest.raises(ValueError, match="hold no impulse"):
        analyse(runs)
    # histories are left alone
    runs = grid_runs({"nodes": [51, 101, 201]}, peak_force=lambda nodes: nodes**-2.0)
    runs["contact_force"] = (("nodes", "time"), np.ones((3, 4)))
    found: Any = analyse(runs)
    assert "time" not in found.dims


def test_a_new_analysis_is_one_line(discretisation, sample, monkeypatch):
    """Studies can ask for it, are told where it is impossible, and it is made."""
    largest = xr.Dataset({"largest": discretisation["peak_force"].max()})
    module = SimpleNamespace(analysis=lambda _: largest)
    monkeypatch.setitem(sys.modules, "impactlab.analysis.largest", module)
    entry = AnalysisEntry(
        "impactlab.analysis.largest", "a grid", lambda method, *_: method == "grid"
    )
    monkeypatch.setitem(ANALYSES, "largest", entry)
    depth = {"beam_depth": il.Uniform("26 mm", "29 mm"), "velocity": il.Uniform(1, 2)}
    given: Any = {"title": "New", "impact": il.paper_impact(), "duration": "1 ms"}
    given |= {"analyses": ["largest"], "responses": ["peak_force"]}
    study = il.Study(**given, sampling=il.Grid(parameters={"velocity": [1, 2]}))
    runs = discretisation.assign_attrs(analyses=list(study.declared.analyses))
    assert list(analyse(runs)) == ["largest"]
    assert "largest" not in analyse(sample)
    with pytest.raises(il.StudyError, match="largest needs a grid: take it out"):
        il.Study(**given, sampling=il.Pawn(samples=128, parameters=depth))


@pytest.mark.parametrize("study", ["discretisation", "sample"])
def test_through_netcdf(study, request, stored):
    runs = request.getfixturevalue(study)
    found = analyse(runs)
    again = stored(found)
    xr.testing.assert_equal(again, found)
    for name in found.variables:
        assert again[name].attrs.keys() == found[name].attrs.keys()
        for key, value in found[name].attrs.items():
            np.testing.assert_array_equal(again[name].attrs[key], value)
    for name in found.data_vars:
        assert again[name].dtype == found[name].dtype
    # and the same from stored runs, whose attributes netCDF has changed in type
    xr.testing.assert_identical(stored(analyse(stored(runs))).drop_attrs(), again.drop_attrs())


def test_one_response_and_one_parameter_survive_netcdf(sample_runs, stored):
    outputs = np.random.default_rng(5).normal(size=32 * 3)
    runs = sample_runs(["velocity"], 32, second_order=False, peak_force=outputs)
    found = analyse(stored(runs))
    assert found["response"].values.tolist() == ["peak_force"]
    assert found["parameter"].values.tolist() == ["velocity"]


def test_every_variable_is_described(discretisation, sample):
    for runs in (discretisation, sample):
        for name, variable in analyse(runs).data_vars.items():
            assert variable.attrs["long_name"]
            if "flag_values" in variable.attrs:
                flags = variable.attrs["flag_meanings"].split()
                described = variable.attrs["flag_descriptions"].splitlines()
                assert variable.dtype == variable.attrs["flag_values"].dtype == np.int8
                assert [line.partition(": ")[0] for line in described] == flags
            elif "flag_masks" not in variable.attrs and name not in IN_UNITS_OF_RESPONSES:
                assert variable.attrs["units"] == "1"


@pytest.mark.long
def test_a_sample_is_analysed_one_response_at_a_time(sample_runs, tmp_path, monkeypatch):
    """Memory holds fewer than 6 columns; the responses and parameters of the runs are 12."""
    monkeypatch.setattr(saltelli, "_ROWS", 1024)
    monkeypatch.setattr("impactlab.methods.runs._CELLS", 10_000)
    monkeypatch.setattr(chaos, "MOST_RUNS", 100)
    names, parameters = [f"y{at}" for at in range(6)], ["x0", "x1", "x2", "x3", "x4", "x5"]

    def peak(base):
        random = np.random.default_rng(1)
        outputs = {name: random.normal(size=base * 8) for name in names}
        runs = sample_runs(parameters, base, second_order=False, **outputs)
        for name in parameters:
            runs[name].attrs = {"distribution": "uniform", "low": 1.0, "high": 2.0}
        write_netcdf(runs, tmp_path / "runs.nc", "runs")
        del runs, outputs
        tracemalloc.start()
        found = analyse_runs(tmp_path / "runs.nc", tmp_path / "analysis.nc")
        assert {"first_order", "surrogate_q2"} <= found.keys()
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return most

    peak(64)  # whatever is loaded once
    assert peak(1 << 14) < 6 * 8 * (8 << 14)
