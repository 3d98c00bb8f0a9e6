"""Slurm jobs, as far as a machine without Slurm goes."""

import re
from pathlib import Path

import pytest

from impactlab.study.errors import StudyError
from impactlab.study.slurm import read_profile, slurm_cluster

ROOT = Path(__file__).parents[3]
PROFILE = """
jobs: 3
cores: 32
processes: 4
memory: 16 GB
walltime: "04:00:00"
interface: lo
queue: long
account: steel
job_extra_directives: [--exclusive]
job_script_prologue: [module load python]
"""


@pytest.fixture
def profile(tmp_path):
    def read(text):
        (tmp_path / "workers.yaml").write_text(text)
        return read_profile(tmp_path / "workers.yaml")

    return read


def test_the_committed_profile_is_valid():
    assert read_profile(ROOT / "profiles" / "slurm" / "workers.yaml").jobs > 0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("jobs: 3", "jobs: 0", "jobs = 0"),
        ("walltime:", "waltime:", "did you mean 'walltime'"),
        ("interface: lo", "", "interface: is required"),
        ("cores: 32", "cores: many", "cores = 'many'"),
    ],
)
def test_mistakes_name_file_and_key(profile, old, new, words):
    with pytest.raises(StudyError, match=re.escape(words)) as caught:
        profile(PROFILE.replace(old, new))
    assert "workers.yaml" in str(caught.value)


def test_without_slurm_it_is_said(profile, monkeypatch):
    pytest.importorskip("dask_jobqueue")
    monkeypatch.setenv("PATH", "")
    with pytest.raises(OSError, match="no command sbatch"):
        slurm_cluster(profile(PROFILE))


def test_the_job_asks_for_what_the_profile_says(profile, tmp_path, monkeypatch):
    pytest.importorskip("dask_jobqueue")
    (tmp_path / "sbatch").touch(mode=0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    with slurm_cluster(profile(PROFILE)) as cluster:
        script = cluster.job_script()
        address = cluster.scheduler_address
    for line in (
        "#SBATCH -p long",
        "#SBATCH -A steel",
        "#SBATCH --cpus-per-task=32",
        "#SBATCH --mem=15G",
        "#SBATCH -t 04:00:00",
        "#SBATCH --exclusive",
        "module load python",
    ):
        assert line in script.splitlines(), script
    assert "--nthreads 8 " in script
    assert "--nworkers 4 " in script
    assert address.startswith("tcp://127.0.0.1:")  # of the profile's interface
    assert address in script
