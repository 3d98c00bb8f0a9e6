"""Files that were edited by hand, or that impactlab did not make: no command takes them."""

import shutil

import pytest
import xarray as xr
from command_line import CHECKS, SMALL, called, done

SAMPLE = """
title: Sample
impact: {base: paper}
discretisation: {auto: {tolerance: 50 %, responses: [peak_force]}}
duration: 0.2 ms
sampling:
  method: sobol
  base_samples: 16
  second_order: false
  parameters:
    velocity: {distribution: uniform, low: 1, high: 2}
    beam_depth: {distribution: uniform, low: 25 mm, high: 30 mm}
responses: [peak_force]
analysis: {resamples: 20}
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with results of every kind."""
    folder = tmp_path_factory.mktemp("made")
    (folder / "studies").mkdir()
    texts = {"small": SMALL, "other": SMALL.replace("0.5", "0.6"), "checks": CHECKS}
    for name, text in (texts | {"sample": SAMPLE}).items():
        (folder / "studies" / f"{name}.yaml").write_text(text)
    for name in ("small", "other", "sample"):
        done("run", f"studies/{name}.yaml", cwd=folder)
        done("analyse", f"results/{name}/runs.nc", cwd=folder)
    done("design", "studies/small.yaml", cwd=folder)
    done("refine", "results/sample/runs.nc", cwd=folder)
    done("verify", "studies/checks.yaml", cwd=folder)
    return folder


@pytest.fixture
def results(made, tmp_path):
    """A copy of them to damage."""
    whole = shutil.ignore_patterns("shards", "trials", "refinement")
    return shutil.copytree(made / "results", tmp_path / "results", ignore=whole)


def foreign(path):
    xr.Dataset({"a": ("x", [1.0, 2.0])}).to_netcdf(path)


def text(path):
    path.write_bytes(b"CDF\x01 or so \xff")


def cut(path):
    path.write_bytes(path.read_bytes()[:-999])


def folder(path):
    path.unlink()
    path.mkdir()


def of_another_kind(path):
    kind = "analysis" if path.name == "runs.nc" else "runs"
    shutil.copy(path.parents[1] / "small" / f"{kind}.nc", path)


def edited(change):
    """What xarray saves after `change` of a dataset."""

    def damage(path):
        change(xr.load_dataset(path)).to_netcdf(path)

    damage.__name__ = change.__name__
    return damage


def numbers(dataset):
    return [name for name, values in dataset.variables.items() if values.dtype.kind == "f"]


@edited
def tripled(dataset):
    name = numbers(dataset)[0]
    return dataset.assign({name: dataset[name].fillna(1.0) * 3})


@edited
def swapped(dataset):
    one, two = numbers(dataset)[:2]
    return dataset.assign({one: dataset[one].copy(data=dataset[one].values + 1e-9)}).rename(
        {one: two, two: one}
    )


@edited
def other_units(dataset):
    dataset[numbers(dataset)[0]].attrs["units"] = "kN"
    return dataset


@edited
def other_settings(dataset):
    return dataset.assign_attrs(confidence=-1.0, seed=7)


@edited
def one_more(dataset):
    return dataset.assign(more=1.0)


@edited
def of_an_older_version(dataset):
    del dataset.attrs["checksums"]
    return dataset


DAMAGES = [foreign, text, cut, folder, of_another_kind, tripled, swapped, other_units]
DAMAGES += [other_settings, one_more, of_an_older_version]
PAIR = "small/runs.nc small/analysis.nc"
COMMANDS = [
    ("run small/design.nc", "small/design.nc"),
    ("refine sample/runs.nc", "sample/runs.nc"),
    ("analyse small/runs.nc", "small/runs.nc"),
    ("analyse sample/runs.nc --resolution sample/resolution.nc", "sample/resolution.nc"),
    ("analyse sample/runs.nc --refinement sample/refinement.nc", "sample/refinement.nc"),
    ("predict sample/surrogate.nc velocity=1.5", "sample/surrogate.nc"),
    ("verify checks/findings.nc", "checks/findings.nc"),
    (f"figures {PAIR}", "small/runs.nc"),
    (f"figures {PAIR}", "small/analysis.nc"),
    ("figures checks/findings.nc", "checks/findings.nc"),
    (f"report {PAIR}", "small/runs.nc"),
    (f"report {PAIR}", "small/analysis.nc"),
    ("report checks/findings.nc", "checks/findings.nc"),
    ("paper small --output paper", "small/analysis.nc"),
]


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
@pytest.mark.parametrize(("command", "name"), COMMANDS)
def test_no_command_takes_them(results, command, name, damage):
    damage(results / name)
    before = sorted(results.rglob("*"))
    ended = called(*command.split(), cwd=results)
    assert ended.returncode, ended.stdout
    assert name in ended.stderr
    assert len(ended.stderr.splitlines()) == 1
    assert sorted(results.rglob("*")) == before
