"""The page on the paper, with its figures and its tables of assessments and numbers."""

import csv
from html.parser import HTMLParser

import pytest

from impactlab.files import read_netcdf, write_netcdf
from impactlab.paper.claims import _summary, write_paper
from impactlab.paper.statements.statement import Assessment, Ruling


def test_page_tables_and_figures(velocity_study, tmp_path):
    """One study is solved; it is stored under the name of the study for figure 8."""
    runs, analysis = velocity_study
    path = tmp_path / "fig08" / "runs.nc"
    write_netcdf(runs.drop_dims(["time", "x"]), path, "runs")
    write_netcdf(analysis, path.with_name("analysis.nc"), "analysis", read_netcdf(path, "runs"))
    folder = tmp_path / "paper"
    write_paper([tmp_path / "fig08", tmp_path / "fig05"], folder)

    text = (folder / "claims.html").read_text("utf-8")
    HTMLParser().feed(text)  # the page must at least be read to its end
    assert "Figure 8. Contact duration against velocity" in text
    assert (folder / "figures" / "figure_08.csv").exists()
    assert not (folder / "figures" / "figure_05a.svg").exists()
    assert "the study fig05 has not been solved" in text
    assert "10.929 kg" in text

    claims = _rows(folder / "claims.csv")
    assert {"nodes_suffice", "time_step"} < {row["claim"] for row in claims}
    (mass,) = (row for row in claims if row["claim"] == "beam_mass")
    assert (mass["verdict"], mass["kind"]) == ("does not hold", "misprint")
    assert "ρ B H L: 10.15 ± 0.17 kg" in mass["numbers"]
    falls = next(row for row in claims if row["claim"] == "duration_falls")
    assert "nodes" in falls["why"] or falls["verdict"] == "cannot be judged"

    numbers = _rows(folder / "numbers.csv")
    (span,) = (row for row in numbers if row["number"] == "span of the printed mass")
    assert float(span["value"]) == pytest.approx(0.84, abs=1e-3)
    assert span["units"] == "m"


def test_statements_need_no_analysis(velocity_study, tmp_path, caplog):
    path = tmp_path / "fig08" / "runs.nc"
    write_netcdf(velocity_study[0].drop_dims(["time", "x"]), path, "runs")
    write_paper([path.parent], tmp_path / "paper")
    assert "fig08 holds no analysis.nc: its figures are left out" in caplog.text
    assert not list((tmp_path / "paper" / "figures").glob("figure_08*"))
    falls = [
        row for row in _rows(tmp_path / "paper/claims.csv") if row["claim"] == "duration_falls"
    ]
    assert falls
    assert not any("has not been solved" in row["why"] for row in falls)


def test_a_statement_is_summed_up_from_its_cases():
    verdicts = {
        (Ruling.HOLDS, Ruling.READING): "holds",
        (Ruling.READING, Ruling.HOLDS): "holds under the stated reading",
        (Ruling.READING, Ruling.UNKNOWN): "holds under the stated reading",
        (Ruling.HOLDS, Ruling.FAILS): "depends on the reading",
        (Ruling.UNKNOWN, Ruling.FAILS): "does not hold",
        (Ruling.UNKNOWN, Ruling.UNKNOWN): "cannot be judged",
    }
    for found, expected in verdicts.items():
        assert _summary([Assessment((), each, "") for each in found]) == expected


def _rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))
