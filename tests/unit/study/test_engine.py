"""What is started here can be reached from here alone."""

import psutil
import pytest

from impactlab.study.engine import Engine


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
