"""Workers killed while they solve: the others go on, or the study ends in words and resumes."""

import signal
from contextlib import contextmanager

import pytest
from chaos import (
    SMALL,
    assert_same_bits,
    complaint,
    keys_on_disk,
    resumed,
    run,
    shards,
    solved_before,
    stored,
)
from cluster import Cluster

pytestmark = pytest.mark.chaos


def test_a_process_killed(folder, undisturbed):
    command = run(folder, "--workers", "2", "--processes", *SMALL)
    command.wait_for_shards(3)
    command.workers()[0].kill()
    assert command.end() == 0, command.said
    assert_same_bits(stored(folder), undisturbed)


def test_every_process_killed_again_and_again(folder, undisturbed):
    """A batch that ends its workers is given up after a few: here none is the batch's fault."""
    command = run(folder, "--workers", "2", "--processes", "--batch-seconds", "1")
    command.wait_until_it_solves()
    while not command.ended:
        for worker in command.workers():
            worker.kill()
        command.pause()
    assert command.end() == 1, command.said
    assert "worker" in complaint(command.said)
    goes_on(folder, undisturbed)


@contextmanager
def at_work(folder, workers):
    """A cluster, and a command that has solved some batches on it."""
    with Cluster(folder) as cluster:
        cluster.add(workers)
        command = run(folder, "--scheduler", cluster.address, *SMALL)
        command.wait_for_shards(3)
        yield cluster, command


def test_workers_of_a_cluster_killed(folder, undisturbed):
    """The others go on; without any it says so, and is interrupted while it waits."""
    with at_work(folder, workers=3) as (cluster, command):
        cluster.workers[0].kill()
        command.wait_for_shards(len(shards(folder)) + 5)
        for worker in cluster.workers:
            worker.kill()
        command.wait_until(lambda: "no worker" in command.said)
        command.send(signal.SIGINT)
        assert command.end() == 130, command.said
    goes_on(folder, undisturbed)


def test_the_scheduler_killed(folder, undisturbed):
    with at_work(folder, workers=1) as (cluster, command):
        cluster.scheduler.kill()
        assert command.end() == 1, command.said
    assert "scheduler" in complaint(command.said)
    goes_on(folder, undisturbed)


def goes_on(folder, undisturbed):
    before = len(keys_on_disk(folder))
    runs, said = resumed(folder)
    assert solved_before(said) == before
    assert_same_bits(runs, undisturbed)
