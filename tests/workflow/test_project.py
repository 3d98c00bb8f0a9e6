"""A project made by someone who has the wheel alone."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from command_line import called
from command_line import done as impactlab

from impactlab.cli.studies import FILES

ROOT = Path(__file__).parents[2]


def test_a_project_brings_workflow_and_studies(tmp_path):
    told = impactlab("new", "mine", cwd=tmp_path).stdout
    assert told.endswith("cd mine && snakemake --cores all\n")
    for name in ("Snakefile", "workflow/rules/common.smk"):
        assert (tmp_path / "mine" / name).read_bytes() == (ROOT / name).read_bytes()
    studies = tmp_path / "mine" / "studies"
    modeline, text = (studies / "velocity.yaml").read_text().split("\n", 1)
    assert text == (ROOT / "studies" / "velocity.yaml").read_text()
    schema = json.loads(
        (studies / modeline.removeprefix("# yaml-language-server: $schema=")).read_text()
    )
    assert schema["else"]["else"]["else"]["properties"]["impact"]["properties"]["velocity"]
    assert "snakemake --cores all" in (tmp_path / "mine" / "README.md").read_text()
    assert_pages_are_there(tmp_path / "mine")
    again = called("new", "mine", cwd=tmp_path)
    assert again.returncode == 1
    assert "mine: is there already" in again.stderr


def assert_pages_are_there(project):
    """Every page that a file of the project names, or links to, is in it."""
    for path in (path for path in project.rglob("*") if path.is_file()):
        text = path.read_text()
        pages = {project / name for name in re.findall(r"docs/\w+\.md", text)}
        if path.suffix == ".md":
            pages |= {path.parent / name for name in re.findall(r"\]\(([\w/.-]+)", text)}
        assert not [page for page in pages if not page.exists() and "http" not in str(page)], path


def test_the_wheel_brings_what_commands_read():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]
    included = settings["hatch"]["build"]["targets"]["wheel"]["force-include"]
    assert included.pop("CITATION.cff") == "impactlab/CITATION.cff"  # which results refer to
    assert included == {name: f"impactlab/project/{name}" for name in included}
    for name in (*FILES, "studies/verification.yaml"):
        assert any(name == kept or name.startswith(f"{kept}/") for kept in included), name


def run(*command, cwd):
    """Run a command without anything of this environment; it must succeed."""
    kept = {name: os.environ[name] for name in ("HOME", "LANG") if name in os.environ}
    env = kept | {"PATH": f"{cwd / 'env' / 'bin'}:/usr/bin:/bin"}
    env |= {name: value for name, value in os.environ.items() if name.startswith(("UV_", "SSL_"))}
    folder = cwd / "mine" if command[0] == "snakemake" else cwd
    done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.mark.long
def test_a_project_of_a_wheel_runs_in_an_empty_environment(tmp_path):
    wheel = (sys.executable, "-m", "pip", "wheel", "--no-deps", "--wheel-dir", ".", ROOT)
    run(*map(str, wheel), cwd=tmp_path)
    (built,) = tmp_path.glob("impactlab-*.whl")
    run(sys.executable, "-m", "venv", "--without-pip", "env", cwd=tmp_path)
    pins = ("--constraint", str(ROOT / "constraints.txt"), "--python", "env/bin/python")
    run(sys.executable, "-m", "uv", "pip", "install", *pins, f"{built}[workflow]", cwd=tmp_path)
    run("env/bin/impactlab", "new", "mine", cwd=tmp_path)
    run("snakemake", "--cores", "all", cwd=tmp_path)
    assert (tmp_path / "mine" / "results" / "velocity" / "report.html").exists()
    assert (tmp_path / "mine" / "results" / "index.html").exists()
    again = run("snakemake", "--cores", "all", "--dry-run", cwd=tmp_path)
    assert "Nothing to be done" in again
