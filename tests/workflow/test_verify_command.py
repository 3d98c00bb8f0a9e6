"""Checks from their file to the index, and one that fails."""

import re
from pathlib import Path

import pytest
import xarray as xr
from command_line import CHECKS, here
from command_line import done as impactlab

from impactlab.report.answer import answers
from impactlab.verification.catalogue import CATALOGUE
from impactlab.verification.finding import Check, Comparisons, Finding

pytestmark = pytest.mark.usefixtures("blank_pictures")


def test_checks_from_the_file_to_the_index(folder):
    said = impactlab("verify", "studies/checks.yaml", cwd=folder).stdout
    assert "half_space" in said
    assert re.search(r"\b(\d+) of \1\b", said)
    findings = folder / "results" / "checks" / "findings.nc"
    impactlab("figures", findings, cwd=folder)
    impactlab("report", findings, cwd=folder)
    impactlab("index", cwd=folder)
    assert "checks/report.html" in (folder / "results" / "index.html").read_text()
    assert "Verification passed" in findings.with_name("report.html").read_text()
    stored = xr.load_dataset(findings)
    assert said.count(answers(stored)[0]) == 1
    assert stored["ours"].values == pytest.approx(stored["independent"].values, rel=1e-4)


def passes():
    return Finding(Comparisons("here").relative("one", "1", 1.0, 1.0, 0.1))


def fails():
    entries = Comparisons("here").relative("one", "1", 1.0, 1.0, 0.1)
    return Finding([*entries, *Comparisons().relative("two", "1", 2.0, 1.0, 0.1)])


def breaks():
    raise RuntimeError("of all things")


def test_without_a_file_every_check_is_made(tmp_path, monkeypatch, capsys):
    for name in CATALOGUE:
        monkeypatch.setitem(CATALOGUE, name, Check(name, name, "made up", passes))
    monkeypatch.chdir(tmp_path)
    assert here("verify") == 0
    assert f"{len(CATALOGUE)} checks" in capsys.readouterr().out
    assert Path("results/verification/findings.nc").exists()


def test_failing_checks_are_told_everywhere(folder, monkeypatch, capsys):
    for name, check in {"bad": fails, "worse": breaks, "half_space": passes}.items():
        monkeypatch.setitem(CATALOGUE, name, Check(name, f"A {name} check", "made up", check))
    monkeypatch.chdir(folder)
    names = "half_space, bad, worse"
    (folder / "studies" / "checks.yaml").write_text(CHECKS.replace("half_space", names))
    findings = "results/checks/findings.nc"
    assert here("verify", "studies/checks.yaml") == 1
    said = capsys.readouterr()
    assert "half_space" in said.out
    assert "Traceback" not in said.err
    told = [said.err]
    assert here("figures", findings) == 0
    assert here("report", findings) == 0
    page = Path("results/checks/report.html").read_text()
    assert "Verification failed" in page
    assert '<a href="#bad">A bad check: failed</a>' in page
    assert '<a href="#worse">A worse check: error</a>' in page
    assert here("verify", "studies/checks.yaml", "--exit-zero") == 0
    told.append(capsys.readouterr().err)
    assert here("verify", findings) == 1
    told.append(capsys.readouterr().err)
    for words in ("bad: 1 of 2 comparisons", "worse: RuntimeError: of all things"):
        assert all(words in text for text in told)
