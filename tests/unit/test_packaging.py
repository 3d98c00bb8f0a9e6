"""Declarations in several places agree, and `make` says what is missing."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
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
