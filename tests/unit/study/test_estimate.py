"""The cost of a study is estimated before anything runs, and compared with limits."""

from dataclasses import replace
from functools import reduce
from pathlib import Path
from types import SimpleNamespace as Namespace

import numpy as np
import pytest

from impactlab.model.cost import memory
from impactlab.study.design import design
from impactlab.study.estimate import _PROGRAM, MOST_TIME, Estimate, estimate
from impactlab.study.schema.readers import study_of_text
from impactlab.study.solvers import solver_named

NOWHERE = Path("no") / "results"
GRID = """
title: A grid
impact: {base: paper}
discretisation: {nodes: NODES}
duration: DURATION
sampling: {method: grid, parameters: {PARAMETERS}}
STORE
"""
NODES = {"nodes": [11, 101, 201], "velocity": [1.0, 2.0]}
SAMPLE = """
title: A sample
impact: {base: paper}
duration: 1 ms
sampling:
  method: sobol
  base_samples: 1024
  until: {interval: 0.02, runs: 20000}
  parameters:
    beam_depth: {distribution: uniform, low: 20 mm, high: 30 mm}
    velocity: {distribution: lognormal, median: 1, geometric_standard_deviation: 1.2}
"""


def grid(parameters, nodes=201, duration="1 ms", store=""):
    given = ", ".join(f"{name}: {list(values)}" for name, values in parameters.items())
    text = GRID.replace("PARAMETERS", given).replace("NODES", str(nodes))
    return study_of_text("some", text.replace("DURATION", duration).replace("STORE", store))


MEASURED = """
title: Measured
impact: {base: paper}
discretisation: {nodes: NODES, points: POINTS}
duration: DURATION
sampling:
  method: delta
  samples: RUNS
  parameters:
    velocity: {distribution: uniform, low: 0.5, high: 1.5}
    sphere_radius: {distribution: uniform, low: 30 mm, high: 40 mm}
    beam_yield_stress: {distribution: uniform, low: 300 MPa, high: 400 MPa}
STORE
"""
ISHIGAMI = """
title: Measured
function: ishigami
sampling:
  method: delta
  samples: 327680
  parameters:
    x1: {distribution: uniform, low: -3.14, high: 3.14}
    x2: {distribution: uniform, low: -3.14, high: 3.14}
    x3: {distribution: uniform, low: -3.14, high: 3.14}
"""


def measured(runs, nodes, points, duration, store=""):
    settings = {"RUNS": runs, "NODES": nodes, "POINTS": points, "DURATION": duration}
    text = MEASURED.replace("STORE", store)
    return reduce(lambda text, item: text.replace(item[0], str(item[1])), settings.items(), text)


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        (measured(1_000_000, 11, 9, "1 ms"), 17.9),
        (measured(100_000, 101, 9, "1 ms"), 15.8),
        (measured(30_000, 101, 9, "8 ms"), 33.3),
        (measured(20_480, 21, 3, "0.3 ms"), 0.55),
        (measured(64, 21, 3, "0.3 ms"), 0.17),
        (measured(5120, 21, 3, "0.3 ms", "store: {histories: true, samples: 1000}"), 5.0),
        (ISHIGAMI, 0.76),
    ],
    ids=["million", "medium", "long", "cheap", "few", "histories", "function"],
)
def test_the_estimate_is_within_a_factor_of_2_of_measured_processor_times(text, seconds):
    """The first three are those of docs/scaling.md; all but the time to load the program."""
    assert seconds / 2 < estimate(study_of_text("some", text), NOWHERE, 1).wall(1) < 2 * seconds


def test_a_cost_sample_represents_all_runs(monkeypatch):
    study = grid({"nodes": range(11, 211, 2), "beam_depth": np.linspace(0.02, 0.03, 50).tolist()})
    sampled = estimate(study, NOWHERE, 1)
    monkeypatch.setattr("impactlab.study.estimate._MOST", 10_000)
    whole = estimate(study, NOWHERE, 1)
    assert sampled.runs == whole.runs == 5000
    assert sampled.seconds == pytest.approx(whole.seconds, rel=0.1)
    assert sampled.largest == whole.largest
    assert replace(estimate(study, NOWHERE, 1), free=whole.free) == whole


