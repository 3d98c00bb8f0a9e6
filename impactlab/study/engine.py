"""Where batches are solved: dask, on this machine or on a cluster."""

from __future__ import annotations

import logging
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from typing import Literal

from distributed import Client

_LOOPBACK = "127.0.0.1:0"


@dataclass(frozen=True)
class Engine:
    """On a running dask scheduler where an address is given, else in threads or processes here."""

    kind: Literal["threads", "processes"] = "threads"
    workers: int = 1
    address: str = ""
    batch_seconds: float = 1.0
    """Of a task, about."""

    @contextmanager
    def client(self) -> Iterator[Client]:
        """A dask client for the time of a study. Raises OSError when no scheduler answers."""
        # not as default: xarray would lock its files through the scheduler, slowly, and for ever
        # where Ctrl-C comes in between
        logging.getLogger("distributed").setLevel(logging.ERROR)
        if self.address:
            client = Client(self.address, timeout=10, set_as_default=False)
        else:
            apart = self.kind == "processes"
            with _deaf_to_ctrl_c():
                client = Client(
                    processes=apart,
                    n_workers=self.workers if apart else 1,
                    threads_per_worker=1 if apart else self.workers,
                    dashboard_address=_LOOPBACK,
                    worker_dashboard_address=_LOOPBACK,
                    memory_limit=0,
                    silence_logs=logging.ERROR,
                    set_as_default=False,
                )
        with client:
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
