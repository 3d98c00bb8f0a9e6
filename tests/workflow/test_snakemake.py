"""The whole workflow on the smoke study, in a copy of the checkout."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr

import impactlab as il

ROOT = Path(__file__).parents[2]


def snakemake(folder, *args):
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    command = [sys.executable, "-m", "snakemake", "--cores", "2", "--config", "studies=smoke,again"]
    return subprocess.run(
        [*command, *args],
        cwd=folder,
        env=os.environ | {"PATH": path},
        capture_output=True,
        text=True,
        timeout=500,
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    copy = tmp_path_factory.mktemp("checkout")
    for name in ("impactlab", "studies", "workflow"):
        shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("Snakefile", "environment.yaml"):
        shutil.copy(ROOT / name, copy)
    smoke = (copy / "studies" / "smoke.yaml").read_text()
    (copy / "studies" / "again.yaml").write_text(smoke.replace("0.99 m/s", "2 m/s"))
    done = snakemake(copy)
    assert done.returncode == 0, done.stderr
    return copy


def test_every_product_is_there(folder):
    results = folder / "results"
    for study in ("smoke", "again"):
        assert f"{study}/report.html" in (results / "index.html").read_text()
        for name in ("design.nc", "runs.nc", "analysis.nc", "report.html", "figures/captions.json"):
            assert (results / study / name).stat().st_size > 0


def test_stored_runs_are_those_of_the_library(folder):
    runs = xr.load_dataset(folder / "results" / "smoke" / "runs.nc")
    grid = {"points": runs["points"].item(), "rule": runs["rule"].item()}
    for velocity in runs["velocity"].values:
        for nodes in runs["nodes"].values:
            alone = il.simulate(
                il.paper_impact(float(velocity)),
                il.Discretisation(nodes=int(nodes), **grid),
                duration=runs["duration"].item(),
            )
            stored = runs.sel(velocity=velocity, nodes=nodes)
            for name in ("peak_force", "contact_duration", "energy_error"):
                assert stored[name].item() == alone[name].item()


def test_a_finished_workflow_has_nothing_to_do(folder):
    assert "Nothing to be done" in snakemake(folder, "--dry-run").stdout


def test_a_changed_study_reruns_alone(folder):
    study = folder / "studies" / "again.yaml"
    before = study.read_text()
    try:
        study.write_text(before.replace("2 m/s", "3 m/s"))
        planned = snakemake(folder, "--dry-run").stdout
    finally:
        study.write_text(before)
    assert "results/again/runs.nc" in planned
    assert "results/smoke/" not in planned.replace("results/smoke/report.html", "")
