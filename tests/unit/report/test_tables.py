"""Tables for people: the same numbers in every format, with units in the heads."""

import csv
import re
import shutil
import subprocess

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from samples import indices, sample

import impactlab as il
from impactlab.cli import results
from impactlab.report import tables
from impactlab.report.tables import export, table
from impactlab.verification.finding import Comparison, Finding, Outcome
from impactlab.verification.outcomes import packed

RUNS = sample(64, 3, failures=2).assign_attrs(title="Of 5 % & more_than_that")
ANALYSIS = indices(RUNS)
DIGITS = {"csv": 0.0, "xlsx": 1e-15, "parquet": 0.0}
"""Relative error of numbers read back: openpyxl writes 16 digits, as Excel does."""


def read(paths, kind, name):
    (path,) = [path for path in paths if kind == "xlsx" or path.stem == name]
    if kind == "csv":
        with path.open(encoding="utf-8", newline="") as file:
            return pd.DataFrame(
                [{key: cell(text) for key, text in row.items()} for row in csv.DictReader(file)]
            )
    return pd.read_parquet(path) if kind == "parquet" else pd.read_excel(path, sheet_name=name)


def cell(text):
    """A cell of a CSV file: pandas' own reader may lose the last bit of a number."""
    try:
        return float(text or "nan")
    except ValueError:
        return text


def same(column, array, kind):
    np.testing.assert_allclose(column, array.values.ravel(), rtol=DIGITS[kind], atol=0.0)


@pytest.mark.parametrize("kind", ["csv", "xlsx", "parquet"])
def test_files_hold_the_numbers_of_the_runs(tmp_path, kind):
    pytest.importorskip({"xlsx": "openpyxl", "parquet": "pyarrow"}.get(kind, "pandas"))
    paths = export(RUNS, ANALYSIS, tmp_path, kind, ["peak_force", "contact_duration"])
    runs, found = read(paths, kind, "runs"), read(paths, kind, "indices")
    assert runs.columns.tolist() == [
        "run",
        "velocity (m s-1)",
        "beam_yield_stress (Pa)",
        "beam_isotropic_hardening_modulus (Pa)",
        "peak_force (N)",
        "contact_duration (s)",
        "status",
    ]
    for name in ("velocity (m s-1)", "peak_force (N)", "contact_duration (s)"):
        same(runs[name], RUNS[name.partition(" (")[0]], kind)
    failed = RUNS["status"].values != 0
    assert failed.sum() == 2
    assert runs["status"][failed].eq("diverged").all()
    assert runs["status"][~failed].fillna("").eq("").all()
    wanted = ANALYSIS.sel(response=["peak_force", "contact_duration"])
    for name in ("first_order", "first_order_interval", "delta"):
        same(found[name], wanted[name], kind)
    assert found["parameter"].tolist() == 2 * ANALYSIS["parameter"].values.tolist()
    assert set(found["response"]) == {"peak_force", "contact_duration"}
    assert read(paths, kind, "answers")["answer"].tolist() == il.answers(RUNS, ANALYSIS)


def test_a_grid_has_a_row_per_combination_and_a_single_run_one():
    grid = il.Discretisation(nodes=21)
    varied = {"contact": ["hertz", "stronge"], "velocity": [1.0, 2.0, 3.0]}
    options = {"duration": "11 ms", "varied": varied, "combine": "product"}
    runs = il.simulate_many(il.paper_impact(), grid, **options)
    single = il.simulate(il.paper_impact(), grid, duration="11 ms")
    rows = table(runs, ["peak_force"]).set_index(["contact", "velocity (m s-1)"])
    assert len(rows) == 6
    picked = runs["peak_force"].sel(contact="stronge", velocity=2.0).item()
    assert rows.loc[("stronge", 2.0), "peak_force (N)"] == picked
    assert table(single)["peak_force (N)"].tolist() == [single["peak_force"].item()]


def test_a_verification_has_a_row_per_comparison(tmp_path, caplog):
    compared = Comparison("peak force", "at 1 m/s", "N", 21.5, 21.0, 0.02, 0.05)
    outcomes = [Outcome("hertz", "Hertz", "a book", 0.1, Finding([compared, compared], []), "")]
    findings = packed(outcomes).assign_attrs(study="checks", title="Checks", content="findings")
    rows = table(findings)
    assert rows.columns.tolist()[:5] == ["check", "quantity", "where", "units", "ours"]
    assert rows.loc[1].tolist()[:5] == ["hertz", "peak force", "at 1 m/s", "N", 21.5]
    names = [path.name for path in export(findings, None, tmp_path, "csv")]
    assert names == ["comparisons.csv", "answers.csv"]
    assert [path.name for path in export(findings, None, tmp_path, "latex")] == ["answers.tex"]
    assert "comparisons.tex: not written" in caplog.text


def test_names_and_kinds_that_do_not_exist(tmp_path, monkeypatch):
    with pytest.raises(ValueError, match=r"'peak_forc': unknown response; did you mean 'peak_fo"):
        table(RUNS, ["peak_forc"])
    with pytest.raises(ValueError, match="no sensitivity indices"):
        table(ANALYSIS[["numerical_uncertainty"]])
    with pytest.raises(ValueError, match=r"^to = 'doc': unknown format; .*csv, xlsx"):
        export(RUNS, ANALYSIS, tmp_path, "doc")
    with pytest.raises(ValueError, match=r"^--to = 'doc': unknown format; .*csv, xlsx"):
        results.export("made_up", to="doc")
    monkeypatch.setattr(tables, "find_spec", lambda package: None)
    with pytest.raises(OSError, match=r"needs openpyxl: pip install 'impactlab\[tables\]'"):
        export(RUNS, ANALYSIS, tmp_path, "xlsx")
    assert not any(tmp_path.iterdir())


