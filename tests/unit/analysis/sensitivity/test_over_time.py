"""Indices over time: known ones, those of scalars, failed runs, and memory."""

import tracemalloc
from collections.abc import Callable

import dask
import numpy as np
import pytest
import xarray as xr

from impactlab import files
from impactlab.analysis import sensitivity
from impactlab.analysis.analyse import analyse
from impactlab.analysis.sensitivity import over_time
from impactlab.analysis.sensitivity.indices import sensitivity_variables, table_rows
from impactlab.analysis.sensitivity.over_time import HistoryVerdict, TimeVerdict
from impactlab.figures import single_runs
from impactlab.figures.labels import display
from impactlab.files import checked, opened, write_netcdf
from impactlab.methods.runs import Sample
from impactlab.methods.saltelli import saltelli
from impactlab.study.inventory import open_answers
from impactlab.study.store import OutputSpec, RunIndex, Shards
from impactlab.variables import STATUS_FLAGS

Build = Callable[..., xr.Dataset]
TIMES = np.array([0.0, 0.4, 0.8, 1.3, 1.5, 1.55, 1.6])  # dense where the indices differ most
Z95 = 1.959964
ORDERS = ("first_order", "total_order")


def oscillation(x, times):
    """x in (-1, 1); two terms of one parameter each, and one of both."""
    one, two = x[:, :1], x[:, 1:]
    return 3 * one * np.sin(times) + 2 * two * np.sin(2 * times) + 2 * one * two * times


def known(times):
    """Return variance (time,), and its parts of first and total order, (time, parameter)."""
    both = (2 * times) ** 2 / 9
    first = np.stack([(3 * np.sin(times)) ** 2 / 3, (2 * np.sin(2 * times)) ** 2 / 3], axis=1)
    return first.sum(axis=1) + both, first, first + both[:, None]


