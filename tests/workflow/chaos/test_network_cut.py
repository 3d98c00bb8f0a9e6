"""Workers in a network namespace of their own, which is cut off while they solve."""

import os
import subprocess
from contextlib import contextmanager

import pytest
from chaos import SMALL, assert_same_bits, run, stored
from cluster import SOON, Cluster

pytestmark = pytest.mark.chaos

HERE, THERE = "10.213.77.1", "10.213.77.2"
"""Both ends of a cable."""


def ip(*args):
    return subprocess.run(["ip", *args], capture_output=True, text=True)


@contextmanager
def namespace(name):
    """A network namespace, joined by a cable to this one."""
    cable, far = f"{name}-a", f"{name}-b"
    steps = [
        ("netns", "add", name),
        ("link", "add", cable, "type", "veth", "peer", "name", far, "netns", name),
        ("addr", "add", f"{HERE}/30", "dev", cable),
        ("link", "set", cable, "up"),
        ("-n", name, "addr", "add", f"{THERE}/30", "dev", far),
        ("-n", name, "link", "set", far, "up"),
        ("-n", name, "link", "set", "lo", "up"),
    ]
    try:
        for step in steps:
            if (done := ip(*step)).returncode != 0:
                pytest.skip(f"no network namespaces here: {done.stderr.strip()}")
        yield ["ip", "netns", "exec", name]
    finally:
        ip("netns", "delete", name)
        ip("link", "delete", cable)


@pytest.fixture
def apart():
    """The name of a namespace, and the command that runs others inside."""
    name = f"chaos{os.getpid() % 100_000}"
    with namespace(name) as inside:
        yield name, inside


def test_the_worker_cut_off(folder, apart, undisturbed):
    """It says so and waits; a worker that comes later takes over what it had."""
    name, inside = apart
    with Cluster(folder, HERE, **SOON) as cluster:
        cluster.add(inside=inside)
        cluster.wait_for(1)
        command = run(folder, "--scheduler", cluster.address, *SMALL)
        command.wait_for_shards(3)
        ip("-n", name, "link", "set", f"{name}-b", "down")
        command.wait_until(lambda: "no worker" in command.said)
        assert not command.ended, command.said
        cluster.add()
        assert command.end() == 0, command.said
    assert_same_bits(stored(folder), undisturbed)
