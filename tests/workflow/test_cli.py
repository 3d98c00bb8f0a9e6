"""The command line as a person uses it: errors speak, nothing is lost."""

import os
import re
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest
import xarray as xr

from impactlab.cli import main
from impactlab.verification.catalogue import CATALOGUE
from impactlab.verification.finding import Finding, relative

STUDY = """
title: Small
description: For a test.
impact: {base: paper}
discretisation: {nodes: 21, points: 3}
duration: 1 ms
sampling:
  method: grid
  parameters:
    velocity: [0.5, 1.0, 2.0]
    nodes: [11, 21, 41]
responses: [peak_force, contact_duration]
"""
GROWING = """
title: Growing
impact: {base: paper, beam_model: rigid}
duration: 1 ms
sampling:
  method: sobol
  base_samples: 64
  second_order: false
  seed: 0
  until: {interval: 0.001, runs: 600}
  parameters:
    velocity: {distribution: uniform, low: 1 m/s, high: 2 m/s}
    sphere_density: {distribution: uniform, low: 7000, high: 8000}
responses: [peak_force]
"""
CHECKS = """
title: Checks
checks: [half_space]
"""


def impactlab(*args, cwd):
    command = [sys.executable, "-m", "impactlab", *map(str, args)]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "small.yaml").write_text(STUDY)
    (tmp_path / "studies" / "checks.yaml").write_text(CHECKS)
    return tmp_path


def test_every_step_without_snakemake(folder):
    impactlab("run", "studies/small.yaml", cwd=folder)
    results = folder / "results" / "small"
    impactlab("analyse", results / "runs.nc", cwd=folder)
    impactlab("figures", results / "runs.nc", results / "analysis.nc", cwd=folder)
    impactlab("report", results / "runs.nc", results / "analysis.nc", cwd=folder)
    impactlab("index", cwd=folder)
    assert "small/report.html" in (folder / "results" / "index.html").read_text()
    assert xr.load_dataset(results / "runs.nc")["peak_force"].sel(velocity=2, nodes=41) > 1e4


def test_a_sample_grows_and_solves_nothing_twice(folder):
    """First in two steps, then from a design in a file: the answers are in the shards by then."""
    (folder / "studies" / "growing.yaml").write_text(GROWING)
    grown = impactlab("run", "studies/growing.yaml", cwd=folder).stderr
    counts = [int(count) for count in re.findall(r"(\d+) runs, \d+ of them solved before", grown)]
    before = [int(count) for count in re.findall(r"(\d+) of them solved before", grown)]
    assert counts == [256, 512]
    assert before == [0, 256]
    assert "more than 600" in grown
    impactlab("design", "studies/growing.yaml", cwd=folder)
    again = impactlab("run", "results/growing/design.nc", cwd=folder).stderr
    assert "512 runs, 512 of them solved before" in again
    attrs = xr.load_dataset(folder / "results" / "growing" / "runs.nc").attrs
    assert attrs["base_samples"] == 128
    assert attrs["until_reached"] == 0


SAMPLE = """
title: Sample
impact: {base: paper}
discretisation: {nodes: 21, points: 3}
duration: 0.5 ms
sampling:
  method: sobol
  base_samples: 16
  parameters:
    velocity: {distribution: uniform, low: 0.2, high: 0.4}
    beam_depth: {distribution: uniform, low: 27 mm, high: 28 mm}
responses: [peak_force]
"""


