"""Steps of a study as commands, without Snakemake."""

import csv
import os
import re
from dataclasses import replace
from pathlib import Path

import pytest
import xarray as xr
from command_line import called, here
from command_line import done as impactlab

from impactlab import paper_impact, simulate_many
from impactlab.files import write_netcdf
from impactlab.model.quantities import si
from impactlab.report.answer import answers
from impactlab.study import steps
from impactlab.study.adaptive import extension, recommendation
from impactlab.study.schema.readers import read_study
from impactlab.study.store import holder

pytestmark = pytest.mark.usefixtures("blank_pictures")

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

EXCEEDANCE = """
title: Exceedance
impact: {base: paper, beam_model: rigid}
discretisation: {nodes: 21}
duration: 0.4 ms
sampling:
  method: pawn
  samples: 128
  parameters:
    velocity: {distribution: uniform, low: 1 m/s, high: 4 m/s}
    sphere_density: {distribution: normal, mean: 7800, standard_deviation: 200}
responses: [peak_force]
limits: {peak_force: 24 kN}
"""


def test_one_command_goes_from_a_study_to_its_report(folder):
    """Each step ends with a line: what it made, where; the analysis says what was found."""
    told = impactlab("go", "studies/small.yaml", cwd=folder).stdout.splitlines()
    files = ("runs.nc", "analysis.nc", "figures", "report.html")
    results = folder / "results" / "small"
    datasets = [xr.load_dataset(results / name) for name in files[:2]]
    finding = answers(*datasets)[0]
    assert told.pop() == "results/index.html: the list of all reports"
    assert told[0] == (
        "results/small/runs.nc: 9 runs, 0 without an answer; peak_force from 5.501 kN to 24.42 kN"
    )
    assert len(told) == len(files)
    for line, name in zip(told, files, strict=True):
        assert line.partition(": ")[0] == f"results/small/{name}"
    assert [line.endswith(finding) for line in told] == [False, True, False, False]
    assert (results / "report.html").exists()


def test_a_folder_of_results_is_as_good_as_its_files(folder):
    impactlab("run", "studies/small.yaml", cwd=folder)
    results = folder / "results" / "small"
    for command in ("analyse", "figures", "report", "status"):
        impactlab(command, "results/small", cwd=folder)
    assert (results / "report.html").exists()
    assert "9 runs" in impactlab("run", "results/small", cwd=folder).stdout
    impactlab("design", "results/small", cwd=folder)
    assert "9 runs" in impactlab("run", "results/small", cwd=folder).stdout
    (results / "runs.nc").unlink()
    assert "results/small/runs.nc" in called("analyse", "results/small", cwd=folder).stderr


def test_one_command_takes_the_evidence_that_the_workflow_takes(folder):
    (folder / "studies" / "sample.yaml").write_text(
        SAMPLE.replace("{nodes: 21, points: 3}", "auto")
    )
    impactlab("go", "studies/sample.yaml", cwd=folder)
    analysis = xr.load_dataset(folder / "results" / "sample" / "analysis.nc")
    assert {"first_order_numerical", "numerical_uncertainty"} <= set(analysis)
    # what `recommend` prints to paste is what the study was solved with
    *_, line = impactlab("recommend", "studies/sample.yaml", cwd=folder).stdout.splitlines()
    pasted = SAMPLE.replace("discretisation: {nodes: 21, points: 3}", line)
    (folder / "studies" / "pasted.yaml").write_text(pasted)
    grid = read_study(folder / "studies" / "pasted.yaml").discretisation
    runs = xr.load_dataset(folder / "results" / "sample" / "runs.nc")
    for name in ("nodes", "points", "rule", "scheme", "courant"):
        assert getattr(grid, name) == runs[name].item(), name


def test_the_workflow_does_one_command_in_two_halves(folder):
    """With the file of each step of a sample."""
    (folder / "studies" / "sample.yaml").write_text(SAMPLE)
    results = folder / "results" / "sample"
    impactlab("go", "studies/sample.yaml", "--only", "solve", cwd=folder)
    made = {path.name for path in results.glob("*.*")}
    assert made == {"resolution.nc", "design.nc", "runs.nc", "refinement.nc"}
    impactlab("go", "studies/sample.yaml", "--only", "report", cwd=folder)
    assert "numerical_uncertainty" in xr.load_dataset(results / "analysis.nc")
    assert (results / "report.html").exists()
    refused = called("go", "studies/sample.yaml", "--only", "all", cwd=folder).stderr
    assert "--only = 'all': must be 'solve' or 'report'" in refused


def test_one_command_reports_a_verification_before_it_fails(folder, monkeypatch):
    monkeypatch.setattr(steps, "failure", lambda outcomes: "half_space: broken")
    told = called("go", "studies/checks.yaml", cwd=folder)
    assert told.returncode == 1
    assert "half_space: broken" in told.stderr
    assert (folder / "results" / "checks" / "report.html").exists()


def test_kernels_are_compiled_on_demand(tmp_path):
    told = impactlab("compile", "--wings", cwd=tmp_path).stdout.splitlines()
    folders = [Path(line.removeprefix("Compiled kernels: ")) for line in told]
    kept = [path.name for folder in folders for path in folder.glob("*.kernel")]
    kernels = ("euler_bernoulli", "timoshenko", "von_karman", "lumped", "modal", "close_gaps")
    assert all(any(f".{kernel}-" in name for name in kept) for kernel in kernels)


