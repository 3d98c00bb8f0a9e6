"""The tidy table of every index, as CSV and as netCDF."""

import csv

import numpy as np
import pytest
from SALib.sample import morris as morris_sampler

from impactlab.analysis.analyse import analyse
from impactlab.analysis.sensitivity.indices import COLUMNS, sensitivity_variables, table_rows
from impactlab.files import write_csv
from impactlab.methods.saltelli import saltelli

PROBLEM = {"num_vars": 3, "names": list("abc"), "bounds": [[0, 1]] * 3}


@pytest.fixture
def found(drawn, ishigami):
    unit = saltelli(PROBLEM["names"], 64, True, 7)
    outputs = ishigami.of_unit(unit)
    broken = np.where(outputs == outputs.max(), np.nan, outputs)
    named = {"peak_force": outputs, "impulse": broken}
    attrs = {"base_samples": 64, "second_order": 1, "analyses": ["sensitivity", "distribution"]}
    return analyse(drawn("sobol", unit, named, **attrs))


def test_every_index_has_a_row(found, tmp_path):
    write_csv(table_rows(found), COLUMNS, tmp_path / "new" / "indices.csv")
    with (tmp_path / "new" / "indices.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    # of two responses: 3 + 3 indices, 3 pairs, 4 sizes of 3 + 3, a correlation and its noise
    assert len(rows) == 2 * (6 + 3 + 24 + 2)
    (row,) = [
        row
        for row in rows
        if (row["index"], row["response"], row["parameter"]) == ("total_order", "peak_force", "x1")
    ]
    value = float(found["total_order"].sel(response="peak_force", parameter="x1"))
    margin = float(found["total_order_interval"].sel(response="peak_force", parameter="x1"))
    assert float(row["value"]) == value
    np.testing.assert_allclose(float(row["low"]), value - margin, rtol=1e-12)
    np.testing.assert_allclose(float(row["high"]), value + margin, rtol=1e-12)
    assert row["verdict"] == "wide_intervals"
    assert row["units"] == "1"
    assert (row["other_parameter"], row["base_samples"]) == ("", "")
    # what is not given is an empty cell
    write_csv(table_rows(found), COLUMNS, tmp_path / "indices.csv")
    lines = (tmp_path / "indices.csv").read_text("utf-8").splitlines()
    assert "impulse,x0,,,first_order,,,,1,failed_runs" in lines


def test_pairs_once_and_sizes(found, stored):
    rows = [row for row in table_rows(found) if row["response"] == "peak_force"]
    pairs = [
        (row["parameter"], row["other_parameter"]) for row in rows if row["index"] == "second_order"
    ]
    assert pairs == [("x0", "x1"), ("x0", "x2"), ("x1", "x2")]
    sizes = [row for row in rows if row["index"] == "first_order_by_samples"]
    assert [row["base_samples"] for row in sizes[::3]] == [8, 16, 32, 64]
    at = found["first_order_by_samples"].sel(response="peak_force", base_samples=16)
    assert [row["value"] for row in sizes[3:6]] == at.values.tolist()
    # netcdf holds what the table holds
    kept = stored(sensitivity_variables(found))
    assert {"first_order", "first_order_interval", "sensitivity_verdict"} <= set(kept)
    assert "mean" in found
    assert "mean" not in kept
    assert list(map(str, table_rows(kept))) == list(map(str, table_rows(found)))


def test_effects_have_the_unit_of_the_response(drawn):
    unit = morris_sampler.sample(PROBLEM, 20, seed=5)
    attrs = {"trajectories": 20, "levels": 4}
    found = analyse(drawn("morris", unit, unit @ [3.0, 2.0, 1.0], **attrs))
    (row,) = [
        row
        for row in table_rows(found)
        if (row["index"], row["parameter"]) == ("morris_mu_star", "x0")
    ]
    assert row["units"] == "N"
    np.testing.assert_allclose((row["value"], row["low"], row["high"]), 3.0, rtol=1e-12)


def test_a_grid_has_none(grid_runs):
    found = analyse(grid_runs({"velocity": [1.0, 2.0]}, peak_force=lambda velocity: velocity))
    assert not sensitivity_variables(found)
    assert list(table_rows(found)) == []
