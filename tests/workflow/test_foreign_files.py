"""Files that were edited by hand, or that impactlab did not make: no command takes them."""

import shutil

import pytest
import xarray as xr
from command_line import CHECKS, SMALL, called, done

from impactlab.files import read_netcdf, write_netcdf

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
    shutil.copy(path.parents[1] / "other" / f"{kind}.nc", path)


def edited(change):
    """Save a dataset after `change` with xarray."""

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
def test_no_kind_of_file_is_read(results, damage):
    for name in sorted({name for _, name in COMMANDS}):
        kind = xr.load_dataset(results / name).attrs["content"]
        damage(results / name)
        with pytest.raises((OSError, ValueError), match=name):
            read_netcdf(results / name, kind)


@pytest.mark.parametrize("damage", [tripled, of_another_kind], ids=lambda damage: damage.__name__)
@pytest.mark.parametrize(("command", "name"), COMMANDS)
def test_no_command_takes_them(results, command, name, damage):
    damage(results / name)
    before = sorted(results.rglob("*"))
    ended = called(*command.split(), cwd=results)
    assert ended.returncode, ended.stdout
    assert name in ended.stderr
    assert len(ended.stderr.splitlines()) == 1
    assert sorted(results.rglob("*")) == before


def test_analyses_and_evidence_of_other_runs_are_refused(results):
    """Runs that were solved again since are other runs, too."""
    for step in ("figures", "report"):
        ended = called(step, "small/runs.nc", "other/analysis.nc", cwd=results)
        assert ended.returncode
        assert "other/analysis.nc: was not made from small/runs.nc" in ended.stderr
    for name in ("small", "sample"):
        runs = read_netcdf(results / name / "runs.nc", "runs")
        changed = runs.assign(peak_force=3 * runs["peak_force"])
        write_netcdf(changed, results / name / "runs.nc", "runs")
    for step in ("figures", "report"):
        ended = called(step, *PAIR.split(), cwd=results)
        assert ended.returncode
        assert "`impactlab analyse small/runs.nc`" in ended.stderr
    evidence = ("--refinement", "sample/refinement.nc")
    ended = called("analyse", "sample/runs.nc", *evidence, cwd=results)
    assert ended.returncode
    assert "sample/refinement.nc: was not made from sample/runs.nc" in ended.stderr


def test_figures_of_other_results_are_refused(results, blank_pictures):
    runs, path = (results / "small" / name for name in ("runs.nc", "analysis.nc"))
    done("figures", runs, path, cwd=results)
    captions = path.parent / "figures" / "captions.json"
    sound = captions.read_text()
    for hostile in ("[]", "{", '{"../../other": {}}', '{"a": 1}'):
        captions.write_text(hostile)
        ended = called("report", runs, path, cwd=results)
        assert ended.returncode
        assert "captions.json: is damaged" in ended.stderr
    captions.write_text(sound)
    analysis, solved = read_netcdf(path, "analysis"), read_netcdf(runs, "runs")
    write_netcdf(analysis.assign_attrs(title="Another"), path, "analysis", solved)
    ended = called("report", runs, path, cwd=results)
    assert ended.returncode
    assert "figures: its figures were drawn from other results" in ended.stderr


def test_an_index_names_a_foreign_file(results):
    (results / "small" / "report.html").touch()
    foreign(results / "small" / "runs.nc")
    ended = called("index", ".", cwd=results)
    assert ended.returncode
    assert "small/runs.nc: has no checksums" in ended.stderr


@pytest.mark.parametrize(
    "command",
    [
        "simulate --output there",
        "run studies/small.yaml --output there",
        "design studies/small.yaml --output there",
        "recommend studies/sample.yaml --output there",
        "refine results/sample/runs.nc --output there",
        "analyse results/small/runs.nc --output there",
        "verify studies/checks.yaml --output there",
        "report results/checks/findings.nc --output there",
        "index results --output there",
    ],
)
def test_an_output_that_is_a_folder_is_refused_at_once(made, command):
    (made / "there").mkdir(exist_ok=True)
    ended = called(*command.split(), cwd=made)
    assert ended.returncode
    assert "'there' is a directory" in ended.stderr
    assert not list((made / "there").iterdir())


def test_a_file_saved_again_unchanged_is_still_accepted(results):
    for path in results.rglob("*.nc"):
        before = xr.load_dataset(path)
        before.to_netcdf(path)
        assert read_netcdf(path, before.attrs["content"]).identical(before)


def test_lazy_values_get_the_digests_of_those_in_memory(results, tmp_path):
    path = results / "small" / "runs.nc"
    with xr.open_dataset(path, chunks={"velocity": 1}) as lazy:
        write_netcdf(lazy, tmp_path / "lazy.nc", "runs")
    same = read_netcdf(tmp_path / "lazy.nc", "runs").attrs["checksums"]
    assert same == read_netcdf(path, "runs").attrs["checksums"]


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_every_file_follows_cf(results):
    """But for one rule: `time`, since first touch, is no date and has no standard_name."""
    pytest.importorskip("compliance_checker")
    from compliance_checker.runner import CheckSuite, ComplianceChecker

    done("figures", "small/runs.nc", "small/analysis.nc", cwd=results)
    done("simulate", "--nodes", "21", "--output", "one.nc", cwd=results)
    paths = [*results.glob("s*/*.nc"), *results.glob("*.nc"), results / "checks" / "findings.nc"]
    paths.append(next(results.glob("small/figures/*.nc")))
    CheckSuite.load_all_available_checkers()
    for path in paths:
        passed, _ = ComplianceChecker.run_checker(
            str(path),
            ["cf:1.11"],
            verbose=0,
            criteria="strict",
            skip_checks=["check_spatiotemporal_dims_have_coordinate_vars"],
            output_filename=str(results / "cf.txt"),
        )
        assert passed, (results / "cf.txt").read_text()


def test_an_edited_resolution_is_found_anew(made, results):
    shutil.copytree(made / "studies", results.parent / "studies")
    tripled(results / "sample" / "resolution.nc")
    ended = done("run", "studies/sample.yaml", cwd=results.parent)
    assert "was changed after it was written" in ended.stderr
    assert "the pilot runs are solved again" in ended.stderr
    read_netcdf(results / "sample" / "resolution.nc", "resolution")
