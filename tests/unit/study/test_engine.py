"""What is started here can be reached from here alone."""

import asyncio
import gc
import time

import dask
import psutil
import pytest
from distributed import LocalCluster
from tornado.util import TimeoutError as TornadoTimeoutError

from impactlab.study import engine
from impactlab.study.engine import Engine
from impactlab.study.slurm import Profile


def listening():
    """The addresses at which this process and its children can be reached."""
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


@pytest.mark.parametrize(
    ("error", "told"), [(TornadoTimeoutError("Timeout"), 0), (OSError("lost"), 1)]
)
def test_what_dask_leaves_behind_at_its_end_is_not_told(caplog, error, told):
    """A sender that still waits when the loop ends: its time runs out, and nobody asks for it."""
    with Engine().client():
        pass

    async def leave() -> None:
        asyncio.get_running_loop().create_future().set_exception(error)

    asyncio.run(leave())
    gc.collect()
    assert len([record for record in caplog.records if record.name == "asyncio"]) == told


class SlurmHere(LocalCluster):
    """Threads in the place of jobs."""

    def scale(self, n=0, *, jobs=0):
        return super().scale(n or jobs)


def test_jobs_that_ended_are_submitted_again(monkeypatch):
    cluster = SlurmHere(n_workers=0, processes=False, dashboard_address=None)
    monkeypatch.setattr(engine, "slurm_cluster", lambda _: cluster)
    monkeypatch.setattr(engine, "_ASK_AGAIN", 0.1)
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
