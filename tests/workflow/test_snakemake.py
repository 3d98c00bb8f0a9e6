"""The whole workflow on the smoke study, in a copy of the checkout."""

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
import xarray as xr

from impactlab.files import write_netcdf
from impactlab.provenance import provenance
from impactlab.verification.finding import Comparisons, Finding, Outcome
from impactlab.verification.outcomes import packed

ROOT = Path(__file__).parents[2]
FEW = "peak_force, contact_duration, energy_error"


def snakemake(folder, *args, studies="smoke,checks"):
    """Run Snakemake, with the runs of each study in two parts."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    command = [sys.executable, "-m", "snakemake", "--cores", "2"]
    return subprocess.run(
        [*command, "--config", f"studies={studies}", "parts=2", *args],
        cwd=folder,
        env=os.environ | {"PATH": path},
        capture_output=True,
        text=True,
        timeout=500,
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A study, a verification, and another one whose findings are there and say that it failed."""
    copy = tmp_path_factory.mktemp("checkout")
    for name in ("impactlab", "studies", "workflow"):
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("Snakefile", "environment.yaml"):
        shutil.copy(ROOT / name, copy)
    smoke = copy / "studies" / "smoke.yaml"  # a panel per response takes a second to draw
    smoke.write_text(smoke.read_text().replace("responses: all", f"responses: [{FEW}]"))
    text = "title: Checks\nchecks: [half_space]\n"
    for name in ("checks", "bad"):
        (copy / "studies" / f"{name}.yaml").write_text(text)
    # Snakemake takes files newer than their sources as made
    [entry] = Comparisons("here").relative("peak force", "N", 2.0, 1.0, 0.1)
    outcome = Outcome("half_space", "Half-space", "made up", 0.0, Finding([entry]))
    findings = packed([outcome]).assign_attrs(study="bad", study_text=text, **provenance())
    write_netcdf(findings, copy / "results" / "bad" / "findings.nc", "findings")
    done = snakemake(copy, "--quiet", "all", "--keep-going", studies="smoke,checks,bad")
    assert done.returncode == 1, done.stderr
    (copy / "printed").write_text(done.stderr)
    return copy


def test_every_product_is_there(folder):
    results = folder / "results"
    index = (results / "index.html").read_text()
    for name in ("design.nc", "runs.nc", "analysis.nc", "report.html", "figures/captions.json"):
        assert (results / "smoke" / name).stat().st_size > 0
    for name in ("findings.nc", "report.html", "figures/captions.json"):
        assert (results / "checks" / name).stat().st_size > 0
    assert all(f"{study}/report.html" in index for study in ("smoke", "checks", "bad"))
    assert (results / "checks" / "passed").exists()
    assert not (results / "smoke" / "passed").exists()
    assert len([*results.glob("smoke/parts/*/*-of-2.npz")]) == 2
    assert "0 of them solved before" in (results / "smoke/logs/part-1-of-2.log").read_text()
    # a line per step names its study and the time left
    lines = (folder / "printed").read_text().splitlines()
    assert {"smoke: runs", "checks: verify"} <= {line.split("; ")[-1] for line in lines}
    assert not any("left" in line for line in lines[:2]), "nothing is known yet"
    index = r"\d+ of \d+ done, about \d+ s left; all studies: index"
    assert any(re.fullmatch(index, line) for line in lines)
    # failed checks come after the report
    results = folder / "results" / "bad"
    assert "half_space: 1 of 1 comparisons" in (folder / "printed").read_text()
    assert "Verification failed" in (results / "report.html").read_text()
    assert not (results / "passed").exists()
    assert "half_space" in (results / "logs" / "verdict.log").read_text()


def test_a_study_that_does_not_exist_is_named(folder):
    done = snakemake(folder, "--quiet", "all", studies="smoke,nowhere")
    assert done.returncode == 1
    assert "studies=nowhere: there is no such study; the folder studies/ has bad," in done.stderr


ALONE = """
import json, sys
import impactlab as il

names, velocities, nodes, duration, points, rule = json.loads(sys.argv[1])
grids = [il.Discretisation(nodes=number, points=points, rule=rule) for number in nodes]
runs = [
    il.simulate(il.paper_impact(velocity), grid, duration=duration)
    for grid in grids
    for velocity in velocities
]
print(json.dumps([[run[name].item() for name in names] for run in runs]))
"""


def test_a_comparison_is_made_where_all_of_its_studies_are(folder):
    three = "sobol_fast,sobol,sobol_slow"
    planned = snakemake(folder, "--dry-run", studies=three).stdout
    assert "results/sobol_velocities/report.html" in planned


def test_stored_runs_are_those_of_the_library(folder):
    """Bit by bit, in a process that is not this one, which has compiled some kernels itself."""
    runs = xr.load_dataset(folder / "results" / "smoke" / "runs.nc")
    names = FEW.split(", ")
    axes = [runs[name].values.tolist() for name in ("velocity", "nodes")]
    held = [runs[name].item() for name in ("duration", "points", "rule")]
    command = [sys.executable, "-c", ALONE, json.dumps([names, *axes, *held])]
    alone = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    stored = [runs[name].transpose("nodes", "velocity").values.ravel().tolist() for name in names]
    assert [list(row) for row in zip(*stored, strict=True)] == alone


def test_the_report_of_the_workflow_has_pages_and_figures(folder):
    done = snakemake(folder, "--report", "report.zip")
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(folder / "report.zip") as archive:
        names = {Path(name).name for name in archive.namelist()}
    assert {"report.html", "index.html", "contact_duration.svg"} <= names


def test_a_changed_study_reruns_alone(folder):
    """And one of the studies of a comparison makes none."""
    study = folder / "studies" / "checks.yaml"
    before = study.read_text()
    try:
        study.write_text(before.replace("half_space", "rigid_beam"))
        planned = snakemake(folder, "--dry-run", studies="smoke,checks,sobol").stdout
    finally:
        study.write_text(before)
    assert "results/checks/findings.nc" in planned
    assert "results/smoke/" not in planned.replace("results/smoke/report.html", "")
    assert "rule report:" in planned
    assert "rule comparison:" not in planned
