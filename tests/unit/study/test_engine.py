"""Dask clients listen on the loopback alone; Slurm jobs follow their profile."""

import asyncio
import gc
import re
import signal
import time
from pathlib import Path

import dask
import psutil
import pytest
from distributed import LocalCluster
from tornado.util import TimeoutError as TornadoTimeoutError

from impactlab.study import engine
from impactlab.study.engine import Engine, Profile, read_profile, slurm_cluster
from impactlab.validation.errors import StudyError


def listening():
    """Return the addresses at which this process and its children listen."""
    here = psutil.Process()
    return {
        connection.laddr.ip
        for process in (here, *here.children(recursive=True))
        for connection in process.net_connections("inet")
        if connection.status == psutil.CONN_LISTEN
    }


@pytest.mark.parametrize("kind", ["threads", "processes"])
def test_scheduler_workers_and_dashboard_listen_on_the_loopback_alone(kind):
    before = listening()
    with Engine(kind, workers=2).client() as client:
        client.wait_for_workers(2 if kind == "processes" else 1, timeout=60)
        assert "127.0.0.1" in listening() <= before | {"127.0.0.1"}


def test_workers_start_where_signals_have_no_mask(monkeypatch):
    """Windows, where multiprocessing has no tracker of resources, has none either."""
    monkeypatch.delattr(signal, "pthread_sigmask")
    monkeypatch.delattr(engine, "resource_tracker")
    with Engine("threads", workers=1).client() as client:
        assert client.submit(abs, -1).result() == 1


@pytest.mark.parametrize(
    ("error", "logged"), [(TornadoTimeoutError("Timeout"), 0), (OSError("lost"), 1)]
)
def test_timeouts_at_the_end_of_dask_are_not_logged(caplog, error, logged):
    """A sender that still waits when the loop ends times out, and nobody reads its error."""
    with Engine().client():
        pass

    async def leave():
        asyncio.get_running_loop().create_future().set_exception(error)

    asyncio.run(leave())
    gc.collect()
    assert len([record for record in caplog.records if record.name == "asyncio"]) == logged


class SlurmHere(LocalCluster):
    """A cluster of threads in place of jobs."""

    def scale(self, n=0, *, jobs=0):
        return super().scale(n or jobs)


def test_jobs_that_ended_are_submitted_again(monkeypatch):
    cluster = SlurmHere(n_workers=0, processes=False, dashboard_address="127.0.0.1:0")
    monkeypatch.setattr(engine, "slurm_cluster", lambda _: cluster)
    monkeypatch.setattr(engine, "_SUBMIT_AGAIN", 0.1)
    profile = Profile(jobs=2, interface="lo", cores=1, memory="1GB", walltime="1:00")
    with (
        dask.config.set({"distributed.deploy.lost-worker-timeout": "0.1s"}),
        Engine(profile=profile).client() as client,
    ):
        client.wait_for_workers(2, timeout=60)
        first = set(client.scheduler_info(n_workers=-1)["workers"])
        client.retire_workers(list(first))
        ends = time.monotonic() + 60
        while len(set(client.scheduler_info(n_workers=-1)["workers"]) - first) < 2:
            assert time.monotonic() < ends
            time.sleep(0.05)


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


def test_missing_slurm_is_an_error(profile, monkeypatch):
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
