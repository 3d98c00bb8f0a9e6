from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import pytest

from impactlab.paper.page import write_paper
from impactlab.study.netcdf import write_netcdf

Study = Any


@pytest.fixture
def folder(velocity_study: Study, tmp_path: Path) -> Path:
    """A page from one study, stored under the name of the study for figure 8."""
    runs, analysis = velocity_study
    for name, dataset in (("runs", runs.drop_dims(["time", "x"])), ("analysis", analysis)):
        write_netcdf(dataset, tmp_path / "fig08" / f"{name}.nc")
    write_paper([tmp_path / "fig08", tmp_path / "fig05"], tmp_path / "paper")
    return tmp_path / "paper"


def test_page_tables_and_figures(folder: Path) -> None:
    from html.parser import HTMLParser  # the page must at least be read to its end

    text = (folder / "claims.html").read_text("utf-8")
    HTMLParser().feed(text)
    assert "Figure 8. Contact duration against velocity" in text
    assert (folder / "figures" / "figure_08.csv").exists()
    assert not (folder / "figures" / "figure_05a.svg").exists()
    assert "the study fig05 has not been solved" in text
    assert "10.929 kg" in text


def test_csv_has_one_row_per_judgement(folder: Path) -> None:
    with (folder / "claims.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {"nodes_suffice", "time_step"} < {row["claim"] for row in rows}
    masses = [row for row in rows if row["claim"] == "beam_mass"]
    assert [row["verdict"] for row in masses] == ["does not hold"]
    assert "ρ B H L: 10.148 kg" in masses[0]["numbers"]
    falls = [row for row in rows if row["claim"] == "duration_falls"]
    assert "nodes" in falls[0]["why"] or falls[0]["verdict"] == "cannot be judged"


def test_numbers_are_si(folder: Path) -> None:
    with (folder / "numbers.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    (span,) = (row for row in rows if row["number"] == "span of the printed mass")
    assert float(span["value"]) == pytest.approx(0.84, abs=1e-3)
    assert span["units"] == "m"
