"""The page of a verification: the verdict first, failures never folded away."""

from itertools import pairwise

import pytest

from impactlab.figures.draw import draw_findings
from impactlab.files import write_netcdf
from impactlab.report.results import FINDINGS, RUNS, open_stored, write_index
from impactlab.report.verification import write_verification
from impactlab.verification.outcomes import packed


@pytest.fixture
def told(tmp_path, page):
    """Writes a page, without figures, and reads it back."""

    def write(findings):
        (tmp_path / "captions.json").write_text("{}")
        write_verification(findings, tmp_path, tmp_path / "report.html")
        return page((tmp_path / "report.html").read_text("utf-8"))

    return write


def test_the_verdict_is_at_the_top_and_names_what_failed(told, findings):
    found = told(findings)
    assert "Verification failed" in found.text[:600]
    assert "3 checks did not pass: 3 of 21 comparisons of 4 checks are not within" in found.text
    assert "A bad check: uses infinitely much of its tolerance (" in found.text
    assert "A broken check: ValueError: <no> (a.py)" in found.text
    assert "A check of nothing: it compared nothing." in found.text
    headings = [row[0] for row in found.tables["All checks, failed ones first"][1:]]
    assert headings == ["A broken check", "A bad check", "A check of nothing", "A good check"]
    sections = [attrs["id"] for attrs in found.named("section")]
    assert sections[2:6] == ["broken", "bad", "void", "good"]
    # failed rows are open and passed ones folded
    found = told(findings)
    assert len(found.named("details")) == 2, "one of them the provenance"
    opened = found.source.index("<details>")
    closed = found.source.index("</details>")
    folded = found.source[opened:closed]
    assert "Passed: A bad check (15 comparisons)" in folded
    assert "FAILED" not in folded
    rows = found.tables["Failed: A bad check"][1:]
    assert [row[1] for row in rows] == ["diverged", "far off", "slightly off"]
    assert {row[-1] for row in rows} == {"FAILED"}
    assert rows[0][2] == "missing"
    # sources reasons and provenance are told
    found = told(findings)
    assert "Independent values: Hertz 1881." in found.text
    assert "ValueError: <no> (a.py)" in found.text  # escaped, not markup
    assert found.named("no") == []
    assert "1" * 64 in found.text
    assert "impactlab verify studies/verification.yaml" in found.text
    assert findings.attrs["study_text"].strip() in found.text


def test_all_passed_is_said_plainly(told, outcomes):
    found = told(packed(outcomes[:1]))
    assert (
        "All 3 comparisons of 1 check are within their tolerance; the closest, “A good"
        in found.text
    )
    assert "failed" not in found.text.replace("failed ones first", "").replace("0 failed", "")
    # no check at all is no success
    assert "Verification failed" in told(packed([])).text


def test_rows_tell_both_values_the_difference_and_the_tolerance(told, findings):
    head, *rows = told(findings).tables["Passed: A good check (3 comparisons)"]
    assert head == [
        "Quantity",
        "Case",
        "Ours",
        "Independent value",
        "Uncertainty of that",
        "Difference",
        "Tolerance",
        "Verdict",
    ]
    assert "Uncertainty of the independent values (closed form): rounding." in told(findings).text
    assert rows[0][2:] == ["21.0648 kN", "21.0647 kN", "10⁻¹² %", "0.00032 %", "0.01 %", "passed"]
    assert rows[1][2:] == ["1.2003 mm", "1.2 mm", "1.2×10⁻¹¹ µm", "0.3 µm", "2 µm", "passed"]
    assert rows[2][2:] == [
        "0.03 1/m",
        "0.031 1/m",
        "not known",
        "3.2 %of the peak",
        "10 %",
        "passed",
    ]


def test_the_page_is_sound_and_holds_its_figures(findings, tmp_path, page):
    draw_findings(findings, tmp_path)
    write_verification(findings, tmp_path, tmp_path / "report.html")
    found = page((tmp_path / "report.html").read_text("utf-8"))
    assert found.open == []
    told = [image["alt"].partition(". ")[0] for image in found.named("img")]
    assert told == ["All comparisons", "A bad check"]
    assert all(image["src"].startswith("data:") for image in found.named("img"))
    ids = [attrs["id"] for _, attrs in found.elements if "id" in attrs]
    assert len(ids) == len(set(ids))
    inside = {attrs["href"] for attrs in found.named("a")} - {"../index.html"}
    assert {href[1:] for href in inside} <= set(ids)
    levels = [int(tag[1]) for tag, _ in found.elements if tag in ("h1", "h2", "h3")]
    assert all(after - before <= 1 for before, after in pairwise(levels))


def test_the_index_lists_it_with_its_counts(results, findings, outcomes, page):
    for name, dataset in {"checks": findings, "sound": packed(outcomes[:1])}.items():
        (results / name).mkdir()
        (results / name / "report.html").touch()
        write_netcdf(dataset, results / name / "findings.nc", "findings")
    write_index(results, results / "index.html")
    text = page((results / "index.html").read_text("utf-8")).text
    assert "checks: 4 checks, 21 comparisons, 3 checks and 3 comparisons failed" in text
    assert "sound: 1 check, 3 comparisons, none failed" in text
    assert "6 runs (grid), none failed" in text


def test_stored_files_tell_their_kind(findings, results):
    path, runs = results / "findings.nc", results / "velocity" / "runs.nc"
    write_netcdf(findings, path, "findings")
    for kind, paths in (FINDINGS, [path]), (RUNS, [runs, runs.with_name("analysis.nc")]):
        with open_stored(paths) as (found, _):
            assert found is kind
        expected = r"{0}: expected {0}".format(paths[0].name.replace(".", r"\."))
        with pytest.raises(ValueError, match=expected), open_stored([paths[0]] * (3 - len(paths))):
            pass
