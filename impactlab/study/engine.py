"""Dask clients: on this machine, on a running scheduler, or on Slurm jobs from a profile."""

from __future__ import annotations

import logging
import shutil
import signal
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import partial
from multiprocessing import resource_tracker
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import dask
from distributed import Client, LocalCluster, Security
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from tornado.ioloop import PeriodicCallback
from tornado.util import TimeoutError as TornadoTimeoutError

from impactlab.study.declaration.messages import problems
from impactlab.study.declaration.reading import read_mapping, read_text
from impactlab.study.errors import StudyError

if TYPE_CHECKING:
    from dask_jobqueue.slurm import SLURMCluster

_LOOPBACK = "127.0.0.1:0"
_ASK_AGAIN = 60.0
"""Seconds between looks at whether Slurm jobs have to be submitted anew."""
_TALKERS = ("distributed", "distributed.client", "tornado.application")
_SETTINGS = {
    "distributed.admin.low-level-log-length": 10,  # of 1000 messages kept, cases and all
    # what looks after itself many times a second, and takes some percent of the time
    "distributed.worker.profile.enabled": False,
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.admin.tick.interval": "1s",
}
"""Of the dask that is started here."""


@dataclass(frozen=True)
class Engine:
    """On a running dask scheduler where an address is given, as Slurm jobs where a profile is.

    Else in threads or processes here. Schedulers and dashboards that are started here listen on
    the loopback alone, but for the scheduler of Slurm jobs, which listens on the profile's
    interface. dask's own configuration holds, TLS included.
    """

    kind: Literal["threads", "processes"] = "threads"
    workers: int = 1
    address: str = ""
    profile: Profile | None = None
    batch_seconds: float = 1.0
    """Of a task, about."""

    @contextmanager
    def client(self) -> Iterator[Client]:
        """A dask client for the time of a study. Raises OSError when no scheduler answers."""
        for name in _TALKERS:  # what goes wrong is raised, and told
            logging.getLogger(name).setLevel(logging.CRITICAL)
        logging.getLogger("asyncio").addFilter(_no_late_timeout)
        with dask.config.set(_SETTINGS), self._clients() as client:
            yield client

    def _clients(self) -> AbstractContextManager[Client]:
        if self.address:
            return _running(self.address)
        if self.profile:
            return _slurm(self.profile)
        return _here(self.workers, processes=self.kind == "processes")


def _no_late_timeout(record: logging.LogRecord) -> bool:
    """False for what dask leaves behind where its loop ends while a sender waits: no error."""
    return not isinstance(record.exc_info and record.exc_info[1], TornadoTimeoutError)


# No client is the default one: xarray would lock its files through the scheduler, slowly, and for
# ever where Ctrl-C comes in between.


@contextmanager
def _running(address: str) -> Iterator[Client]:
    if address.startswith("tls:") and not Security().get_connection_args("client")["ssl_context"]:
        raise OSError(f"{address}: dask's settings name no certificate (distributed.comm.tls)")
    with Client(address, timeout=10, set_as_default=False) as client:
        yield client


@contextmanager
def _slurm(profile: Profile) -> Iterator[Client]:
    with slurm_cluster(profile) as cluster:
        ask = partial(cluster.scale, jobs=profile.jobs)
        again = PeriodicCallback(ask, 1e3 * _ASK_AGAIN)  # jobs end, at their walltime at the latest
        ask()
        cluster.loop.add_callback(again.start)
        try:
            with Client(cluster, set_as_default=False) as client:
                yield client
        finally:
            cluster.loop.add_callback(again.stop)


@contextmanager
def _here(workers: int, *, processes: bool) -> Iterator[Client]:
    try:
        with _deaf_to_ctrl_c():
            cluster = LocalCluster(
                processes=processes,
                n_workers=workers if processes else 1,
                threads_per_worker=1 if processes else workers,
                host="127.0.0.1" if processes else None,
                dashboard_address=_LOOPBACK,
                worker_dashboard_address=_LOOPBACK,
                memory_limit=0,
                silence_logs=logging.ERROR,
            )
    except RuntimeError as error:
        raise OSError(f"the workers on this machine did not start: {error}") from error
    with cluster, Client(cluster, set_as_default=False) as client:
        yield client


@contextmanager
def _deaf_to_ctrl_c() -> Iterator[None]:
    """Worker processes started within never hear Ctrl-C: it is for the one that started them."""
    resource_tracker.ensure_running()  # else started within, where it would unblock the signal
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class Profile(BaseModel):
    """What a job asks of Slurm: the keys of dask_jobqueue.SLURMCluster, and the number of jobs."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    jobs: Annotated[int, Field(ge=1)]
    """How many are submitted; the study is solved by those that have started."""
    interface: str
    """The network on which this machine and the jobs see each other, such as ib0."""
    cores: Annotated[int, Field(ge=1)]
    processes: Annotated[int, Field(ge=1)] = 1
    """A job's cores are shared out among so many."""
    memory: str
    walltime: str
    queue: str | None = None
    account: str | None = None
    job_extra_directives: list[str] = []
    job_script_prologue: list[str] = []
    log_directory: str | None = None
    python: str | None = None
    """The interpreter on the nodes; that of this process where it is left out."""


def read_profile(path: Path) -> Profile:
    """The profile in a YAML file. Raises StudyError, naming file and key."""
    data = read_mapping(read_text(path), str(path))
    try:
        return Profile.model_validate(data)
    except ValidationError as error:
        keys = {id(data): list(Profile.model_fields)}
        raise StudyError(*problems(error, data, str(path), keys)) from None


def slurm_cluster(profile: Profile) -> SLURMCluster:
    """The cluster, its scheduler in this process, no job submitted yet.

    Raises OSError where dask-jobqueue or Slurm is not there.
    """
    try:
        from dask_jobqueue.slurm import SLURMCluster
    except ImportError:
        raise OSError("dask-jobqueue is not installed: pip install 'impactlab[slurm]'") from None
    if not shutil.which("sbatch"):
        raise OSError("there is no command sbatch here: start this where Slurm jobs are submitted")
    return SLURMCluster(
        n_workers=0,
        scheduler_options={"dashboard_address": "127.0.0.1:0"},
        **profile.model_dump(exclude={"jobs"}, exclude_none=True),
    )
