from __future__ import annotations

from typing import Any

import numpy as np

Study = Any


def _row(page: Any, table: str, head: str) -> list[str]:
    return next(row for row in page.tables[table] if row[0].startswith(head))


def test_varied_and_fixed_parameters_with_units(report: Any, material_study: Study) -> None:
    page = report(*material_study)
    varied = _row(page, "Varied parameters", "Yield stress")
    assert varied[1:] == ["250, 345, 450, 600 MPa", "4", "beam_yield_stress"]
    fixed = "Parameters that are the same in every run"
    assert _row(page, fixed, "Span of the beam")[1] == "780 mm"
    assert _row(page, fixed, "Simulated time")[1] == "4 ms"
    assert _row(page, fixed, "Contact law")[1] == "Stronge"
    names = {row[-1] for row in page.tables[fixed]}
    assert "beam_yield_stress" not in names


def test_a_long_grid_is_given_by_its_range(report: Any, material_study: Study) -> None:
    runs, analysis = material_study
    long = runs.isel(beam_yield_stress=np.tile([3, 1, 2, 0], 5))
    row = _row(report(long, analysis), "Varied parameters", "Yield stress")
    assert row[1:3] == ["250 to 600 MPa", "20"]


def test_distributions_of_a_sample(report: Any, sobol_study: Study) -> None:
    runs, analysis = sobol_study
    runs["sphere_radius"].attrs = {
        "distribution": "lognormal",
        "median": 0.035,
        "geometric_standard_deviation": 1.1,
        "units": "m",
    }
    page = report(runs, analysis)
    stress = _row(page, "Varied parameters", "Yield stress")
    assert stress[1] == "uniform: low 250 MPa, high 450 MPa"
    radius = _row(page, "Varied parameters", "Radius")
    assert radius[1] == "lognormal: median 35 mm, geometric standard deviation 1.1"