def test_a_sample_predicts_what_was_not_solved(folder):
    (folder / "studies" / "sample.yaml").write_text(SAMPLE)
    impactlab("run", "studies/sample.yaml", cwd=folder)
    impactlab("analyse", "results/sample/runs.nc", cwd=folder)
    file = folder / "results" / "sample" / "surrogate.nc"
    said = impactlab("predict", file, "velocity=30 cm/s", "beam_depth=27.8 mm", cwd=folder).stdout
    value, error = re.search(r"peak_force\D+([\d.]+)\s*│\s*N\s*│\s*([\d.]+)", said).groups()
    arguments = ["--velocity", 0.3, "--nodes", 21, "--points", 3, "--duration", "0.5 ms"]
    solved = impactlab("simulate", *arguments, cwd=folder).stdout
    expected = float(re.search(r"peak_force\D+([\d.]+)", solved)[1])
    assert float(value) == pytest.approx(expected, abs=5 * float(error))
    assert float(error) < 0.01 * expected
    runs = file.with_name("runs.nc")
    xr.load_dataset(runs).assign_attrs(analyses="sensitivity").to_netcdf(runs)
    impactlab("analyse", runs, cwd=folder)
    assert not file.exists()  # it would be that of another analysis


def test_a_sample_is_refined_and_tells_its_numerical_error(folder):
    (folder / "studies" / "sample.yaml").write_text(SAMPLE)
    impactlab("run", "studies/sample.yaml", cwd=folder)
    results = folder / "results" / "sample"
    # 16 base samples of 4 runs on 3 grids, in a folder of their own
    said = impactlab("refine", results / "runs.nc", cwd=folder).stderr
    assert "192 runs, 0 of them solved before" in said
    refinement = results / "refinement.nc"
    impactlab("analyse", results / "runs.nc", "--refinement", refinement, cwd=folder)
    analysis = xr.load_dataset(results / "analysis.nc")
    assert analysis["numerical_from"].item() == 0
    assert (analysis["first_order_numerical"] < 0.2).all()
    assert "first_order_numerical" in (results / "indices.csv").read_text()


def test_indices_of_a_sample_are_told_beside_its_analysis(folder):
    grid = STUDY[STUDY.index("  method") : STUDY.index("responses")]
    drawn = """  method: sobol
  base_samples: 8
  parameters:
    velocity: {distribution: uniform, low: 1 m/s, high: 2 m/s}
    beam_depth: {distribution: uniform, low: 26 mm, high: 29 mm}
"""
    (folder / "studies" / "indices.yaml").write_text(STUDY.replace(grid, drawn))
    impactlab("run", "studies/indices.yaml", cwd=folder)
    results = folder / "results" / "indices"
    impactlab("analyse", results / "runs.nc", cwd=folder)
    head, first, *_ = (results / "indices.csv").read_text().splitlines()
    assert head.startswith("response,parameter,other_parameter,base_samples,index,value,low,high")
    assert first.startswith("peak_force,velocity,,,first_order,")
    stored = xr.load_dataset(results / "indices.nc")["first_order"]
    assert stored.sel(response="peak_force", parameter="velocity") == float(first.split(",")[5])


def test_studies_are_listed(folder):
    listed = impactlab("studies", cwd=folder).stdout
    assert "small" in listed
    assert "9 runs" in listed
    assert "Small" in listed
    assert "1 check" in listed


def test_simulate_prints_and_keeps(tmp_path):
    done = impactlab(
        "simulate", "--nodes", 101, "--duration", "0.5 ms", "--output", "one.nc", cwd=tmp_path
    )
    assert "peak_force" in done.stdout
    assert "11748" in done.stdout
    one = xr.load_dataset(tmp_path / "one.nc")
    assert one["peak_force"].attrs["units"] == "N"


def test_simulate_takes_a_scheme(tmp_path):
    leapfrog, semi_implicit = (
        impactlab("simulate", "--nodes", 101, "--scheme", scheme, cwd=tmp_path).stdout
        for scheme in ("leapfrog", "semi_implicit")
    )
    assert leapfrog != semi_implicit
    assert "11748" in leapfrog
    assert "11748" in semi_implicit


def loaded(*args, cwd):
    """The packages that a command loads."""
    command = [sys.executable, "-X", "importtime", "-m", "impactlab", *args]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stderr.splitlines() if line.startswith("import time:")]
    return {line.split("|")[-1].strip().split(".")[0] for line in lines}


