"""However the runs are spread, and in whatever batches: the same bits."""

import pytest
from chaos import assert_same_bits, resumed
from cluster import Cluster

pytestmark = pytest.mark.chaos


@pytest.mark.parametrize(
    ("engine", "workers", "seconds"),
    [((), 3, 1), (("--processes",), 3, 0.01)],
)
def test_here(folder, engine, workers, seconds, undisturbed):
    options = ("--workers", workers, "--batch-seconds", seconds)
    runs, _ = resumed(folder, *engine, *options)
    assert_same_bits(runs, undisturbed)


def test_on_a_cluster_of_three(folder, undisturbed):
    with Cluster(folder) as cluster:
        cluster.add(3)
        options = ("--scheduler", cluster.address, "--batch-seconds", 0.3)
        runs, _ = resumed(folder, *options)
    assert_same_bits(runs, undisturbed)
