"""Tasks of about a second, whatever a run costs."""

import numpy as np
import pytest

from impactlab.study import batches as batching
from impactlab.study.batches import Batches


def simulated(cost, speed, workers, values=20):
    """Batches taken and learnt from one after the other by workers of this speed."""
    batches = Batches(np.arange(cost.size), cost, values)
    taken = []
    while (runs := batches.take(workers)).size:
        taken.append(runs)
        batches.learn(cost[runs].sum(), cost[runs].sum() / speed)
    assert np.array_equal(np.concatenate(taken), np.arange(cost.size))
    return taken, np.array([cost[runs].sum() / speed for runs in taken])


@pytest.mark.parametrize("speed", [3e6, 3e8, 3e10])  # 3e8 is what is expected
def test_tasks_take_about_a_second_once_measured(speed):
    cost = np.full(100_000, speed / 1000)  # 100 s
    _, seconds = simulated(cost, speed, workers=2)
    settled = seconds[2:-20]
    assert settled.size > 50
    assert settled == pytest.approx(1.0, abs=0.05)


def test_the_first_tasks_measure_and_the_last_are_small():
    speed = 3e8
    _, seconds = simulated(np.full(30_000, speed / 1000), speed, workers=2)
    assert seconds[0] == pytest.approx(0.1, rel=0.05)
    assert seconds[-1] <= 0.06
    left = seconds.sum() - seconds.cumsum() + seconds
    assert (seconds <= np.maximum(left / 4, 0.05) + 0.001).all()  # to a run


def test_dear_runs_come_first_the_dearest_ahead():
    cost = np.array([3e7, 6e9, 3e7, 9e9, 3e7])
    batches = Batches(np.arange(5), cost, 20)
    assert [batches.take(2).tolist() for _ in range(2)] == [[3], [1]]
    assert np.concatenate([batches.take(2) for _ in range(3)]).tolist() == [0, 2, 4]


def test_a_dear_run_is_a_task_of_its_own():
    taken, _ = simulated(np.full(7, 3e10), 3e8, workers=2)
    assert [runs.size for runs in taken] == [1] * 7


def test_sizes_follow_a_change_of_cost():
    """Where a run costs ten times what it was said to, from the middle on."""
    batches = Batches(np.arange(200_000), np.full(200_000, 3e5), 20)
    seconds = []
    while (runs := batches.take(2)).size:
        seconds.append(runs.size * (1e-3 if runs[0] < 100_000 else 1e-2))
        batches.learn(3e5 * runs.size, seconds[-1])
    assert np.median(seconds) == pytest.approx(1.0, abs=0.05)
    assert max(seconds) < 11


def test_memory_bounds_a_task():
    taken, _ = simulated(np.full(1000, 1.0), 3e8, workers=1, values=batching._VALUES // 10)
    assert max(runs.size for runs in taken) == 10
    taken, _ = simulated(np.full(100_000, 1e-3), 3e8, workers=1, values=1)
    assert max(runs.size for runs in taken) == batching._RUNS
