"""The answer that opens a report."""

import numpy as np
import samples
import xarray as xr

from impactlab.analysis.convergence import points
from impactlab.analysis.convergence.axes import NODES
from impactlab.figures.convergence import _NODES as NODES_FIGURE
from impactlab.report.answer import LINES, answers, entries
from impactlab.report.convergence import convergence


def test_of_a_sample_names_what_matters_with_share_interval_and_verdict():
    runs = samples.sample(64, 4)[["peak_force", "remote_plastic_strain", "status"]]
    analysis = samples.indices(runs)
    analysis["total_order_numerical"][:] = 0.0
    analysis["total_order"].loc["peak_force"] = [0.71, 0.12, 0.001, 0.0]
    analysis["total_order_interval"].loc["peak_force"] = [0.03, 0.02, 0.0001, 0.01]
    first, second, *_ = answers(runs, analysis)
    assert first.startswith(
        "Peak force (usable): impact velocity 71 % (± 3) of the variance, yield"
    )
    assert "yield stress of the beam 12 % (± 2)" in first
    assert first.count("%") == 2, "what holds less than 1 % of the largest is not named"
    assert second.startswith("Remote plastic strain (mostly constant): ")
    runs["peak_force"][:2] = np.nan
    assert answers(runs, analysis)[0].endswith("(± 2) (2 of 64 runs missing).")


def test_of_a_grid_gives_ranges_by_what_drives_them(velocity_study):
    lines = answers(*velocity_study)
    assert 1 <= len(lines) <= LINES
    assert lines[0].startswith("Impact velocity explains 95 to 100 % of the variation")
    assert ": peak force 2 to 193 kN, contact duration 0.212 to 0.528 ms" in lines[0]
    assert answers(velocity_study[0]) == lines, "runs alone are analysed"
    runs, analysis = velocity_study
    unknown = "The numerical uncertainty is not known"
    assert unknown in entries(runs, analysis)[1]
    names = list(runs.attrs["responses"])
    shares = xr.DataArray(np.full(len(names), 0.01), {"response": names}, "response")
    assert unknown not in entries(runs, analysis.assign(numerical_uncertainty=shares))[1]


def test_of_a_convergence_study_gives_the_least_grid_however_bad_others_are():
    nodes, counts = np.array([51, 101, 201, 401, 801]), np.array([2, 5, 9])
    smooth = 1.0 + 50.0 / (nodes - 1.0) ** 2
    wild = 1.0 + 0.1 * (-1.0) ** np.arange(5)
    force = np.array([wild, smooth + 0.001, smooth])
    strain = np.array([wild, wild, wild])
    runs = xr.Dataset(
        {
            "peak_force": (("points", "nodes"), 1e4 * force, {"units": "N"}),
            "remote_plastic_strain": (("points", "nodes"), strain, {"units": "1"}),
            "status": (("points", "nodes"), np.zeros((3, 5), np.int32)),
        },
        {"points": counts, "nodes": nodes},
        {"varied": ["points", "nodes"], "responses": ["peak_force", "remote_plastic_strain"]},
    )
    analysis = NODES.analysis(runs).assign(points.analysis(runs))
    first, second = answers(runs, analysis)
    assert first.startswith("Within 1 % from 101 nodes and 5 points: peak force (± 0.")
    assert first.endswith("observed order 2 in the nodes).")
    assert second == "On no grid of this study: remote plastic strain (divergent in nodes)."
    # the caption of the figure and the table of the report name the same grids
    caption = NODES_FIGURE.sentences(runs, analysis)[0]
    assert caption.endswith(
        ": peak force from 101 nodes and 5 points; remote plastic strain on no grid of this study."
    )
    rows = convergence(runs, analysis)[0].tables[0].rows
    assert rows[0][1] == "101 nodes and 5 points"
    assert "none of this study" in str(rows[1][1])
