"""Pages as a whole, self-contained, well-formed and safe; their figures, and the index."""

import base64
from itertools import pairwise
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest
import xarray as xr
from made_runs import few
from ruamel.yaml import YAML

from impactlab.files import read_netcdf, write_netcdf
from impactlab.report.answer import answers
from impactlab.report.page import drawn_data
from impactlab.report.results import RUNS, open_stored, write_index
from impactlab.report.study import write_report

OUTSIDE = {"indices.csv", "../index.html"}
STUDIES = ("velocity_study", "material_study", "discretisation_study", "sobol_study")


@pytest.mark.parametrize("study", STUDIES)
def test_a_page_needs_nothing_else_and_can_be_read_by_keyboard(study, report, request):
    page = report(*few(request.getfixturevalue(study)))
    assert page.open == []
    assert page.named("script") == page.named("link") == []
    for _, attrs in page.elements:
        assert attrs.get("src", "data:").startswith("data:")
        assert attrs.get("href", "#").startswith("#") or attrs["href"] in OUTSIDE
        assert "style" not in attrs
        assert not [key for key in attrs if key.startswith("on")]
    assert "@import" not in page.source
    assert "url(" not in page.source
    ids = [attrs["id"] for _, attrs in page.elements if "id" in attrs]
    assert len(ids) == len(set(ids))
    inside = {attrs["href"] for attrs in page.named("a")} - OUTSIDE
    assert inside <= {f"#{name}" for name in ids}
    levels = [int(tag[1]) for tag, _ in page.elements if tag in ("h1", "h2", "h3", "h4")]
    assert levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))
    regions = [attrs for attrs in page.named("div") if attrs.get("role") == "region"]
    assert len(regions) == len(page.named("table")) > 3
    assert all(attrs["tabindex"] == "0" and attrs["aria-label"] for attrs in regions)
    assert all(attrs.get("scope") in ("row", "col") for attrs in page.named("th"))


def test_figures_are_inside_numbered_and_described(results, page):
    found = page((results / "velocity" / "report.html").read_text("utf-8"))
    images = found.named("img")
    assert len(images) == 4
    assert images[0]["alt"].startswith("Effect of the varied parameters. Contact duration")
    svg = base64.b64decode(images[0]["src"].removeprefix("data:image/svg+xml;base64,"))
    assert svg == (results / "velocity" / "figures" / "parameter_effects.svg").read_bytes()
    assert int(images[0]["width"]) == pytest.approx(1.3 * 89 / 25.4 * 96, abs=1)
    assert "Figure 2. Contact force during the first contact." in found.text
    assert "Figure 1. Effect of the varied parameters" in found.text
    assert "Duration of the first contact (a later sub-impact does not count)" in found.text


def test_markup_in_a_study_is_text(report, material_study):
    runs, analysis = few(material_study)
    nasty = '<script>alert("x")</script> & <b>bold</b>'
    for key in ("title", "description", "study_text", "source_revision"):
        runs.attrs[key] = nasty
    page = report(runs, analysis)
    assert page.named("script") == page.named("b") == []
    assert page.text.count(nasty) == 6  # title and revision stand in head and foot, too


def test_a_missing_figure_says_what_to_do(results, velocity_study):
    folder = results / "velocity" / "figures"
    (folder / "contact_duration.svg").unlink()
    with pytest.raises(FileNotFoundError, match=r"contact_duration\.svg is missing: draw"):
        write_report(*velocity_study, folder, results / "velocity" / "report.html")
    (folder / "captions.json").unlink()
    with pytest.raises(FileNotFoundError, match=r"captions\.json is missing: draw"):
        write_report(*velocity_study, folder, results / "velocity" / "report.html")


def test_provenance_and_the_study_file_are_told(report, material_study):
    runs, analysis = few(material_study)
    runs.attrs |= {"study_file": "../../studies/material.yaml", "versions": "impactlab 9.8, numpy"}
    page = report(runs, analysis)
    for key in ("source_revision", "versions", "processor", "study_sha256", "study_text"):
        assert runs.attrs[key].strip() in page.text
    assert "2000-01-01 00:00:00 UTC" in page.text
    assert "impactlab run studies/material.yaml" in page.text
    assert "make study" in page.text
    # the foot cites, names the file and leads to the index
    citation = YAML(typ="safe").load(Path(__file__).parents[3] / "CITATION.cff")
    made = f"studies/material.yaml (SHA-256 {runs.attrs['study_sha256'][:12]}…) by impactlab 9.8"
    foot = page.text[page.text.index("All results") :]
    assert made in foot
    assert " ".join(citation["message"].split()) in foot
    assert f"{citation['authors'][0]['name']}: impactlab, version {citation['version']}." in foot
    assert "../index.html" in {attrs["href"] for attrs in page.named("a")}


