"""However the runs are spread, and in whatever batches: the same bits."""

import pytest
from chaos import assert_same_bits, resumed
from cluster import Cluster

pytestmark = pytest.mark.chaos


@pytest.mark.parametrize(
    ("engine", "workers", "seconds"),
    [((), 2, 0.01), ((), 3, 1), (("--processes",), 1, 0.3), (("--processes",), 3, 0.01)],
)
def test_here(folder, engine, workers, seconds, undisturbed):
    options = ("--workers", workers, "--batch-seconds", seconds)
    runs, _ = resumed(folder, *engine, *options)
    assert_same_bits(runs, undisturbed)


@pytest.mark.parametrize("seconds", [0.01, 1])
def test_on_a_cluster_of_three(folder, seconds, undisturbed):
    with Cluster(folder) as cluster:
        cluster.add(3)
        options = ("--scheduler", cluster.address, "--batch-seconds", seconds)
        runs, _ = resumed(folder, *options)
    assert_same_bits(runs, undisturbed)
