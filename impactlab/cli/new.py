"""A folder with the workflow and studies to begin with, for whoever has no checkout."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

FILES = {
    "Snakefile": "Snakefile",
    "workflow": "workflow",
    "profiles/local": "profiles/default",  # which Snakemake finds by itself
    "profiles/slurm": "profiles/slurm",
    "studies/velocity.yaml": "studies/velocity.yaml",
    "studies/material.yaml": "studies/material.yaml",
}
"""The repository's own, which the wheel brings along (see pyproject.toml), and their places."""
_ENVIRONMENT = """# For snakemake --software-deployment-method conda
channels: [conda-forge, nodefaults]
dependencies: ["python>=3.11,<3.14", pip, pip: ["impactlab[workflow]=={version}"]]
"""
_README = """# Studies of impacts with impactlab

Needed: `pip install 'impactlab[workflow]'`. Then, in this folder:

    snakemake --cores all                # every file in studies/; then open results/index.html
    impactlab go studies/velocity.yaml   # one study; then open results/velocity/report.html

A study is a file in `studies/`: copy one, rename it and change it. Both commands resume where they
were interrupted, and do again what a changed file asks for. `impactlab -h` lists the other
commands. For clusters: `profiles/slurm/`.
"""


def new(
    folder: Annotated[Path, typer.Argument(help="Made by this command, or empty.")],
) -> None:
    """Make a project: workflow, profiles and two studies."""
    from importlib.metadata import version
    from shutil import copy, copytree, which

    if folder.exists() and (folder.is_file() or any(folder.iterdir())):
        raise ValueError(f"{folder}: is there already: name a folder that is new, or empty")
    package = Path(__file__).parents[1]
    source = package / "project" if (package / "project").is_dir() else package.parent
    for name, place in FILES.items():
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        (copytree if (source / name).is_dir() else copy)(source / name, folder / place)
    (folder / "environment.yaml").write_text(_ENVIRONMENT.format(version=version("impactlab")))
    (folder / "README.md").write_text(_README)
    install = "" if which("snakemake") else "pip install 'impactlab[workflow]' && "
    print(f"{folder}: a workflow, two studies. Next: {install}cd {folder} && snakemake --cores all")
