"""Texts of a study stay text: on pages, in tables, in figures, on a terminal; and in results/."""

import csv
from html.parser import HTMLParser

import pytest
import xarray as xr
from command_line import here as impactlab

from impactlab.files import write_netcdf

HOSTILE = (
    "=1+1 <script>alert(1)</script> <img src=x onerror=alert(1)> </title></pre> \"q' {{ 7*7 }} "
    "{% raw %} [red]b[/red] [link=http://e.vil]l[/link] $\\frac{$ \\LaTeX %s {0} &lt; @SUM ${x}"
)
STUDY = f"""
# {HOSTILE} -->
title: {HOSTILE.replace("'", "''")!r}
description: TEXT
function: ishigami
sampling:
  method: sobol
  base_samples: 64
  groups: {{one-a: [x1, x2]}}
  parameters:
    x1: {{distribution: uniform, low: -3, high: 3}}
    x2: {{distribution: uniform, low: -3, high: 3}}
    x3: {{distribution: uniform, low: -3, high: 3}}
analysis: {{resamples: 20}}
"""


def text():
    quoted = "'" + HOSTILE.replace("'", "''") + "'"
    head, _, rest = STUDY.partition("title: ")
    return f"{head}title: {quoted}\ndescription: {quoted}\n{rest.partition('TEXT' + chr(10))[2]}"


class Tags(HTMLParser):
    def __init__(self, page):
        super().__init__()
        self.found, self.data = [], ""
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.data += data


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "here" / "studies").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


def harmless(page, times):
    """No element or attribute of the hostile text is one, and the text stands there as it is."""
    found = Tags(page)
    assert not [attrs for _, attrs in found.found if any(key.startswith("on") for key in attrs)]
    assert not [attrs for _, attrs in found.found if attrs.get("src") == "x"]
    assert "script" not in {tag for tag, _ in found.found}
    assert found.data.count(HOSTILE) >= times


def test_from_a_hostile_study_to_its_pages(folder, monkeypatch, capsys):
    (folder / "studies" / "evil.yaml").write_text(text())
    results = folder / "results" / "evil"
    assert impactlab("run", "studies/evil.yaml", "--workers", 1) == 0
    runs, analysis = results / "runs.nc", results / "analysis.nc"
    assert impactlab("analyse", runs) == 0
    assert impactlab("figures", runs, analysis) == 0
    assert impactlab("report", runs, analysis) == 0
    assert impactlab("index") == 0
    assert xr.load_dataset(runs).attrs["title"] == HOSTILE
    harmless((results / "report.html").read_text("utf-8"), times=4)  # head, title, text, file
    harmless((folder / "results" / "index.html").read_text("utf-8"), times=1)
    tables = sorted(results.rglob("*.csv"))
    assert len(tables) > 1
    for path in tables:
        for row in csv.reader(path.read_text("utf-8").splitlines()):
            assert not [cell for cell in row if cell[:1] in tuple("=+-@\t") and not number(cell)]
    for path in results.rglob("*.svg"):
        assert b"<script" not in path.read_bytes()
    capsys.readouterr()
    monkeypatch.setenv("COLUMNS", "400")
    assert impactlab("studies") == 0
    assert HOSTILE in capsys.readouterr().out


def number(cell):
    try:
        float(cell)
    except ValueError:
        return False
    return True


@pytest.mark.parametrize("letters", ["\\e[31m", "\\u202e", "\\a", "\\x9b2J", "\\ud800"])
@pytest.mark.parametrize("key", ["title", "description"])
def test_what_steers_a_terminal_is_refused_and_not_printed(folder, capsys, key, letters):
    plain = text().replace(f"{key}: '", f'{key}: "{letters}"\nother: \'', 1)
    (folder / "studies" / "evil.yaml").write_text(plain)
    assert impactlab("studies") == 1
    said = capsys.readouterr().err
    assert f"evil.yaml: {key}" in said
    assert all(line.isprintable() for line in said.splitlines())


def test_the_name_of_a_file_does_not_steer_a_terminal(folder, capsys):
    for name in ("\x1b[31mred.yaml", "two\nlines.yaml"):
        (folder / "studies" / name).write_text(text())
        assert impactlab("run", f"studies/{name}") == 1
        said = capsys.readouterr().err
        assert said.startswith("ERROR: studies/")
        assert len(said.splitlines()) == 1
        assert said.rstrip("\n").isprintable()


@pytest.mark.parametrize("name", ["=1", "+a", "-a", "@a", "_a", "$a$", "a b", "a\\nb", "<b>", ""])
def test_groups_are_named_by_words(folder, capsys, name):
    (folder / "studies" / "evil.yaml").write_text(text().replace("one-a", f'"{name}"'))
    assert impactlab("design", "studies/evil.yaml") == 1
    assert "evil.yaml: sampling.groups: " in capsys.readouterr().err


def everything(folder):
    return {path for path in folder.rglob("*") if path.parts[-1] != "results"}


@pytest.mark.parametrize(
    "name",
    ["..", "../out", "../../out", "a/../../../out", "-n", "a b", ".hidden", "a.b", "x" * 101],
)
@pytest.mark.parametrize("command", ["run", "design", "recommend", "verify"])
def test_names_of_studies_lead_nowhere(folder, capsys, name, command):
    (folder / "studies" / "a").mkdir()
    target = folder / "studies" / f"{name}.yaml"
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(text().replace("function", "functio"))
    before = everything(folder.parent)
    assert impactlab(command, "--", f"studies/{name}.yaml") == 1
    assert "ERROR: studies/" in capsys.readouterr().err
    assert everything(folder.parent) == before


@pytest.mark.parametrize("place", ["results/evil", "results/evil/shards"])
def test_links_out_of_results_are_not_followed(folder, capsys, place):
    (folder / "studies" / "evil.yaml").write_text(text())
    out = folder.parent / "out"
    out.mkdir()
    (folder / place).parent.mkdir(parents=True)
    (folder / place).symlink_to(out)
    for command in ("run", "design"):
        assert impactlab(command, "studies/evil.yaml") == 1
        assert f"{place}: is a link to {out}, outside results/" in capsys.readouterr().err
    assert list(out.iterdir()) == []


def test_results_may_be_a_link_and_so_may_a_study(folder):
    real = folder.parent / "elsewhere.yaml"
    real.write_text(text())
    (folder / "studies" / "evil.yaml").symlink_to(real)
    (folder.parent / "large-disk").mkdir()
    (folder / "results").symlink_to(folder.parent / "large-disk")
    assert impactlab("design", "studies/evil.yaml") == 0
    assert (folder.parent / "large-disk" / "evil" / "design.nc").exists()


@pytest.mark.parametrize("name", ["../../out", "/tmp/out", "", "a b"])
def test_a_design_does_not_say_where_its_runs_go(folder, capsys, name):
    (folder / "studies" / "evil.yaml").write_text(text())
    assert impactlab("design", "studies/evil.yaml") == 0
    stored = xr.load_dataset(folder / "results" / "evil" / "design.nc").assign_attrs(study=name)
    write_netcdf(stored, folder / "design.nc", "design")
    before = everything(folder.parent)
    assert impactlab("run", "design.nc") == 1
    assert "its name becomes the name of a folder" in capsys.readouterr().err
    assert everything(folder.parent) == before