HEAVY = {"dask", "distributed", "matplotlib", "netCDF4", "pandas", "pint", "ruamel", "xarray"}
ONE = ("simulate", "--nodes", "11", "--velocity", "99 cm/s")


def test_help_loads_nothing_heavy(tmp_path):
    packages = loaded("--help", cwd=tmp_path)
    assert "typer" in packages
    assert packages.isdisjoint(HEAVY | {"numba", "numpy", "pydantic", "rich", "scipy"})


def test_simulate_loads_no_more_than_it_needs(tmp_path):
    packages = loaded(*ONE, cwd=tmp_path)
    assert "numba" in packages
    assert packages.isdisjoint(HEAVY)
    assert {"netCDF4", "xarray"} <= loaded(*ONE, "--output", "one.nc", cwd=tmp_path)


def test_only_what_solves_loads_the_compiler(folder):
    assert "numba" not in loaded("design", "studies/small.yaml", cwd=folder)
    assert "numba" in loaded("run", "studies/small.yaml", cwd=folder)
    assert "numba" not in loaded("analyse", "results/small/runs.nc", cwd=folder)


def test_simulate_prints_the_same_with_and_without_a_file(tmp_path):
    alone = impactlab(*ONE, cwd=tmp_path).stdout
    assert alone == impactlab(*ONE, "--output", "one.nc", cwd=tmp_path).stdout
    assert "peak_force" in alone


def test_help_is_not_cut_short(tmp_path):
    assert not re.search(r"\w\.\.\.", impactlab("--help", cwd=tmp_path).stdout)


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["simulate", "--nodes", "600"], ["nodes", "600", "odd"]),
        (["simulate", "--scheme", "newmark"], ["scheme", "newmark", "leapfrog", "semi_implicit"]),
        (["simulate", "--beam-model", "string"], ["beam_model", "string", "timoshenko", "rigid"]),
        (["simulate", "--contact", "glue"], ["contact", "glue", "hertz", "stronge"]),
        (["simulate", "--velocity", "3 kg"], ["velocity", "3 kg", "m/s"]),
        (["simulate", "--duration", "-1 ms"], ["duration", "-0.001"]),
        (["run", "studies/none.yaml"], ["studies/none.yaml"]),
        (["run", "studies/checks.yaml"], ["checks.yaml", "impactlab verify"]),
        (["design", "studies/checks.yaml"], ["checks.yaml", "impactlab verify"]),
        (["verify", "studies/small.yaml"], ["small.yaml", "impactlab run"]),
        (["verify", "studies/misspelt.yaml"], ["misspelt.yaml", "checks.0", "half_space"]),
        (["verify", "none.nc"], ["none.nc"]),
        (["figures", "studies/small.yaml"], ["small.yaml", "netCDF"]),
        (["run", "studies/broken.yaml"], ["broken.yaml", "velocty", "velocity"]),
        (["analyse", "studies/small.yaml"], ["studies/small.yaml", "netCDF"]),
        (["report", "none.nc", "none.nc"], ["none.nc"]),
        (["predict", "none.nc", "velocity=1"], ["none.nc"]),
        (["run", "studies/small.yaml", "--scheduler", "tcp://127.0.0.1:9"], ["127.0.0.1:9"]),
    ],
)
def test_mistakes_end_in_one_message(folder, args, words, monkeypatch, capsys):
    (folder / "studies" / "broken.yaml").write_text(STUDY.replace("velocity", "velocty"))
    (folder / "studies" / "misspelt.yaml").write_text(CHECKS.replace("space", "spce"))
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", ["impactlab", *args])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 1
    said = capsys.readouterr().err
    assert "Traceback" not in said
    for word in words:
        assert word in said, said


