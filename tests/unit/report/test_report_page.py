"""The page as a whole: self-contained, well-formed, safe, and with its figures."""

from __future__ import annotations

import base64
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from impactlab.report.study import write_report

Study = Any
STUDIES = ("velocity_study", "material_study", "discretisation_study", "sobol_study")


@pytest.mark.parametrize("study", STUDIES)
def test_needs_nothing_else(study: str, report: Any, request: pytest.FixtureRequest) -> None:
    page = report(*request.getfixturevalue(study))
    assert page.open == []
    assert page.named("script") == page.named("link") == []
    for _, attrs in page.elements:
        assert attrs.get("src", "data:").startswith("data:")
        assert attrs.get("href", "#").startswith("#") or attrs["href"] == "indices.csv"
        assert "style" not in attrs
        assert not [key for key in attrs if key.startswith("on")]
    assert "@import" not in page.source
    assert "url(" not in page.source


@pytest.mark.parametrize("study", STUDIES)
def test_links_lead_somewhere_and_headings_step_by_one(
    study: str, report: Any, request: pytest.FixtureRequest
) -> None:
    page = report(*request.getfixturevalue(study))
    ids = [attrs["id"] for _, attrs in page.elements if "id" in attrs]
    assert len(ids) == len(set(ids))
    inside = {attrs["href"] for attrs in page.named("a")} - {"indices.csv"}
    assert inside <= {f"#{name}" for name in ids}
    levels = [int(tag[1]) for tag, _ in page.elements if tag in ("h1", "h2", "h3", "h4")]
    assert levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))


def test_figures_are_inside_numbered_and_described(results: Path, page: Any) -> None:
    found = page((results / "velocity" / "report.html").read_text("utf-8"))
    images = found.named("img")
    assert len(images) == 4
    assert images[0]["alt"].startswith("Contact force during the first contact. Hertz: 0.25 m/s")
    svg = base64.b64decode(images[0]["src"].removeprefix("data:image/svg+xml;base64,"))
    assert svg == (results / "velocity" / "figures" / "first_contact.svg").read_bytes()
    assert int(images[0]["width"]) == pytest.approx(1.3 * 183 / 25.4 * 96, abs=1)
    assert "Figure 2. Contact force against time." in found.text
    assert "Figure 4. Effect of the varied parameters." in found.text
    assert "Duration of the first contact (a later sub-impact does not count)" in found.text


def test_markup_in_a_study_is_text(report: Any, material_study: Study) -> None:
    runs, analysis = material_study
    nasty = '<script>alert("x")</script> & <b>bold</b>'
    for key in ("title", "description", "study_text", "source_revision"):
        runs.attrs[key] = nasty
    page = report(runs, analysis)
    assert page.named("script") == page.named("b") == []
    assert page.text.count(nasty) == 5  # the title stands in the head, too


def test_a_missing_figure_says_what_to_do(results: Path, velocity_study: Study) -> None:
    folder = results / "velocity" / "figures"
    (folder / "contact_duration.svg").unlink()
    with pytest.raises(FileNotFoundError, match=r"contact_duration\.svg is missing: draw"):
        write_report(*velocity_study, folder, results / "velocity" / "report.html")
    (folder / "captions.json").unlink()
    with pytest.raises(FileNotFoundError, match=r"captions\.json is missing: draw"):
        write_report(*velocity_study, folder, results / "velocity" / "report.html")


def test_tables_can_be_scrolled_by_keyboard_and_are_named(
    report: Any, material_study: Study
) -> None:
    page = report(*material_study)
    regions = [attrs for attrs in page.named("div") if attrs.get("role") == "region"]
    assert len(regions) == len(page.named("table")) > 3
    assert all(attrs["tabindex"] == "0" and attrs["aria-label"] for attrs in regions)
    assert all(attrs.get("scope") in ("row", "col") for attrs in page.named("th"))


def test_provenance_and_the_study_file_are_told(report: Any, material_study: Study) -> None:
    runs, analysis = material_study
    page = report(runs, analysis)
    for key in ("source_revision", "versions", "processor", "study_sha256", "study_text"):
        assert runs.attrs[key].strip() in page.text
    assert "2000-01-01 00:00:00 UTC" in page.text
    assert "impactlab run studies/material.yaml" in page.text
    assert "make study" in page.text
