"""Dask clients: on this machine, on a running scheduler, or on Slurm jobs from a profile."""

from __future__ import annotations

import logging
import shutil
import signal
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import partial, wraps
from multiprocessing import resource_tracker
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Concatenate, Literal, ParamSpec, TypeVar

import dask
from distributed import Client, LocalCluster, Security
from pydantic import Field
from tornado.ioloop import PeriodicCallback
from tornado.util import TimeoutError as TornadoTimeoutError

from impactlab.study.schema.yaml_file import read_mapping, read_text
from impactlab.validation.fields import FileSection, validated

if TYPE_CHECKING:
    from dask_jobqueue.slurm import SLURMCluster

Subject = TypeVar("Subject")
Answer = TypeVar("Answer")
Arguments = ParamSpec("Arguments")
_LOOPBACK = "127.0.0.1:0"
_PATIENCE = 10.0  # seconds that a scheduler has to answer
_SUBMIT_AGAIN = 60.0  # seconds between checks whether Slurm jobs have to be submitted again
_LOGGERS = ("distributed", "distributed.client", "tornado.application")
_SETTINGS = {
    "distributed.admin.low-level-log-length": 10,  # of 1000 messages, which hold cases
    # monitors that run many times per second and take some percent of the time
    "distributed.worker.profile.enabled": False,
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.admin.tick.interval": "1s",
}
"""Settings of the dask that is started here."""


@dataclass(frozen=True)
class Engine:
    """The place where batches are solved.

    That is a client that runs already where one is given, a running dask scheduler where an address
    is, Slurm jobs where a profile is, else threads or processes of this machine. Schedulers and
    dashboards that are started here listen on the loopback alone, except the scheduler of Slurm
    jobs, which listens on the profile's interface. dask's own configuration applies, TLS included.
    """

    kind: Literal["threads", "processes"] = "threads"
    workers: int = 1
    address: str = ""
    profile: Profile | None = None
    batch_seconds: float = 2.0
    """Duration of a task, roughly."""
    dask_client: Client | None = None
    """A client that somebody else has made, and closes."""

    @contextmanager
    def kept_open(self) -> Iterator[Engine]:
        """Give this engine with one client, open from its first use to the end of the context."""
        with ExitStack() as stack:
            yield _OpenEngine(**vars(self), stack=stack)

    @contextmanager
    def client(self) -> Iterator[Client]:
        """Give a dask client as a context. Raises OSError when no scheduler answers.

        Raises ValueError for an asynchronous client of one's own.
        """
        if self.dask_client is not None:
            if self.dask_client.asynchronous:
                raise ValueError("client: is asynchronous: give Client(..., asynchronous=False)")
            yield self.dask_client
            return
        for name in _LOGGERS:  # errors are raised and reported by the command
            logging.getLogger(name).setLevel(logging.CRITICAL)
        logging.getLogger("asyncio").addFilter(_no_late_timeout)
        tls = self.address.startswith("tls:")
        if tls and not Security().get_connection_args("client")["ssl_context"]:
            reason = "dask's settings name no certificate (distributed.comm.tls)"
            raise OSError(f"{self.address}: {reason}")
        # no client is dask's default: xarray would lock its files through the scheduler, which is
        # slow and never ends after Ctrl-C
        clients: AbstractContextManager[Client]
        with dask.config.set(_SETTINGS):
            if self.address:
                clients = Client(self.address, timeout=_PATIENCE, set_as_default=False)
            elif self.profile:
                clients = _slurm(self.profile)
            else:
                clients = _here(self.workers, processes=self.kind == "processes")
            with clients as client:
                yield client


@dataclass(frozen=True)
class _OpenEngine(Engine):
    """An engine whose client stays open until the stack is closed."""

    stack: ExitStack = field(default_factory=ExitStack)
    clients: list[Client] = field(default_factory=list)

    @contextmanager
    def kept_open(self) -> Iterator[Engine]:
        yield self

    @contextmanager
    def client(self) -> Iterator[Client]:
        if not self.clients:
            self.clients.append(self.stack.enter_context(super().client()))
        yield self.clients[0]


def with_one_client(
    function: Callable[Concatenate[Subject, Path, Engine, Arguments], Answer],
) -> Callable[Concatenate[Subject, Path, Engine, Arguments], Answer]:
    """Return the function with one client for all designs that it solves: a client takes 0.1 s."""

    @wraps(function)
    def with_client(
        subject: Subject,
        path: Path,
        engine: Engine,
        /,
        *args: Arguments.args,
        **options: Arguments.kwargs,
    ) -> Answer:
        with engine.kept_open() as kept:
            return function(subject, path, kept, *args, **options)

    return with_client


def _no_late_timeout(record: logging.LogRecord) -> bool:
    """Return False for a timeout that dask leaves when its loop ends while a sender waits."""
    return not isinstance(record.exc_info and record.exc_info[1], TornadoTimeoutError)


@contextmanager
def _slurm(profile: Profile) -> Iterator[Client]:
    with slurm_cluster(profile) as cluster:
        submit = partial(cluster.scale, jobs=profile.jobs)
        again = PeriodicCallback(submit, 1e3 * _SUBMIT_AGAIN)  # jobs end, at last by walltime
        submit()
        cluster.loop.add_callback(again.start)
        try:
            with Client(cluster, set_as_default=False) as client:
                yield client
        finally:
            cluster.loop.add_callback(again.stop)


@contextmanager
def _here(workers: int, *, processes: bool) -> Iterator[Client]:
    try:
        with _interrupts_held():
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
def _interrupts_held() -> Iterator[None]:
    """Hold Ctrl-C back while workers start: they inherit that, and only the main process stops.

    Windows has no such mask.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # started later, it would unblock the signal
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class Profile(FileSection):
    """A Slurm job: keys of dask_jobqueue.SLURMCluster, and the number of jobs."""

    jobs: Annotated[int, Field(ge=1)]
    """Jobs to submit; those that have started solve the study."""
    interface: str
    """Network by which this machine and the jobs reach each other, such as ib0."""
    cores: Annotated[int, Field(ge=1)]
    processes: Annotated[int, Field(ge=1)] = 1
    """Processes that share the cores of a job."""
    memory: str
    walltime: str
    queue: str | None = None
    account: str | None = None
    job_extra_directives: tuple[str, ...] = ()
    job_script_prologue: tuple[str, ...] = ()
    log_directory: str | None = None
    python: str | None = None
    """Interpreter on the nodes; by default that of this process."""


def read_profile(path: Path) -> Profile:
    """Return the profile in a YAML file. Raises StudyError naming file and key."""
    return validated(Profile, read_mapping(read_text(path), str(path)), str(path))


def slurm_cluster(profile: Profile) -> SLURMCluster:
    """Return the cluster, no job submitted yet. Raises OSError without dask-jobqueue or Slurm."""
    try:
        from dask_jobqueue.slurm import SLURMCluster
    except ImportError:
        raise OSError("dask-jobqueue is not installed: pip install 'impactlab[slurm]'") from None
    if not shutil.which("sbatch"):
        raise OSError("there is no command sbatch here: run this where Slurm jobs are submitted")
    return SLURMCluster(
        n_workers=0,
        scheduler_options={"dashboard_address": _LOOPBACK},
        **profile.model_dump(exclude={"jobs"}, exclude_none=True),
    )
