"""Execution: the same bits for any workers and batches, no run solved twice, balanced tasks."""

from dataclasses import replace
from threading import Barrier

import numpy as np
import pytest
import xarray as xr
from distributed import LocalCluster

import impactlab as il
from impactlab.model.case_table import case_table
from impactlab.model.cost import node_steps
from impactlab.model.parameters import flatten
from impactlab.solve import fibre_section
from impactlab.solver import SCHEMES
from impactlab.solver.contact.history import make_pair
from impactlab.solver.stability import discretise
from impactlab.study import execute as executing
from impactlab.study.engine import Engine
from impactlab.study.execute import Batches, execute, solve_batch
from impactlab.study.solvers import kernels
from impactlab.study.store import OutputSpec, Shards
from impactlab.variables import RESPONSES

pytestmark = pytest.mark.filterwarnings("ignore::impactlab.TooShortWarning")

RESPONSES_ASKED = ["peak_force", "contact_duration", "restitution"]


def design(velocities=(0.5, 1.0, 5.0), nodes=(11, 21), **attrs):
    fixed = flatten(il.paper_impact(), il.Discretisation(points=3))
    del fixed["velocity"], fixed["nodes"]
    return xr.Dataset(
        # netCDF may hand the dimensions back in any order: not that of `varied`
        coords={"nodes": list(nodes), "velocity": list(velocities), "duration": 4e-4} | fixed,
        attrs={
            "study": "made_up",
            "varied": ["velocity", "nodes"],
            "responses": RESPONSES_ASKED,
            "histories": 1,
            "profiles": 0,
            "history_samples": 21,
        }
        | attrs,
    )


@pytest.fixture
def solved(monkeypatch):
    """Return the list of the numbers of runs submitted, one per study."""
    counts = []
    original = executing.solved

    def counted(work, missing, engine):
        counts.append(missing.size)
        return original(work, missing, engine)

    monkeypatch.setattr(executing, "solved", counted)
    return counts


def test_runs_carry_the_labels_of_the_design(tmp_path):
    runs = execute(design(), tmp_path, Engine(workers=2))
    assert set(RESPONSES_ASKED) | {"status", "contact_force"} <= set(runs.data_vars)
    assert not set(RESPONSES) - set(RESPONSES_ASKED) & set(runs.data_vars)
    assert runs["peak_force"].dims == ("velocity", "nodes")
    for velocity, nodes in ((0.5, 11), (0.5, 21), (5.0, 11), (5.0, 21)):
        grid = il.Discretisation(nodes=nodes, points=3)
        alone = il.simulate(il.paper_impact(velocity), grid, duration=4e-4, samples=21)
        here = runs.sel(velocity=velocity, nodes=nodes)
        for name in (*RESPONSES_ASKED, "contact_force", "time"):
            np.testing.assert_array_equal(here[name].values, alone[name].values, err_msg=name)


def test_workers_that_come_later_need_not_wait_for_a_task_to_end(tmp_path, monkeypatch):
    monkeypatch.setattr(executing, "_RUNS", 1)  # one run per task
    monkeypatch.setattr(executing, "_LOOK_AGAIN", 0.05)
    solve, all_at_once = kernels.SOLVER.solve, Barrier(6)

    def together(cases, output):
        if cases.size:
            cluster.scale(6)
            all_at_once.wait(timeout=60)  # or BrokenBarrierError
        return solve(cases, output)

    monkeypatch.setattr(kernels, "SOLVER", replace(kernels.SOLVER, solve=together))
    one = {
        "n_workers": 1,
        "threads_per_worker": 1,
        "processes": False,
        "dashboard_address": "127.0.0.1:0",
    }
    with LocalCluster(**one) as cluster:
        runs = execute(design(), tmp_path, Engine(address=cluster.scheduler_address))
    assert np.isfinite(runs["peak_force"]).all()


@pytest.mark.parametrize("engine", [Engine("threads", 3), Engine("processes", 2)])
def test_same_bits_for_any_engine_and_batch_size(tmp_path, engine, monkeypatch):
    whole = execute(design(), tmp_path / "one", Engine("threads", 1))
    monkeypatch.setattr(executing, "_RUNS", 1)  # one run per task
    split = execute(design(), tmp_path / "two", engine)
    for name in whole.data_vars:
        assert whole[name].values.tobytes() == split[name].values.tobytes(), name


