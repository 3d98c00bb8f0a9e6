"""Snakemake's profile for Slurm, its commands played by a shell: jobs as the profile says."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NOT_COPIED = (".git", ".venv", ".snakemake", "results", ".*_cache")
SAID = 'echo "$0 $*" >> "$SAID"\n'
COMMANDS = {
    "sbatch": """for word; do case "$word" in --wrap=*) job="${word#--wrap=}" ;; esac; done
(SLURM_JOB_ID=$$ SLURM_CPUS_PER_TASK=1 bash -c "$job" >"$SAID.job" 2>&1 &&
  echo "$$|COMPLETED" >"$SAID.ended" || echo "$$|FAILED" >"$SAID.ended") &
echo $$
""",
    "srun": 'while [ "${1:0:1}" = - ]; do shift; done\nexec "$@"\n',
    "sacct": 'cat "$SAID.ended" 2>/dev/null\n',
    "squeue": "",
    "scontrol": "",
    "sinfo": "",
}


@pytest.mark.long
def test_a_step_is_a_job_with_what_the_profile_asks_for(tmp_path):
    pytest.importorskip("snakemake_executor_plugin_slurm")
    folder, tools, said = tmp_path / "copy", tmp_path / "bin", tmp_path / "said"
    shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*NOT_COPIED))
    tools.mkdir()
    for name, script in COMMANDS.items():
        (tools / name).write_text("#!/bin/bash\n" + SAID + script)
        (tools / name).chmod(0o755)
    env = os.environ | {"SAID": str(said), "PYTHONPATH": str(folder)}
    env["PATH"] = f"{tools}:{Path(sys.executable).parent}:{os.environ['PATH']}"
    command = [sys.executable, "-m", "snakemake", "--profile", "profiles/slurm", "--quiet", "all"]
    command += ["--slurm-init-seconds-before-status-checks", "2", "results/smoke/design.nc"]
    done = subprocess.run(
        command, cwd=folder, env=env, capture_output=True, text=True, timeout=240, check=False
    )
    assert done.returncode == 0, done.stderr
    assert (folder / "results" / "smoke" / "design.nc").exists()
    (submitted,) = re.findall(r"/sbatch (.*)", said.read_text())
    for option in ("-t 60", "--mem 2000", "--cpus-per-task=1", "rule_design"):
        assert option in submitted
    assert "/srun -n1" in said.read_text()