def test_what_is_too_long_for_a_sheet_or_a_page(tmp_path, monkeypatch, caplog):
    pytest.importorskip("openpyxl")
    monkeypatch.setattr(tables, "_SHEET", 63)
    with pytest.raises(ValueError, match="64 rows, but a sheet has at most 63: take csv"):
        export(RUNS, ANALYSIS, tmp_path, "xlsx")
    monkeypatch.setattr(tables, "_PRINTED", 63)
    paths = export(RUNS, ANALYSIS[["numerical_uncertainty"]], tmp_path, "latex")
    assert [path.name for path in paths] == ["answers.tex"]
    assert "runs.tex: not written: the table is too long for print: take csv" in caplog.text


def test_a_text_that_looks_like_a_formula_is_none(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    frame = pd.DataFrame({"answer": ["=1+1", "plain"]})
    tables._write_workbook({"answers": frame}, tmp_path / "a.xlsx")
    cell = openpyxl.load_workbook(tmp_path / "a.xlsx")["answers"]["A2"]
    assert (cell.value, cell.data_type) == ("=1+1", "s")


def printed(text):
    """Format, heads and rows of a table in LaTeX."""
    formats = re.search(r"\\begin{longtable}{(.*)}\n", text)[1]
    columns = re.findall(r"S\[[^]]*\]|(?<=})p{[^}]*}|(?<![a-z])l", formats)
    head = re.search(r"\\toprule\n(.*) \\\\\n\\midrule", text)[1]
    body = text.split("\\endlastfoot\n")[1].split("\\end{longtable}")[0]
    rows = [re.split(r"(?<!\\) & ", row) for row in body.strip().split(" \\\\\n")]
    return (
        columns,
        head.split(" & "),
        [[cell.removesuffix(" \\\\") for cell in row] for row in rows],
    )


def test_latex_has_heads_with_units_and_numbers_that_fit_their_columns(tmp_path):
    paths = export(RUNS, ANALYSIS, tmp_path, "latex", ["peak_force", "peak_plastic_strain"])
    assert [path.name for path in paths] == ["runs.tex", "indices.tex", "answers.tex"]
    text = paths[0].read_text("utf-8")
    assert r"\caption{Runs: Of 5 \% \& more\_than\_that} \label{tab:sample-runs}" in text
    columns, heads, rows = printed(text)
    assert len(columns) == len(heads) == 7
    assert {len(row) for row in rows} == {7}
    assert heads[1] == r"{\shortstack{Impact\\velocity\\(\unit{m/s})}}"
    assert heads[2] == r"{\shortstack{Yield stress\\of the beam\\(\unit{MPa})}}"
    assert heads[4] == r"{\shortstack{Peak force\\(\unit{kN})}}"
    assert heads[5] == r"{\shortstack{Peak plastic\\strain\\(\unit{\percent})}}"
    forces = [row[4] for row in rows]
    failed = RUNS["status"].values != 0
    assert [force == "{--}" for force in forces] == failed.tolist()
    expected = RUNS["peak_force"].values[~failed] / 1e3
    numbers = [float(force) for force in forces if force != "{--}"]
    np.testing.assert_allclose(numbers, expected, rtol=5e-4)
    assert columns[4] == "S[table-format=2.2]"
    _, heads, rows = printed(paths[1].read_text("utf-8"))
    assert heads[:4] == ["{Response}", "{Parameter}", "{First order}", r"{$\pm$}"]
    assert rows[0][:2] == ["Peak force", "impact velocity"]
    value = ANALYSIS["first_order"].sel(response="peak_force", parameter="velocity")
    assert rows[0][2] == f"{value.item():.3f}"


@pytest.mark.parametrize(
    ("values", "units", "cells", "shape"),
    [
        ([0.5, 2.0, 0.25], "m s-1", ["0.5", "2", "0.25"], "1.2"),
        ([208.04e-6, 0.2e-3, 0.1e-3 / 3], "s", ["0.2080", "0.2000", "0.03333"], "1.5"),
        ([61.3e3, 145.99e3, -2.763e3], "N", ["61.30", "146.0", "-2.763"], "-3.3"),
        ([99999.6e3, 1.23456e3], "N", ["100000", "1.235"], "6.3"),
        ([0.5774, -0.0005, np.nan], "1", ["0.577", "-0.001", "{--}"], "-1.3"),
        ([3.0, 12.0, np.nan], "1", ["3", "12", "{--}"], "2.0"),
        ([1.5e-7, 3e-8], "1", ["1.500e-07", "3.000e-08"], "1.3e-2"),
    ],
)
def test_numbers_have_the_digits_and_units_of_print(values, units, cells, shape):
    column = xr.DataArray(values, attrs={"units": units, "label": "Some value"}, name="some")
    assert tables._column(column)[::2] == (cells, f"S[table-format={shape}]")


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="needs the command pdflatex")
def test_latex_compiles(tmp_path):
    paths = export(RUNS, ANALYSIS, tmp_path, "latex")
    inputs = "".join(rf"\input{{{path.stem}}}" for path in paths)
    packages = r"\usepackage{booktabs,longtable,siunitx}"
    document = rf"\documentclass{{article}}{packages}\begin{{document}}{inputs}\end{{document}}"
    (tmp_path / "all.tex").write_text(document)
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "all.tex"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:]