def test_a_change_solves_just_what_it_touches(tmp_path, solved):
    first = execute(design(), tmp_path, Engine())
    assert sum(solved) == 6
    again = execute(design(), tmp_path, Engine())
    assert sum(solved) == 6
    assert again.drop_attrs().identical(first.drop_attrs())
    solved.clear()
    execute(design(velocities=(0.5, 1.0, 7.0)), tmp_path, Engine())
    assert sum(solved) == 2  # the new velocity at two node counts
    solved.clear()
    execute(design(responses=["impulse"]), tmp_path, Engine())
    assert sum(solved) == 0  # other responses of the same runs


def test_interrupted_studies_go_on(tmp_path, solved, monkeypatch):
    monkeypatch.setattr(executing, "_RUNS", 1)
    write = Shards.write
    kept = []

    def failing(self, keys, columns):
        if len(kept) >= 3:
            raise KeyboardInterrupt
        kept.extend(keys)
        return write(self, keys, columns)

    with monkeypatch.context() as interrupted:
        interrupted.setattr(Shards, "write", failing)
        with pytest.raises(KeyboardInterrupt):
            execute(design(), tmp_path, Engine())
    solved.clear()
    resumed = execute(design(), tmp_path, Engine())
    assert 0 < sum(solved) == 6 - len(kept)
    fresh = execute(design(), tmp_path / "fresh", Engine())
    assert resumed.drop_attrs().identical(fresh.drop_attrs())


def test_equal_runs_are_solved_once(tmp_path, solved, caplog):
    caplog.set_level("INFO")
    runs = execute(design(velocities=(1.0, 1.0)), tmp_path, Engine())
    assert "2 runs (2 more are equal to one of them), 0 of them solved before" in caplog.text
    assert sum(solved) == 2
    np.testing.assert_array_equal(runs["peak_force"][0], runs["peak_force"][1])


def test_failures_are_data(tmp_path):
    """The status keeps only the reasons of the responses that are asked for."""
    runs = execute(design().assign_coords(duration=1e-4), tmp_path, Engine())
    assert np.isnan(runs["contact_duration"]).all()
    assert (runs["status"] != 0).all()
    short = design(responses=["energy_error"]).assign_coords(duration=1e-4)
    assert (execute(short, tmp_path, Engine())["status"] == 0).all()


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("nodes", [201, 601])
def test_the_estimated_cost_is_that_of_the_kernels_steps(scheme, nodes):
    grid = il.Discretisation(nodes=nodes, points=21, scheme=scheme)
    case = case_table(il.paper_impact(), grid, duration=1e-3)[0]
    _, steps = discretise(case, make_pair(case), fibre_section(case))
    assert node_steps(case) == pytest.approx(0.5 * nodes * steps, rel=0.02)


def test_workers_with_other_kernels_are_refused():
    cases = kernels.cases(design(), np.arange(2))
    with pytest.raises(RuntimeError, match="another version"):
        solve_batch("impact", cases, OutputSpec(0, False), "other")


def simulated(cost, speed, workers, values=20):
    """Take batches and learn from them one after the other, for workers of this speed."""
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


def test_sizes_follow_a_change_of_cost():
    """Runs cost ten times their estimate from the middle on."""
    batches = Batches(np.arange(200_000), np.full(200_000, 3e5), 20)
    seconds = []
    while (runs := batches.take(2)).size:
        seconds.append(runs.size * (1e-3 if runs[0] < 100_000 else 1e-2))
        batches.learn(3e5 * runs.size, seconds[-1])
    assert np.median(seconds) == pytest.approx(1.0, abs=0.05)
    assert max(seconds) < 11


def test_memory_and_cost_bound_a_task():
    taken, _ = simulated(np.full(1000, 1.0), 3e8, workers=1, values=executing._VALUES // 10)
    assert max(runs.size for runs in taken) == 10
    taken, _ = simulated(np.full(100_000, 1e-3), 3e8, workers=1, values=1)
    assert max(runs.size for runs in taken) == executing._RUNS
    taken, _ = simulated(np.full(7, 3e10), 3e8, workers=2)
    assert [runs.size for runs in taken] == [1] * 7
