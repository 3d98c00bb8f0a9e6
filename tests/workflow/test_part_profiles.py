"""The ready files in profiles/parts, their command played by a shell: the same one in each."""

import json
import os
import re
import subprocess
from pathlib import Path

import pytest
from ruamel.yaml import YAML

PROFILES = Path(__file__).parents[2] / "profiles" / "parts"
COMMAND = ["run", "studies/NAME.yaml", "--part", "3/40", "--workers", "4"]
STORE = ["--to", "s3://BUCKET/NAME"]


@pytest.fixture
def shell(tmp_path):
    """Runs a command with these variables; returns what `impactlab` or `aws` was called with."""
    for name in ("impactlab", "aws"):
        (tmp_path / name).write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n')
        (tmp_path / name).chmod(0o755)

    def run(*command, **variables):
        env = {"PATH": f"{tmp_path}:{os.environ['PATH']}"} | variables
        done = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
        return done.stdout.splitlines()

    return run


def test_slurm(shell):
    variables = {"SLURM_ARRAY_TASK_ID": "3", "SLURM_CPUS_PER_TASK": "4"}
    arguments = ("studies/NAME.yaml", "40")
    assert shell("bash", PROFILES / "slurm.sh", *arguments, **variables) == COMMAND


def test_pbs(shell, tmp_path):
    variables = {"PBS_ARRAY_INDEX": "3", "NCPUS": "4", "PBS_O_WORKDIR": str(tmp_path)}
    variables |= {"STUDY": "studies/NAME.yaml", "PARTS": "40"}
    assert shell("bash", PROFILES / "pbs.sh", **variables) == COMMAND


def test_kubernetes(shell):
    job = YAML(typ="safe").load(PROFILES / "kubernetes.yaml")["spec"]
    assert (job["completionMode"], job["completions"]) == ("Indexed", 40)
    (container,) = job["template"]["spec"]["containers"]
    assert shell(*container["command"], JOB_COMPLETION_INDEX="2") == COMMAND + STORE


def test_aws_batch(shell):
    said = shell("bash", PROFILES / "aws_batch.sh", "studies/NAME.yaml", "40", STORE[-1])
    assert said[:2] == ["batch", "submit-job"]
    assert said[said.index("--array-properties") + 1] == "size=40"
    command = json.loads(said[said.index("--container-overrides") + 1])["command"]
    assert shell(*command, AWS_BATCH_JOB_ARRAY_INDEX="2") == COMMAND + STORE


def test_heads_say_how_to_start_them():
    for path in PROFILES.iterdir():
        head = path.read_text().split("\n")[:6]
        assert any(re.match(r"#     \S", line) for line in head), path