def test_the_data_of_a_figure_are_thinned_evenly(tmp_path):
    lines = ["panel,curve,x_label,y_label,category,x,y"]
    for curve in ("one", "two"):
        lines += [f"Force,{curve},Time (ms),Force (kN),,{at},{at * at}" for at in range(200)]
    (tmp_path / "figure.csv").write_text("\n".join(lines))
    table = drawn_data(tmp_path / "figure.csv")
    assert table.caption == "Data as drawn (80 of 400 points)"
    assert table.head == ["Panel", "Curve", "Time (ms)", "Force (kN)"]
    assert [getattr(cell, "text", cell) for cell in table.rows[1]] == ["Force", "one", "5", "25"]
    assert [getattr(cell, "text", cell) for cell in table.rows[40]] == ["Force", "two", "0", "0"]
    # the data of named bars are all told
    lines = ["panel,curve,x_label,y_label,category,x,y"]
    lines += [f"Force,first order,Share (–),,parameter {at},0.5,{at}" for at in range(100)]
    (tmp_path / "figure.csv").write_text("\n".join(lines))
    table = drawn_data(tmp_path / "figure.csv")
    assert table.head == ["Panel", "Curve", "Of", "Share (–)"]
    assert len(table.rows) == 100


def _index(results, page, path=None):
    path = path or results / "index.html"
    write_index(results, path)
    return page(path.read_text("utf-8"))


def test_links_every_report(results, page):
    found = _index(results, page)
    assert found.open == []
    links = [attrs["href"] for attrs in found.named("a") if not attrs["href"].startswith("#")]
    assert links == ["velocity/report.html"]
    assert "The velocity study" in found.text
    assert "6 runs (grid), none failed" in found.text
    with open_stored([results / "velocity" / name for name in RUNS.files]) as (_, datasets):
        assert answers(*datasets)[0] in found.text
    # addresses are relative and exist
    home = results.parent / "elsewhere" / "index.html"
    found = _index(results, page, home)
    addresses = [attrs["src"] for attrs in found.named("img")]
    addresses += [a["href"] for a in found.named("a") if not a["href"].startswith("#")]
    assert len(addresses) == 2
    assert all((home.parent / unquote(address)).is_file() for address in addresses)
    assert found.named("img")[0]["alt"] == "Effect of the varied parameters"
    # folders without a report are left out
    (results / "half").mkdir()
    (results / "half" / "runs.nc").touch()
    (results / "other").mkdir()
    (results / "other" / "report.html").touch()
    assert len(_index(results, page).named("li")) == 1


def _rewrite(runs, path):
    """Write other runs, and the same analysis as made from them."""
    analysis = path.with_name("analysis.nc")
    write_netcdf(runs, path, "runs")
    found = read_netcdf(analysis, "analysis")
    write_netcdf(found, analysis, "analysis", read_netcdf(path, "runs"))


def test_failures_are_told(results, page, failing):
    path = results / "velocity" / "runs.nc"
    runs = xr.load_dataset(path)
    runs = failing(runs.assign(impulse=runs["contact_duration"]), {"velocity": 0, "contact": 0})
    runs["contact_duration"][1, 0] = np.nan
    _rewrite(runs, path)
    assert "6 runs (grid), 1 failed, 1 without an answer" in _index(results, page).text


def test_markup_and_odd_names_do_no_harm(results, page):
    odd = results / 'a "b" #1'
    (results / "velocity").rename(odd)
    runs = xr.load_dataset(odd / "runs.nc")
    _rewrite(runs.assign_attrs(title="<i>T</i>"), odd / "runs.nc")
    found = _index(results, page)
    assert found.named("i") == []
    assert "<i>T</i>" in found.text
    link = next(a["href"] for a in found.named("a") if not a["href"].startswith("#"))
    assert (results / unquote(link)).is_file()


def test_an_empty_folder_says_what_to_do(tmp_path, page):
    assert "make study" in _index(tmp_path, page).text
