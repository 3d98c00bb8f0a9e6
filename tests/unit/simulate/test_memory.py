"""Answers do not depend on what freed memory holds: no kernel reads what it does not own.

Python's debugging allocator and glibc's MALLOC_PERTURB_ overwrite every block that is freed.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

from impactlab.solver.jit import compiled

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="nothing is compiled")

STUDY = """
title: Small sample
description: For a test.
impact: {base: paper}
discretisation: {nodes: 21, points: 5}
duration: 5 ms
sampling:
  method: regression
  samples: 64
  seed: 1
  parameters:
    velocity: {distribution: uniform, low: 5 m/s, high: 15 m/s}
    beam_depth: {distribution: uniform, low: 26 mm, high: 29 mm}
responses: [peak_force, contact_duration]
"""
PROGRAM = '''
import hashlib
import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import xarray as xr
from command_line import done

import impactlab as il
from impactlab.solver import BEAM_MODELS
from impactlab.solver.contact import LAWS
from impactlab.fem3d.solver import solve

DIGESTS = {}


def note(name, *datasets):
    """Keep a digest of every bit of the datasets."""
    whole = hashlib.sha256()
    for dataset in datasets:
        for variable in sorted(dataset.variables):
            whole.update(variable.encode() + dataset[variable].values.tobytes())
    DIGESTS[name] = whole.hexdigest()


def one(model="euler_bernoulli", scheme="leapfrog", law="stronge", velocity=12.0):
    impact = replace(il.paper_impact(velocity, law), beam_model=model)
    grid = il.Discretisation(nodes=21, points=5, scheme=scheme)
    return il.simulate(impact, grid, duration=1e-3, samples=51)


schemes = [(model, "leapfrog") for model in BEAM_MODELS] + [
    (model, "modal") for model in BEAM_MODELS[:2]
]
for model, scheme in schemes:
    note(f"{model}, {scheme}", *(one(model, scheme, law) for law in LAWS))
varied = {"velocity": [1.0, 5.0, 12.0] * 3, "nodes": [21] * 3 + [41] * 3 + [61] * 3}
note("batch", il.simulate_many(il.paper_impact(), duration=1e-3, varied=varied))
with ThreadPoolExecutor(4) as pool:
    note("threads", *pool.map(lambda v: one(velocity=0.5 * v), range(1, 41)))
note("3-D", solve(il.paper_impact(5.0), element_size=4e-3, duration=3e-5, samples=11, threads=2))

here = Path.cwd()
for kind in ("", "--processes"):
    folder = here / ("study" + kind)
    runs = folder / "runs.nc"
    done("run", "study.yaml", "--output", runs, "--workers", 2, *filter(None, [kind]), cwd=here)
    done("analyse", runs, cwd=here)
    with xr.open_dataset(runs) as one, xr.open_dataset(folder / "analysis.nc") as two:
        note("study" + kind, one, two)
    point = "velocity=9", "beam_depth=0.0271"
    DIGESTS["surrogate" + kind] = done("predict", folder / "surrogate.nc", *point, cwd=here).stdout
print(json.dumps(DIGESTS))
'''
OVERWRITING = {"PYTHONMALLOC": "debug", "MALLOC_PERTURB_": "165"}


def digests(folder, settings):
    """Digest of each answer, and the surrogates' predictions, under these settings."""
    (folder / "study.yaml").write_text(STUDY)
    tests = str(Path(__file__).parents[2])
    paths = os.pathsep.join(filter(None, [tests, os.environ.get("PYTHONPATH")]))
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": paths} | settings,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, str] = json.loads(done.stdout.splitlines()[-1])
    assert found["study"] == found["study--processes"]
    assert found["surrogate"] == found["surrogate--processes"]
    assert "peak_force" in found["surrogate"]
    return found


@pytest.mark.long
def test_what_is_freed_is_not_read(tmp_path):
    (tmp_path / "plain").mkdir()
    (tmp_path / "overwritten").mkdir()
    plain = digests(tmp_path / "plain", {})
    assert len(plain) == 15
    assert digests(tmp_path / "overwritten", OVERWRITING) == plain


def test_a_kernel_that_makes_an_array_does_not_compile_without_owning_it():
    """So that none can be freed while another function reads it."""

    @compiled
    def sum_of_ones(n):
        return float(np.ones(n)[0])

    with pytest.raises(numba.core.errors.NumbaError):
        sum_of_ones(3)
