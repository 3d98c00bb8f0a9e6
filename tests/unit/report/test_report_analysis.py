"""Convergence and sensitivity in the report."""

import re

import numpy as np
from made_runs import FEW, few

from impactlab.figures.catalogue import CATALOGUE

NODES = "Convergence in nodes along the span: 17 points, Gauss-Lobatto"
POINTS = "Convergence in integration points over the depth: 401 nodes, Gauss-Lobatto"


def _row(page, table, head):
    return next(row for row in page.tables[table] if row[0].startswith(head))


def test_verdicts_and_the_largest_numbers_over_the_grid_are_told(report, discretisation_study):
    runs, analysis = few(discretisation_study)
    coarse = {"response": "peak_force", "points": runs["points"].min().item()}
    analysis["nodes_verdict"].loc[coarse] = 2
    analysis["nodes_uncertainty"].loc[coarse] = 0.5
    strain = {"response": "peak_plastic_strain"}
    analysis["nodes_observed_order"].loc[strain] = np.nan
    analysis["nodes_gci"].loc[strain] = np.inf
    analysis["points_needed"].loc[strain] = np.nan
    analysis["points_needed"].loc[{"response": "impulse", "velocity": 15.0}] = np.nan
    first = {"response": "peak_force", "velocity": analysis["velocity"].values[0]}
    analysis["nodes_gci"].loc[first] = 0.07
    analysis["nodes_uncertainty"].loc[first] = 1e-5
    page = report(runs, analysis)
    force = ["convergedbehaviour: monotone", "2", "7 %", "–", "–", "0.2 %"]
    assert _row(page, NODES, "Peak force")[1:] == force
    assert _row(page, NODES, "Peak plastic strain")[1] == "divergentbehaviour: divergent"
    assert _row(page, POINTS, "Peak plastic strain")[1] == "not yet converged"
    assert "meaning of divergent" in page.text
    assert len(page.tables[NODES]) == len(page.tables[POINTS]) == 1 + len(FEW)
    assert _row(page, NODES, "Peak plastic strain")[2:4] == ["–", "no bound"]
    assert _row(page, POINTS, "Peak plastic strain")[2] == "none of this study"
    assert _row(page, POINTS, "Impulse")[2] == "none of this study"


def test_limits_that_are_none_and_points_by_rule_are_told(report, discretisation_study):
    runs, analysis = few(discretisation_study)
    analysis["points_needed"].loc["impulse"].loc[{"rule": "layers", "velocity": 15.0}] = 17.0
    analysis["points_uncertainty"] = 0 * analysis["points_needed"] + 0.015
    flags = {"flag_meanings": "monotone stalled not_convergent_by_design"}
    analysis["nodes_behaviour"].attrs |= flags
    analysis["nodes_verdict"].attrs |= {
        "comment": "Space and time go together.",
        "without_limit": "peak_plastic_strain: it gathers\npeak_force: never so",
    }
    page = report(runs, analysis)
    assert "Space and time go together." in page.text
    assert "The peak plastic strain is not convergent by design: it gathers." in page.text
    assert "never so" not in page.text
    assert "behaviour: not convergent by design" in _row(page, NODES, "Peak plastic strain")[1]
    assert page.tables[POINTS][0][2:5] == [
        "Points needed for 1 %, Gauss-Lobatto",
        "Points needed for 1 %, Gauss-Legendre",
        "Points needed for 1 %, uniform layers",
    ]
    assert _row(page, POINTS, "Impulse")[2:] == ["5", "5", "17", "1.5 %"]


def test_the_time_step_has_a_table_and_a_caution(report, time_step_study):
    runs, analysis = few(time_step_study)
    analysis["time_step_verdict"].loc[{"response": "impulse"}] = 1
    page = report(runs, analysis)
    table = "Convergence in the time step at fixed nodes: 201 nodes, leapfrog"
    assert _row(page, table, "Peak force")[1:3] == ["converged", "2"]
    assert _row(page, table, "Peak force")[-1] == "0.01 %"
    assert _row(page, table, "Impulse")[1] == "divergent"
    assert NODES not in page.tables


def test_undefined_indices_are_said(report, sobol_study):
    page = report(*few(sobol_study))
    table = "Sobol indices, first order, with half-widths of the 95 % intervals"
    assert _row(page, table, "Number of contacts")[1:] == 4 * ["undefined"]
    assert _row(page, table, "Peak force")[1:4] == ["0.71 ± 0.03", "0.12 ± 0.03", "−0.01 ± 0.03"]
    assert re.search(r"Do not rely on the indices of: .*number of contacts \(constant\)", page.text)
    assert "meaning of constant" in page.text
    # unsound indices carry a warning
    runs, analysis = few(sobol_study)
    analysis["sensitivity_verdict"].loc[{"response": "impulse"}] = 2
    page = report(runs, analysis)
    assert re.search(r"Do not rely on the indices of: .*impulse \(failed runs\)", page.text)
    assert page.text.count("meaning of failed_runs") == 1


def test_the_confidence_is_that_of_the_analysis(report, sobol_study):
    runs, analysis = few(sobol_study)
    analysis.attrs["confidence"] = 0.9
    page = report(runs, analysis)
    assert "Sobol indices, total order, ± the half-width of the 90 % interval." in page.text
    assert "Sobol indices, first order, with half-widths of the 90 % intervals" in page.tables
    of_surrogates = "the lower end of the 95 % interval"  # the level that judges them
    assert "95 %" not in page.text.replace(of_surrogates, "")
    for name in ("sobol_indices", "sobol_second_order"):
        assert "90 % interval" in CATALOGUE[name].caption(runs, analysis)


def test_no_significant_share_is_said(report, sobol_study):
    runs, analysis = few(sobol_study)
    analysis["total_order_interval"][:] = 2.0
    page = report(runs, analysis)
    assert ": no parameter stands out from the noise" in page.text


def test_p_values_stand_below_the_indices_that_have_them(report, sobol_study):
    runs, analysis = few(sobol_study)
    for end in ("", "_interval"):
        analysis[f"hsic{end}"] = analysis[f"first_order{end}"]
    analysis["hsic_p_value"] = analysis["first_order"] * 0 + 0.0123
    page = report(runs, analysis)
    (table,) = (rows for name, rows in page.tables.items() if name.startswith("HSIC"))
    assert all(cell.endswith("p = 0.012") for cell in table[1][1:])
    sobol = next(rows for name, rows in page.tables.items() if name.startswith("Sobol"))
    assert not any("p = " in cell for row in sobol for cell in row)
