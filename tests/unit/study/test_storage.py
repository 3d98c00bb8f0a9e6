"""Shards: found again by content, and never when damaged."""

import numpy as np
import pytest
import xarray as xr

import impactlab as il
from impactlab.simulate import case_table, solve
from impactlab.study.netcdf import read_netcdf
from impactlab.study.solvers import impact
from impactlab.study.storage import Form, Shards, run_keys

FORM = Form(samples=11, profiles=True)


def cases(*velocities, nodes=11):
    grid = il.Discretisation(nodes=nodes, points=3)
    return case_table(il.paper_impact(), grid, duration=2e-4, varied={"velocity": list(velocities)})


@pytest.fixture
def shards(tmp_path):
    return Shards(tmp_path, FORM, impact.RESPONSE, impact.VERSION)


def written(shards, table):
    answers = solve(table, samples=FORM.samples, profiles=FORM.profiles)
    keys = run_keys(table, FORM, impact.VERSION)
    return keys, answers, shards.write(keys, answers)


def test_what_was_written_is_read_to_the_bit(shards):
    keys, answers, _ = written(shards, cases(0.5, 1.0, 2.0))
    ((found_keys, found),) = shards.read()
    assert found_keys == keys
    assert found.responses.tobytes() == answers.responses.tobytes()
    for ours, theirs in (
        (answers.histories, found.histories),
        (answers.profiles, found.profiles),
    ):
        assert ours.keys() == theirs.keys()
        assert all(np.array_equal(ours[name], theirs[name]) for name in ours)


def test_keys_tell_apart_every_field_and_form():
    table = cases(0.5, 1.0)
    keys = set(run_keys(table, FORM, impact.VERSION))
    for name in table.dtype.names:
        other = table.copy()
        other[name] += 1
        assert keys.isdisjoint(run_keys(other, FORM, impact.VERSION)), name
    assert keys.isdisjoint(run_keys(table, Form(samples=12, profiles=True), impact.VERSION))
    assert keys.isdisjoint(run_keys(table, Form(samples=11, profiles=False), impact.VERSION))


@pytest.mark.parametrize("damage", ["truncated", "flipped", "foreign", "empty"])
def test_damaged_shards_are_passed_over_and_named(shards, damage, caplog):
    written(shards, cases(0.5))
    _, _, path = written(shards, cases(1.0))
    content = bytearray(path.read_bytes())
    if damage == "truncated":
        path.write_bytes(content[: len(content) // 2])
    elif damage == "flipped":
        force = read_netcdf(path)["peak_force"].values.tobytes()
        content[content.index(force)] ^= 1
        path.write_bytes(content)
    elif damage == "foreign":
        xr.Dataset({"key": ("run", [1.0])}).to_netcdf(path)
    else:
        path.write_bytes(b"")
    found = list(shards.read())
    assert len(found) == 1
    assert found[0][0] == run_keys(cases(0.5), FORM, impact.VERSION)
    assert str(path) in caplog.text


def test_other_forms_are_not_seen(shards, tmp_path):
    written(shards, cases(0.5))
    other = Shards(tmp_path, Form(samples=0, profiles=False), impact.RESPONSE, impact.VERSION)
    assert list(other.read()) == []


def test_one_shard_takes_the_place_of_all(shards):
    keys, answers, _ = written(shards, cases(0.5, 1.0))
    written(shards, cases(2.0))
    shards.replace_all(keys, answers)
    ((found, _),) = shards.read()
    assert found == keys