@pytest.fixture
def oscillating(sample_runs):
    """Build a Sobol sample whose contact force oscillates about `offset`."""

    def build(base, *, second_order=False, offset=50.0, times=TIMES):
        power = 1 << (base - 1).bit_length()  # a sample is nested
        x = 2 * saltelli(["x0", "x1"], power, second_order, 7) - 1
        x = x[: len(x) // power * base]
        force = oscillation(x, times) + offset
        runs = sample_runs(["x0", "x1"], base, second_order=second_order, peak_force=force[:, 3])
        runs = runs.assign_attrs(histories=1, history_samples=len(times))
        return runs.assign(contact_force=(("run", "time"), force)).assign_coords(time=times)

    return build


def test_known_indices_at_each_time_and_in_all(oscillating):
    found = over_time.analysis(oscillating(4096)).sel(history="contact_force")
    variance, *parts = known(TIMES)
    for order, part in zip(ORDERS, parts, strict=True):
        standard = found[f"{order}_over_time_interval"].values[1:] / Z95
        error = found[f"{order}_over_time"].values[1:] - part[1:] / variance[1:, None]
        assert (np.abs(error) <= 3 * standard).all()
        assert (standard < 0.03).all()
        whole = np.trapezoid(part, TIMES, axis=0) / np.trapezoid(variance, TIMES)
        standard = found[f"generalised_{order}_interval"].values / Z95
        assert (np.abs(found[f"generalised_{order}"].values - whole) <= 3 * standard).all()
        assert (standard < 0.025).all()
    np.testing.assert_allclose(found["history_mean"], 50.0, atol=0.02)
    np.testing.assert_allclose(found["history_deviation"], np.sqrt(variance), rtol=0.01)
    assert found["history_verdict"] == HistoryVerdict.USABLE
    # at the start all runs have one value, which is not 0
    assert found["first_order_over_time"].isel(time=0).isnull().all()
    codes = [TimeVerdict.CONSTANT] + [TimeVerdict.GIVEN] * 6
    assert found["time_verdict"].values.tolist() == codes


@pytest.mark.parametrize("second_order", [False, True])
def test_one_time_has_the_indices_of_that_number(oscillating, second_order):
    """Indices of a small sample depend on the mean that outputs are centred on."""
    runs = oscillating(512, second_order=second_order)
    scalar = sensitivity.analysis(runs).sel(response="peak_force")
    at = over_time.analysis(runs).isel(history=0, time=3)
    for order in ORDERS:
        np.testing.assert_allclose(at[f"{order}_over_time"], scalar[order], rtol=1e-10)
        interval = f"{order}_over_time_interval"
        np.testing.assert_allclose(at[interval], scalar[f"{order}_interval"], rtol=1e-6)


def test_a_time_at_which_the_runs_of_an_index_are_alike_leaves_that_index_undefined(oscillating):
    """Warnings are errors here, as they would stand on the page of a notebook."""
    runs = oscillating(256)
    runs["contact_force"][:, 2] = 0.0
    runs["contact_force"][3, 2] = 1.0  # of base sample B, in no index of total order
    found = over_time.analysis(runs).isel(history=0, time=2)
    assert found["total_order_over_time"].isnull().all()
    assert found["history_deviation"] > 0
    assert found["time_verdict"] == TimeVerdict.CONSTANT


def test_base_samples_with_a_failed_run_are_left_out_and_counted(oscillating):
    runs = oscillating(256, second_order=True)
    table = runs["status"].values.reshape(256, -1)
    table[200, 0] = table[17, 2] = STATUS_FLAGS["diverged"][0]
    runs["contact_force"][17 * 6 + 2] = np.nan
    runs["contact_force"][200 * 6] = 1e6  # wrong, and not missing
    runs["contact_force"][30 * 6 + 4, 5:] = np.nan  # at the last times, which no status tells
    found = over_time.analysis(runs).isel(history=0)
    kept = runs.isel(run=~np.repeat(np.isin(np.arange(256), [17, 200]), 6))
    alone = over_time.analysis(kept.assign_attrs(base_samples=254)).isel(history=0)
    for order in ORDERS:
        name = f"{order}_over_time"
        np.testing.assert_allclose(found[name][1:5], alone[name][1:5], rtol=1e-10)
        assert np.isfinite(found[name][5:]).all()
    assert found["base_samples_left_out"] == 3
    assert found["history_verdict"] == HistoryVerdict.RUNS_LEFT_OUT


@pytest.mark.parametrize("failed", [60, 256])
def test_too_many_failed_runs_give_no_index(oscillating, failed):
    runs = oscillating(256)
    runs["status"].values.reshape(256, -1)[:failed, 1] = STATUS_FLAGS["diverged"][0]
    found = over_time.analysis(runs).isel(history=0)
    assert found["base_samples_left_out"] == failed
    assert found["history_verdict"] == HistoryVerdict.TOO_FEW_RUNS
    assert (found["time_verdict"] == TimeVerdict.TOO_FEW_RUNS).all()
    for name in found.data_vars:
        assert found[name].dtype.kind != "f" or found[name].isnull().all()


def test_blocks_change_no_bit(oscillating, monkeypatch, tmp_path):
    runs = oscillating(333)
    sample, good = Sample.of(runs), np.arange(333) != 4
    whole, _ = over_time.sums(sample, "contact_force", good, slice(0, 7))
    assert whole[:, 0, 0].tolist() == [42, 42, 42, 42, 41, 41, 41, 41]
    for most in (1, 7, 333):
        other, _ = over_time.sums(sample, "contact_force", good, slice(0, 7), most)
        np.testing.assert_array_equal(other, whole)
    found = over_time.analysis(runs)
    write_netcdf(runs, tmp_path / "runs.nc", "runs")
    with checked(tmp_path / "runs.nc", "runs") as stored:
        xr.testing.assert_equal(over_time.analysis(stored), found)
    monkeypatch.setattr(over_time, "CELLS", 5000)  # a few times together
    xr.testing.assert_allclose(over_time.analysis(runs), found, rtol=1e-12)


@pytest.mark.slow
def test_memory_does_not_grow_with_the_runs(oscillating, monkeypatch, tmp_path):
    """From shards to runs.nc, analysis and caption; the file has the digests of one block."""
    monkeypatch.setattr(over_time, "ROWS", 64)
    monkeypatch.setattr(over_time, "CELLS", 50_000)
    monkeypatch.setattr(files, "_BLOCK", 1 << 15)
    path = tmp_path / "runs.nc"

    def peak(base):
        runs = oscillating(base, times=np.linspace(0.0, 1.0, 100)).assign_attrs(resamples=50)
        write_netcdf(runs, path, "runs")
        with opened(path, "runs") as whole:
            digests = whole.attrs["checksums"]
        keys = np.array([b"%016d" % run for run in runs["run"].values])
        shards = Shards(tmp_path / f"{base}", OutputSpec(100, False), "any")
        force = runs["contact_force"].values
        for part in (slice(start, start + 100) for start in range(0, len(keys), 100)):
            shards.write(keys[part][::-1], {"contact_force": force[part][::-1]})
        runs = runs.drop_vars("contact_force")
        tracemalloc.start()
        answers = open_answers(shards, RunIndex(keys), ["contact_force"])
        with answers as columns, dask.config.set(scheduler="synchronous"):
            answered = runs.assign(contact_force=(("run", "time"), columns["contact_force"]))
            write_netcdf(answered[[*whole]], path, "runs")
        with checked(path, "runs") as stored:
            assert stored.attrs["checksums"] == digests
            found = over_time.analysis(stored)
        with checked(path, "runs", blocks=True) as stored:
            single_runs.first_contact.caption(stored, found)
            display(stored["contact_force"])
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return most

    peak(90)  # whatever is loaded once
    more = 4 * (720 - 90) * 100 * 8  # bytes of the further histories
    assert peak(720) - peak(90) < 0.8 * more


def test_the_table_has_generalised_indices_and_the_file_all(oscillating):
    found = analyse(oscillating(64))
    kept = sensitivity_variables(found)
    assert {"first_order_over_time", "time_verdict", "base_samples_left_out"} <= set(kept)
    rows = [row for row in table_rows(kept) if row["response"] == "contact_force"]
    assert [(row["index"], row["parameter"]) for row in rows] == [
        (f"generalised_{order}", name) for order in ORDERS for name in ("x0", "x1")
    ]
    value = found["generalised_first_order"].values[0, 0]
    half = found["generalised_first_order_interval"].values[0, 0]
    assert (rows[0]["value"], rows[0]["low"]) == (value, value - half)
    assert rows[0]["verdict"] == "wide_intervals"


def test_only_a_sobol_sample_with_histories_has_them(oscillating):
    runs = oscillating(64)
    assert over_time.analysis(runs)
    assert not over_time.analysis(runs.drop_vars("contact_force"))
    assert not over_time.analysis(runs.assign_attrs(method="delta"))
    assert "generalised_first_order" not in analyse(runs.assign_attrs(analyses="sensitivity"))
    # a history that is the same in all runs has no index
    runs = oscillating(64)
    round_off = 1 + 1e-13 * np.random.default_rng(1).normal(size=runs["contact_force"].shape)
    runs["contact_force"][:] = 0.1 * TIMES * round_off
    found = over_time.analysis(runs).isel(history=0)
    assert found["history_verdict"] == HistoryVerdict.CONSTANT
    assert found["generalised_total_order"].isnull().all()
    assert (found["time_verdict"] == TimeVerdict.CONSTANT).all()
