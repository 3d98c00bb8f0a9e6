"""Study files, their runs on disk, and projects to begin with."""

import re
from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import RESULTS, StudyFile

Folder = Annotated[Path, typer.Argument(help="Folder of study files.")]
Results = Annotated[Path, typer.Option(help="Folder of results.")]
FILES = {
    "Snakefile": "Snakefile",
    "workflow": "workflow",
    "profiles/local": "profiles/default",  # which Snakemake finds by itself
    "profiles/slurm": "profiles/slurm",
    "profiles/parts": "profiles/parts",
    "studies/velocity.yaml": "studies/velocity.yaml",
    "studies/material.yaml": "studies/material.yaml",
    "docs/studies.md": "docs/studies.md",  # to which comments of these files point
    "docs/contact_laws.md": "docs/contact_laws.md",
    "docs/parts.md": "docs/parts.md",
    "docs/scaling.md": "docs/scaling.md",
}
"""The repository's own, which the wheel brings along (see pyproject.toml), and their places."""
_ELSEWHERE = (
    r"!?\[([^\]]*)\]\((?!https?:|#|studies\.md|parts\.md|scaling\.md|contact_laws\.md)[^)]*\)"
)
_SCHEMA = "study.schema.json"
_ENVIRONMENT = """# For snakemake --software-deployment-method conda
channels: [conda-forge, nodefaults]
dependencies: ["python>=3.11,<3.14", pip, pip: ["impactlab[workflow]=={version}"]]
"""
_README = """# Studies of impacts with impactlab

Needed: `pip install 'impactlab[workflow]'`. Then, in this folder:

    snakemake --cores all                # every file in studies/; then open results/index.html
    impactlab go studies/velocity.yaml   # one study; then open results/velocity/report.html

A study is a file in `studies/`: copy one, rename it and change it. Both commands resume where they
were interrupted, and do again what a changed file asks for. Editors complete and check the keys by
`studies/study.schema.json` (Visual Studio Code: with the extension YAML). `impactlab -h` lists the
other commands; `docs/studies.md` lists every key. For clusters: `profiles/`, `docs/parts.md`.
"""


def shipped(name: str) -> Path:
    """Return the path of a file of the repository, in a checkout or as the wheel has it."""
    package = Path(__file__).parents[1]
    return (package / "project" if (package / "project").is_dir() else package.parent) / name


def studies(
    folder: Folder = Path("studies"),
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, for workflows.")] = False,
) -> None:
    """List a folder's studies and how many runs they have."""
    files = sorted(folder.glob("*.yaml"))
    if not files:
        raise FileNotFoundError(f"{folder}: no study files (*.yaml) there")
    if as_json:
        import json

        from impactlab.study.schema.readers import describe

        print(json.dumps([describe(path) for path in files], indent=1))
        return
    from impactlab.report.console import print_studies
    from impactlab.study.schema.readers import read_any

    read = [read_any(path) for path in files]
    print_studies((study.name, study.size, study.title) for study in read)


def schema() -> None:
    """Print the JSON Schema of study files, for editors."""
    print(_schema())


def _schema() -> str:
    import json

    from impactlab.study.schema.json_schema import study_schema

    return json.dumps(study_schema(), indent=1, ensure_ascii=False)


def status(study: StudyFile, results: Results = RESULTS) -> None:
    """Show the progress of a study: runs solved, failed and left.

    Changes nothing; the study may be running.
    """
    from impactlab.report.console import print_status
    from impactlab.study import steps
    from impactlab.study.schema.readers import read_study

    progress = steps.status(read_study(study), results / study.stem)
    if progress is None:
        print(f"{study.stem}: its discretisation is auto and not yet determined: no run is solved")
    else:
        print_status(study.stem, progress)


def clean(
    folder: Folder = Path("studies"),
    results: Results = RESULTS,
    yes: Annotated[bool, typer.Option("--yes", help="Remove without asking.")] = False,
) -> None:
    """Remove solved runs that no study in a folder needs.

    Asks first. Runs that a changed study still needs stay, and so do runs.nc, the reports, and the
    runs of studies that have no file there.
    """
    from impactlab.report.console import print_files
    from impactlab.study.steps import removable

    with removable(folder, results) as files:
        if not files:
            print("Nothing to remove: the studies there need every shard.")
            return
        print_files(files)
        if yes or typer.confirm("Remove these files?"):
            for path in files:
                path.unlink()


def new(folder: Annotated[Path, typer.Argument(help="New or empty folder.")]) -> None:
    """Make a project: workflow, profiles and two studies."""
    from importlib.metadata import version
    from shutil import copy, copytree, which

    if folder.exists() and (folder.is_file() or any(folder.iterdir())):
        raise ValueError(f"{folder}: is there already: name a folder that is new, or empty")
    for name, place in FILES.items():
        source = shipped(name)
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        (copytree if source.is_dir() else copy)(source, folder / place)
    for page in (folder / "docs").glob("*.md"):  # without links to pages that are not copied
        text = page.read_text(encoding="utf-8")
        page.write_text(re.sub(_ELSEWHERE, r"\1", text), encoding="utf-8")
    (folder / "studies" / _SCHEMA).write_text(_schema(), encoding="utf-8")
    for path in (folder / "studies").glob("*.yaml"):
        text = path.read_text(encoding="utf-8")
        path.write_text(f"# yaml-language-server: $schema={_SCHEMA}\n{text}", encoding="utf-8")
    (folder / "environment.yaml").write_text(_ENVIRONMENT.format(version=version("impactlab")))
    (folder / "README.md").write_text(_README)
    install = "" if which("snakemake") else "pip install 'impactlab[workflow]' && "
    print(f"{folder}: a workflow, two studies. Next: {install}cd {folder} && snakemake --cores all")
