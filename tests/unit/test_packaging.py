"""Declarations in several places agree, and `make` says what is missing."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from runpy import run_path
from types import SimpleNamespace

import pytest
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name
from packaging.version import Version
from ruamel.yaml import YAML

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
PINS = (ROOT / "constraints.txt").read_text().splitlines()


def declared():
    extras = PROJECT["optional-dependencies"].values()
    lines = [*PROJECT["dependencies"], *(line for extra in extras for line in extra)]
    requirements = [Requirement(line) for line in lines]
    return [entry for entry in requirements if entry.name != "impactlab"]


@pytest.mark.parametrize("requirement", declared(), ids=lambda entry: entry.name)
def test_every_dependency_is_pinned_within_its_bounds(requirement):
    pins = {canonicalize_name(pin.name): pin.specifier for pin in map(Requirement, PINS)}
    (pinned,) = pins[canonicalize_name(requirement.name)]
    assert Version(pinned.version) in requirement.specifier


def test_citation_and_changelog_agree_with_the_project():
    citation = YAML(typ="safe").load(ROOT / "CITATION.cff")
    assert citation["version"] == PROJECT["version"]
    assert citation["license"] == PROJECT["license"]
    assert citation["keywords"] == PROJECT["keywords"]
    assert citation["authors"] == PROJECT["authors"]
    assert f"\n## {PROJECT['version']} " in (ROOT / "CHANGELOG.md").read_text()
    # No option, address or path of whoever made them.
    pin = re.compile(r"[a-z0-9-]+==[\w.]+( ; [\w\s=<>!.']+)?")
    assert [line for line in PINS if not pin.fullmatch(line)] == []
    # conda environment has the same python
    packages = YAML(typ="safe").load(ROOT / "environment.yaml")["dependencies"]
    assert f"python{PROJECT['requires-python']}" in packages


CONDA = {"dask": "dask-core", "matplotlib": "matplotlib-base"}
"""Names on conda-forge that are not those of the package index."""


def test_the_recipe_for_conda_needs_what_the_project_needs():
    recipe = YAML(typ="safe").load(ROOT / "recipe" / "recipe.yaml")
    context = recipe["context"]
    stated = [
        line.replace("${{ python_min }}", context["python_min"]).partition(" ")[::2]
        for line in recipe["requirements"]["run"]
    ]
    needs = [Requirement(line) for line in PROJECT["dependencies"]]
    expected = {CONDA.get(name := canonicalize_name(need.name), name): need for need in needs}
    specifiers = {name: need.specifier for name, need in expected.items()}
    specifiers["python"] = SpecifierSet(PROJECT["requires-python"])
    assert {canonicalize_name(name): SpecifierSet(text) for name, text in stated} == specifiers
    assert context["version"] == PROJECT["version"]
    assert recipe["about"]["summary"] == PROJECT["description"]
    entry_points = dict(line.split(" = ") for line in recipe["build"]["python"]["entry_points"])
    assert entry_points == PROJECT["scripts"]
    (backend,) = tomllib.loads((ROOT / "pyproject.toml").read_text())["build-system"]["requires"]
    assert backend in {line.replace(" ", "") for line in recipe["requirements"]["host"]}


def test_links_of_the_readme_are_absolute_on_the_package_index(monkeypatch):
    interface = SimpleNamespace(MetadataHookInterface=object)  # hatchling is where wheels are built
    monkeypatch.setitem(sys.modules, "hatchling.metadata.plugin.interface", interface)
    hook = run_path(str(ROOT / "recipe" / "hatch_build.py"))["CustomMetadataHook"]()
    hook.root, hook.config = str(ROOT), {"repository": "https://example.org/a/b/"}
    hook.update(metadata := {})
    relative = re.findall(r"\]\(([^:)]+)\)", (ROOT / "README.md").read_text(encoding="utf-8"))
    links = re.findall(r"\]\((.+?)\)", metadata["readme"]["text"])
    parts = [re.fullmatch("https://example.org/a/b/(blob|raw)/HEAD/(.+)", link) for link in links]
    assert [part[2] for part in parts if part] == relative
    assert relative
    assert all((ROOT / path.partition("#")[0]).exists() for path in relative)
    assert all((part[1] == "raw") == part[2].endswith(".png") for part in parts if part)
    assert all(part or link.startswith("https://") for part, link in zip(parts, links, strict=True))


SECTIONS = [
    *("Summary", "Statement of need", "State of the field", "Software design", "Example"),
    *("Research impact statement", "AI usage disclosure", "Acknowledgements", "References"),
]
"""What the Journal of Open Source Software requires, and an example."""


def test_the_paper_is_in_the_form_of_its_journal():
    _, head, text = (ROOT / "paper" / "paper.md").read_text(encoding="utf-8").split("---\n", 2)
    metadata = YAML(typ="safe").load(head)
    assert metadata.keys() >= {"title", "tags", "authors", "affiliations", "date"}
    assert {author["affiliation"] for author in metadata["authors"]} <= {
        affiliation["index"] for affiliation in metadata["affiliations"]
    }
    assert re.fullmatch(r"\d{1,2} [A-Z][a-z]+ \d{4}", metadata["date"])
    code = re.compile("^```.*?^```", re.DOTALL | re.MULTILINE)
    prose = code.sub("", text)
    assert 750 <= len(prose.split()) <= 1750
    assert re.findall(r"^# (.*)$", prose, re.MULTILINE) == SECTIONS
    references = (ROOT / "paper" / metadata["bibliography"]).read_text(encoding="utf-8")
    entries = re.findall(r"^@\w+\{(\w+),", references, re.MULTILINE)
    assert sorted(set(re.findall(r"@(\w+)", prose))) == sorted(entries)
    assert all((ROOT / "paper" / path).exists() for path in re.findall(r"\]\((.*?)\)", prose))


def stand_in(version, fails_on):
    """A python of another version, or one without some of its parts."""
    claim = f"import sys; sys.version_info = ({version.replace('.', ', ')})"
    return f"""#!/bin/sh
case "$*" in -V) echo Python {version}; exit;; {fails_on}) exit 1;; esac
exec "{sys.executable}" -c "{claim}; $2"
"""


@pytest.mark.skipif(shutil.which("make") is None, reason="needs the command make")
@pytest.mark.parametrize(
    ("script", "message"),
    [
        (stand_in("3.10.9", "-"), "needs Python 3.11, 3.12 or 3.13; {python} is: Python 3.10.9"),
        (stand_in("3.14.0", "-"), "needs Python 3.11, 3.12 or 3.13; {python} is: Python 3.14.0"),
        (stand_in("3.11.0", "*ensurepip*"), "apt install python3-venv"),
        (None, "needs Python 3.11"),
    ],
    ids=["too old", "too new", "without ensurepip", "absent"],
)
def test_make_says_which_python_it_needs(tmp_path, script, message):
    python, venv = tmp_path / "python", tmp_path / "venv"
    if script is not None:
        python.write_text(script)
        python.chmod(0o755)
    command = ["make", "--directory", str(ROOT), "study", f"PYTHON={python}", f"VENV={venv}"]
    clean = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
    result = subprocess.run(
        command, env=clean, capture_output=True, text=True, check=False, timeout=60
    )
    assert result.returncode != 0
    assert message.format(python=python) in result.stdout
    assert not venv.exists()