def test_designs_and_rare_events_are_printed_and_reported(folder):
    """The force grows with velocity and density: 1 % of the spheres are denser than 8265 kg/m3."""
    (folder / "studies" / "exceedance.yaml").write_text(EXCEEDANCE)
    command = ("size", "studies/exceedance.yaml", "velocity", "--probability", "0.01")
    assert "minimise" in called(*command, cwd=folder).stderr
    cost = impactlab(*command, "--dry-run", cwd=folder).stdout
    assert re.search(r"^runs +60,256$", cost, re.MULTILINE), "ten estimates after 256 pilot runs"
    assert not (folder / "results" / "exceedance" / "sizing.nc").exists()
    answer, *_, page = impactlab(*command, "--maximise", "velocity", cwd=folder).stdout.splitlines()
    assert page == "results/exceedance/sizing.html"
    chosen = float(re.search(r"impact velocity ([\d.]+) m/s", answer)[1])
    dense = {"velocity": [0.98 * chosen, 1.03 * chosen], "sphere_density": [8265.0, 8265.0]}
    impact = replace(paper_impact(), beam_model="rigid")
    below, above = simulate_many(impact, duration="0.4 ms", varied=dense).peak_force.values
    assert below < 24e3 < above
    rare = EXCEEDANCE.replace("uniform, low: 1 m/s, high: 4 m/s", f"fixed, value: {chosen}")
    (folder / "studies" / "rare.yaml").write_text(rare)
    answer, *_, page = impactlab("rare", "studies/rare.yaml", cwd=folder).stdout.splitlines()
    assert page == "results/rare/rare_event.html"
    cost = impactlab("rare", "studies/rare.yaml", "--dry-run", cwd=folder).stdout
    assert re.search(r"^runs +6,000$", cost, re.MULTILINE)
    assert 0.003 < float(re.search(r"with probability ([\d.e-]+) ", answer)[1]) < 0.0101


def test_two_models_are_printed_and_reported(folder):
    (folder / "studies" / "exceedance.yaml").write_text(EXCEEDANCE)
    command = "multifidelity", "studies/exceedance.yaml"
    answer, *_, page = impactlab(
        *command, "beam_model=euler_bernoulli", "nodes=41", "--budget", "0.3 s", cwd=folder
    ).stdout.splitlines()
    assert page == "results/exceedance/multifidelity.html"
    assert answer.startswith("With beam_model euler_bernoulli, nodes 41, the peak force is ")
    assert "nods" in called(*command, "nods=41", cwd=folder).stderr


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


def test_a_sample_that_was_soon_large_enough_has_none_left(folder):
    enough = GROWING.replace("interval: 0.001, runs: 600", "interval: 0.5, runs: 100000")
    (folder / "studies" / "growing.yaml").write_text(enough)
    impactlab("run", "studies/growing.yaml", cwd=folder)
    told = impactlab("status", "studies/growing.yaml", cwd=folder).stdout
    assert "256 of 256 runs solved, 0 left" in told
    (folder / "studies" / "growing.yaml").write_text(enough.replace("0.5", "0.4"))
    told = impactlab("status", "studies/growing.yaml", cwd=folder).stdout
    assert "256 of 512 runs solved, 256 left" in told


def test_nobody_gets_between_two_steps_of_a_growing_sample(folder, monkeypatch):
    (folder / "studies" / "growing.yaml").write_text(GROWING)
    monkeypatch.chdir(folder)
    seen = []

    def looking(design, solve, analyse):
        seen.append(holder(folder / "results" / "growing" / "shards"))
        raise OSError("seen enough")

    monkeypatch.setattr(extension, "extend_sample", looking)
    assert here("run", "studies/growing.yaml") == 1
    assert seen[0].startswith(f"process {os.getpid()} on ")


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
    value, error = map(si, re.search(r"peak_force\s*│([^│]*)│([^│]*)", said).groups(), ["N"] * 2)
    arguments = ["--velocity", 0.3, "--nodes", 21, "--points", 3, "--duration", "0.5 ms"]
    solved = impactlab("simulate", *arguments, cwd=folder).stdout
    expected = si(re.search(r"peak_force\s*│([^│]*)", solved)[1], "N")
    assert value == pytest.approx(expected, abs=5 * error + 1)
    assert error < 0.01 * expected
    runs = file.with_name("runs.nc")
    write_netcdf(xr.load_dataset(runs).assign_attrs(analyses="sensitivity"), runs, "runs")
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
    table = (results / "indices.csv").read_text()
    assert "first_order_numerical" in table
    first, *_ = csv.DictReader(table.splitlines())
    stored = xr.load_dataset(results / "indices.nc")["first_order"]
    assert stored.sel(response="peak_force", parameter="velocity") == float(first["value"])


def test_studies_are_listed(folder):
    listed = impactlab("studies", cwd=folder).stdout
    assert "small" in listed
    assert "9 runs" in listed
    assert "Small" in listed
    assert "1 check" in listed


def test_trials_of_an_auto_discretisation_are_solved_where_the_study_is(folder, monkeypatch):
    automatic = SAMPLE.replace("{nodes: 21, points: 3}", "auto")
    (folder / "studies" / "automatic.yaml").write_text(automatic)
    monkeypatch.chdir(folder)
    engines = []

    def looking(study, trials, engine, wishes):
        engines.append(engine)
        raise OSError("seen enough")

    monkeypatch.setattr(recommendation, "recommend", looking)
    assert here("run", "studies/automatic.yaml", "--cluster", "none.yaml") == 1
    assert not engines  # what is wrong with a profile is told before anything is solved
    asked = ("--workers", "3", "--scheduler", "tcp://127.0.0.1:1")
    assert here("run", "studies/automatic.yaml", *asked) == 1
    assert [(engine.workers, engine.address) for engine in engines] == [(3, "tcp://127.0.0.1:1")]