def test_checks_from_the_file_to_the_index(folder):
    said = impactlab("verify", "studies/checks.yaml", cwd=folder).stdout
    assert "half_space" in said
    assert re.search(r"\b(\d+) of \1\b", said)
    findings = folder / "results" / "checks" / "findings.nc"
    impactlab("figures", findings, cwd=folder)
    impactlab("report", findings, cwd=folder)
    impactlab("index", cwd=folder)
    assert "checks/report.html" in (folder / "results" / "index.html").read_text()
    assert "Every comparison" in findings.with_name("report.html").read_text()
    stored = xr.load_dataset(findings)
    assert stored["ours"].values == pytest.approx(stored["independent"].values, rel=1e-4)


def fails():
    entries = [relative("one", "here", "1", 1.0, 1.0, 0.1), relative("two", "", "1", 2.0, 1.0, 0.1)]
    return Finding(entries)


def breaks():
    raise RuntimeError("of all things")


@pytest.mark.parametrize(
    ("check", "words"),
    [(fails, "bad: 1 of 2 comparisons"), (breaks, "bad: RuntimeError: of all things")],
)
def test_a_failing_check_is_told_everywhere(folder, check, words, monkeypatch, capsys):
    file = SimpleNamespace(TITLE="A bad check", SOURCE="made up", check=check)
    monkeypatch.setitem(CATALOGUE, "bad", file)
    monkeypatch.chdir(folder)
    (folder / "studies" / "checks.yaml").write_text(CHECKS.replace("half_space", "half_space, bad"))

    def exit_code(*args):
        monkeypatch.setattr(sys, "argv", ["impactlab", *args])
        with pytest.raises(SystemExit) as stop:
            main()
        return stop.value.code

    findings = "results/checks/findings.nc"
    assert exit_code("verify", "studies/checks.yaml") == 1
    said = capsys.readouterr()
    assert "half_space" in said.out
    assert words in said.err
    assert "Traceback" not in said.err
    assert exit_code("figures", findings) == 0
    assert exit_code("report", findings) == 0
    page = Path("results/checks/report.html").read_text()
    assert "Verification failed" in page
    assert '<a href="#bad">A bad check</a>' in page
    assert exit_code("verify", "studies/checks.yaml", "--exit-zero") == 0
    assert words in capsys.readouterr().err
    assert exit_code("verify", findings) == 1
    assert words in capsys.readouterr().err


SLOW = STUDY.replace("[11, 21, 41]", "[201, 203, 205, 207, 209, 211]").replace("1 ms", "20 ms")


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_an_interrupted_study_goes_on(folder, how):
    (folder / "studies" / "slow.yaml").write_text(SLOW)
    command = [sys.executable, "-m", "impactlab", "run", "studies/slow.yaml", "--workers", "1"]
    # a shell starts its background jobs deaf to Ctrl-C, and these tests may run in one
    hear = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    started = subprocess.Popen(
        command, cwd=folder, stderr=subprocess.PIPE, text=True, preexec_fn=hear
    )
    shards = folder / "results" / "slow" / "shards"
    deadline = time.monotonic() + 120
    while not list(shards.glob("*/*.nc")) and time.monotonic() < deadline:
        time.sleep(0.01)
    os.kill(started.pid, how)
    _, said = started.communicate(timeout=60)
    if how == signal.SIGINT:
        assert started.returncode == 130, said
        assert "the same command goes on" in said
        assert "Traceback" not in said
    assert not (folder / "results" / "slow" / "runs.nc").exists()
    again = impactlab("run", "studies/slow.yaml", cwd=folder).stderr
    before = int(again.split(" of them solved before")[0].split()[-1])
    assert 0 < before < 18
    first = xr.load_dataset(folder / "results" / "slow" / "runs.nc")
    (folder / "results").rename(folder / "elsewhere")
    impactlab("run", "studies/slow.yaml", cwd=folder)
    fresh = xr.load_dataset(Path(folder) / "results" / "slow" / "runs.nc")
    assert fresh.drop_attrs().identical(first.drop_attrs())
