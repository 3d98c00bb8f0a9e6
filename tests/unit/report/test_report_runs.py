"""Sections on the runs: inputs, how the runs ended, and results."""

import numpy as np
from made_runs import few

from impactlab.analysis import distribution
from impactlab.variables import RESPONSES, STATUS_FLAGS, attributes

STRONGE = "Stronge, unloading after Wang et al."


def _row(page, table, head):
    return next(row for row in page.tables[table] if row[0].startswith(head))


def test_varied_and_fixed_parameters_with_units(report, material_study):
    page = report(*few(material_study))
    varied = _row(page, "Varied parameters", "Yield stress")
    assert varied[1:] == ["250, 345, 450, 600 MPa", "4", "beam_yield_stress"]
    fixed = "Parameters that are the same in every run"
    assert _row(page, fixed, "Span of the beam")[1] == "780 mm"
    assert _row(page, fixed, "Simulated time")[1] == "4 ms"
    assert _row(page, fixed, "Contact law")[1] == "Stronge, unloading after Wang et al."
    names = {row[-1] for row in page.tables[fixed]}
    assert "beam_yield_stress" not in names
    # a fixed parameter of a python function
    runs, analysis = few(material_study)
    runs = runs.assign_coords(gap=((), 0.003, {"long_name": "gap", "units": "m"}))
    # and a long grid is given by its range
    long = runs.isel(beam_yield_stress=np.tile([3, 1, 2, 0], 5))
    page = report(long, analysis)
    assert _row(page, fixed, "Gap")[1:] == ["3 mm", "gap"]
    row = _row(page, "Varied parameters", "Yield stress")
    assert row[1:3] == ["250 to 600 MPa", "20"]


def test_distributions_and_percentiles_of_a_sample(report, sobol_study):
    runs, analysis = few(sobol_study)
    whole = {"distribution": "integers", "low": 1, "high": 4, "step": 1}
    runs["beam_youngs_modulus"].attrs = attributes("beam_youngs_modulus") | whole
    runs["sphere_radius"].attrs = attributes("sphere_radius") | {
        "distribution": "lognormal",
        "median": 0.035,
        "geometric_standard_deviation": 1.1,
    }
    found = distribution.analysis(runs.assign_attrs(method="delta"))
    page = report(runs, analysis.merge(found, compat="override"))
    stress = _row(page, "Varied parameters", "Yield stress")
    assert stress[1] == "uniform: low 250 MPa, high 450 MPa"
    radius = _row(page, "Varied parameters", "Radius")
    assert radius[1] == "lognormal: median 35 mm, geometric standard deviation 1.1"
    assert _row(page, "Varied parameters", "Young")[1].startswith("integers: low ")
    row = _row(page, "Range of each response", "Peak force")
    force = runs["peak_force"] / 1e3
    expected = [force.mean(), force.std(ddof=1), *np.quantile(force, [0.05, 0.5, 0.95, 0, 1])]
    for cell, value in zip(row[2:9], expected, strict=True):  # with its interval below
        assert cell.startswith(f"{float(value):.4g}")


def test_failed_runs_are_counted_named_and_explained(report, velocity_study, failing):
    runs, analysis = few(velocity_study, "restitution")
    broken = failing(runs, {"velocity": 5, "contact": 1})
    bit, words = STATUS_FLAGS["sphere_not_leaving"]
    broken["status"][0, 0] = bit
    broken["restitution"][0, 0] = np.nan
    page = report(broken, analysis)
    assert "Of 16 runs, 1 failed, 1 without an answer." in page.text
    assert page.tables["Reasons for what is missing"][1:] == [
        ["The run diverged; every response is missing", "1"],
        [words[0].upper() + words[1:], "1"],
    ]
    first, second = page.tables["Runs without an answer"][1:]
    assert first[0] == "impact velocity = 0.25 m/s, contact law = Hertz"
    assert first[1] == words
    assert "restitution" in first[2]
    assert (
        second[0]
        == "impact velocity = 10 m/s, contact law = “Stronge, unloading after Wang et al.”"
    )
    assert second[2] == "all"
    assert "2 varied parameters · 0 figures · 1 failed, 1 without an answer" in page.text


def test_no_failure_is_said_plainly(report, velocity_study, failing):
    page = report(*few(velocity_study))
    assert not {"convergence", "sensitivity"} & {section["id"] for section in page.named("section")}
    assert "All 16 runs gave every response." in page.text
    assert "Reasons for what is missing" not in page.tables
    # a varied parameter may have one value left
    runs, analysis = few(velocity_study)
    page = report(failing(runs.isel(velocity=1), {"contact": 0}), analysis)
    assert _row(page, "Varied parameters", "Impact velocity")[1:3] == ["0.99 m/s", "1"]
    assert page.tables["Runs without an answer"][1][0] == "contact law = Hertz"


def test_failed_runs_of_a_sample_are_named_by_number(report, sobol_study, failing):
    runs, analysis = few(sobol_study)
    page = report(failing(runs, {"run": slice(10, 40)}), analysis)
    table = page.tables["Runs without an answer (the first 20 of 30)"]
    assert len(table) == 21
    assert table[1][0].startswith("run 10, impact velocity = ")


def test_ranges_of_a_grid_say_where(report, velocity_study, failing):
    runs, analysis = few(velocity_study)
    runs["impulse"] *= np.nan  # without any value: missing, not zero
    page = report(failing(runs, {"velocity": -1, "contact": 0}), analysis)
    assert _row(page, "Range of each response", "Impulse")[2:] == ["missing", "missing", "16"]
    row = _row(page, "Range of each response", "Peak force")
    assert row[0] == "Peak force" + RESPONSES["peak_force"].long_name
    largest = 1e-3 * float(runs["peak_force"].sel(velocity=20.0, contact="stronge"))
    assert row[1] == "kN"
    assert row[3] == f"{largest:.4g}impact velocity = 20 m/s, contact law = “{STRONGE}”"
    assert row[4] == "1"
    assert _row(page, "Range of each response", "Number of contacts")[2] == "2in every run"