def test_a_growing_sample_costs_its_largest_size():
    study = study_of_text("some", SAMPLE)
    found = estimate(study, NOWHERE, 1)
    assert found.runs == 20_000
    fewer = replace(study, sampling=replace(study.sampling, until=None))
    less = estimate(fewer, NOWHERE, 1)
    assert less.runs == 1024 * 6
    assert found.seconds == pytest.approx(less.seconds * 20_000 / 6144, rel=0.1)
    # a function costs next to nothing
    ranges = ", ".join(f"x{at}: {{distribution: uniform, low: 0, high: 1}}" for at in (1, 2, 3))
    sampling = f"{{method: delta, samples: 1000000, parameters: {{{ranges}}}}}"
    text = f"title: F\nfunction: ishigami\nsampling: {sampling}"
    found = estimate(study_of_text("some", text), NOWHERE, 2)
    assert found.seconds < 10
    assert found.disk < 1e9


def test_memory_and_disk_are_those_of_the_answers():
    study = grid(NODES, store="store: {histories: true, samples: 50000}")
    cases = solver_named("impact").cases(design(study), np.arange(6))
    found = estimate(study, NOWHERE, 2)
    answers = 8 * 6 * 50_000 * 5  # five histories, eight bytes per number
    assert found.disk / 2 == pytest.approx(answers, rel=0.01)
    of_the_kernels = 2 * memory(cases).max()
    assert found.memory - _PROGRAM == pytest.approx(2 * answers / 5 + of_the_kernels, rel=0.01)
    assert found.large == "store.samples"


@pytest.mark.parametrize(
    ("study", "key"),
    [
        (grid({"velocity": [1.0]}, nodes=10_000_001), "discretisation.nodes"),
        (grid({"nodes": [11, 1_000_001]}), "sampling.parameters.nodes"),
        (grid({"velocity": [1.0]}, duration="100 years"), "duration"),
        (grid({"sphere_mass": [1e-18]}, duration="150 s"), "sampling.parameters.sphere_mass"),
        (grid({"courant": [1e-12]}), "sampling.parameters.courant"),
        (
            grid({"beam_span": [1e-6], "beam_depth": [1e-7]}, duration="10 s"),
            "sampling.parameters.beam_span",
        ),
    ],
)
def test_more_than_a_month_is_reported_at_the_key_that_drives_it(study, key):
    found = estimate(study, NOWHERE, 1)
    assert found.seconds > MOST_TIME
    problem = found.exceeded()[0]
    assert problem.key == key
    assert "exceeds the limit of 30 days" in str(problem)


def test_more_memory_or_disk_than_available_is_reported():
    frugal = Estimate("a.yaml", 1, 1.0, 1e6, 1e6, 1e9, 1.0, {}, "nodes", "store.samples")
    assert frugal.exceeded() == []
    (greedy,) = replace(frugal, memory=1e18).exceeded()
    assert greedy.key == "store.samples"
    assert "of memory" in greedy.reason
    (greedy,) = replace(frugal, disk=1e18).exceeded()
    assert "1,000 PB of disk, which exceeds the 1 GB available" in greedy.reason


def test_shards_already_on_disk_count_as_available(tmp_path, monkeypatch):
    monkeypatch.setattr("impactlab.study.estimate.disk_usage", lambda path: Namespace(free=1000))
    (tmp_path / "shards").mkdir()
    (tmp_path / "shards" / "some.nc").write_bytes(bytes(500))
    study = grid(NODES)
    assert estimate(study, tmp_path, 1).free == 1500
    assert estimate(study, tmp_path / "fresh" / "folder", 1).free == 1000
