"""Whose results are stored: nothing is replaced by another study unasked, nothing stale is left."""

import re
import shutil
from pathlib import Path

import pytest
import xarray as xr
from command_line import called, done

import impactlab as il
from impactlab.files import read_netcdf, write_netcdf
from impactlab.report.results import write_index
from impactlab.study.ownership import same_runs
from impactlab.study.steps import removable

YAML = """
title: Ishigami
function: ishigami
sampling:
  method: pawn
  samples: 128
  parameters:
    x1: {distribution: uniform, low: -3, high: 3}
    x2: {distribution: uniform, low: -3, high: 3}
"""
EDITED = YAML.replace("128", "256")
OTHERS = {"x1": il.Uniform(-3, 3), "x2": il.Uniform(-3, 3)}
MADE = ("analysis.nc", "indices.csv", "surrogate.nc", "distribution.csv", "report.html")
MADE += ("tables/runs.csv", "tables/indices.csv", "tables/answers.csv", "tables/ishigami.xlsx")


def python(samples=128, **others):
    sampling = il.Pawn(samples=samples, parameters=OTHERS)
    return il.Study(title="Ishigami", function="ishigami", sampling=sampling, **others)


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """A working folder with a study that was solved and reported."""
    folder = tmp_path_factory.mktemp("solved")
    for place in ("studies", "elsewhere"):
        (folder / place).mkdir()
    (folder / "studies" / "ishigami.yaml").write_text(YAML)
    done("go", "studies/ishigami.yaml", cwd=folder)
    for kind in ("csv", "xlsx"):
        done("export", "ishigami", "--to", kind, cwd=folder)
    return folder


@pytest.fixture
def folder(solved, tmp_path, monkeypatch):
    """A copy of it, worked in."""
    monkeypatch.chdir(shutil.copytree(solved, tmp_path / "project"))
    return Path.cwd()


def stored():
    return read_netcdf(Path("results/ishigami/runs.nc"), "runs")


def other_file():
    Path("elsewhere/ishigami.yaml").write_text(EDITED)
    return "elsewhere/ishigami.yaml"


@pytest.mark.slow
def test_another_study_of_the_same_name_is_refused_and_leaves_all_as_it_was(folder):
    files = [path for path in Path("results/ishigami").rglob("*") if path.suffix != ".json"]
    before = {path: path.read_bytes() for path in files if path.is_file()}
    with pytest.raises(
        ValueError, match=r"“Ishigami” \(\.\./\.\./studies/ishigami\.yaml\)"
    ) as said:
        python(samples=256).run(workers=1)
    assert "this one is “Ishigami” (built in Python)" in str(said.value)
    for command in ("run", "go", "design"):
        ended = called(command, other_file(), cwd=folder)
        assert ended.returncode == 1
        assert "another study" in ended.stderr
        assert "--replace" in ended.stderr
    assert {path: path.read_bytes() for path in before} == before
    assert "128 runs of another study" in called("status", other_file(), cwd=folder).stdout


@pytest.mark.parametrize("way", ["file", "design", "python"])
def test_replaced_when_asked_and_nothing_made_from_the_old_runs_is_left(folder, way):
    results = Path("results/ishigami")
    assert all((results / name).exists() for name in MADE)
    if way == "python":
        python(samples=256).run(workers=1, replace=True)
    else:
        file = other_file()
        if way == "design":
            done("design", file, "--output", "new.nc", cwd=folder)
            file = "new.nc"
        done("run", file, "--replace", cwd=folder)
    assert stored().sizes["run"] == 256
    assert not any((results / name).exists() for name in MADE)
    assert not any((results / "figures").iterdir())


def test_an_edited_file_is_the_same_study_wherever_its_project_lies(folder, monkeypatch):
    moved = shutil.copytree(folder, folder.parent / "moved")
    monkeypatch.chdir(moved)
    Path("studies/ishigami.yaml").write_text(EDITED)
    done("design", "studies/ishigami.yaml", cwd=moved)
    done("run", "results/ishigami/design.nc", cwd=moved)
    assert stored().sizes["run"] == 256
    assert "256 runs\n" in done("status", "studies/ishigami.yaml", cwd=moved).stdout
    Path("studies/ishigami.yaml").write_text(YAML)  # from there, too
    assert il.Study.from_yaml("studies/ishigami.yaml").run(workers=1).sizes["run"] == 128


def test_a_study_of_the_same_runs_takes_them_over(folder):
    assert python().run(workers=1).attrs["study_file"] == ""
    python(limits={"value": 3.0}).run(workers=1)
    sampling = il.Pawn(samples=128, parameters=OTHERS)
    with pytest.raises(ValueError, match="another study"):
        il.Study(title="Ishigami", function=lambda x1, x2: x1, sampling=sampling).run(workers=1)


def test_unchanged_runs_leave_the_report(folder):
    done("run", "studies/ishigami.yaml", cwd=folder)
    assert all(Path("results/ishigami", name).exists() for name in MADE)
    # a report is no pdf
    with pytest.raises(ValueError, match=r"^path = 'r.pdf': is written as HTML: its name must end"):
        il.Study.from_yaml("studies/ishigami.yaml").report("r.pdf")


def test_a_calibration_by_the_runs_before_goes(folder):
    calibration, sha256 = Path("results/ishigami/calibration.nc"), stored().attrs["study_sha256"]
    write_netcdf(xr.Dataset(attrs={"study_sha256": sha256}), calibration, "calibration")
    made = [calibration.with_suffix(suffix) for suffix in (".svg", ".html", ".index.json")]
    for path in made:
        path.touch()
    Path("results/ishigami/analysis.nc").unlink()
    done("run", "studies/ishigami.yaml", cwd=folder)
    assert calibration.exists()
    Path("studies/ishigami.yaml").write_text(EDITED)
    done("run", "studies/ishigami.yaml", cwd=folder)
    assert not any(path.exists() for path in [calibration, *made])


def test_tidying_up_leaves_the_runs_of_another_study(folder):
    report = Path("results/ishigami/report.html")
    text = report.read_text()
    python(samples=256).run(workers=1, replace=True)
    with removable(Path("studies"), Path("results")) as files:
        assert files == {}
    # the index lists no report of other runs
    report.write_text(text)
    write_index(Path("results"), Path("index.html"))
    assert "ishigami/report.html" not in Path("index.html").read_text()


def test_findings_of_another_file_are_not_replaced(folder):
    text = "title: Checks\nchecks: [half_space]\n"
    for place in ("studies", "elsewhere"):
        Path(place, "checks.yaml").write_text(text + f"description: {place}\n")
    done("verify", "studies/checks.yaml", cwd=folder)
    assert called("verify", "elsewhere/checks.yaml", cwd=folder).returncode == 1
    Path("studies/checks.yaml").write_text(text)
    done("verify", "studies/checks.yaml", cwd=folder)


def test_the_start_page_has_one_study_twice(tmp_path):
    page = (Path(__file__).parents[3] / "docs" / "start.md").read_text()
    file = tmp_path / "depth.yaml"
    file.write_text(re.search(r"```yaml\n(.*?)```", page, re.S)[1])
    built: dict = {"il": il}
    exec(re.search(r"(study = il\.Study\(.*?\n\))\n", page, re.S)[1], built)
    assert same_runs(built["study"].declared, il.Study.from_yaml(file).declared.attributes())
