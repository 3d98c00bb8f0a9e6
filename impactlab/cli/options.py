"""Arguments that commands share, and how their texts are read."""

import os
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Annotated, Any

import typer


def stored_in(*names: str) -> Callable[[Path], Path]:
    """Return a callback that takes a folder of results, results/NAME, for the first file in it.

    names: of the files; the first one is taken where none is there, so that the error names it.
    """

    def path_in(value: Path) -> Path:
        if not value.is_dir():
            return value
        files = [value / name for name in names]
        return next(filter(Path.exists, files), files[0])

    return path_in


def argument(metavar: str, help: str, *names: str) -> Any:
    """Return an argument for a file of results, or for the folder that holds it."""
    return typer.Argument(metavar=metavar, help=help, callback=stored_in(*names))


def all_stored(values: list[Path]) -> list[Path]:
    """Take a folder of results, results/NAME, for the files of a report in it."""
    if len(values) == 1 and values[0].is_dir():
        from impactlab.report.results import stored_files  # late: it loads xarray

        return stored_files(values[0])
    return values


def study_or_design(value: Path) -> Path:
    """Take a folder of results for its design.nc, or else for the study file."""
    path = stored_in("design.nc")(value)
    return path if path.exists() else _study_file(value)


def _study_file(value: Path) -> Path:
    """Take a folder of results for the study file that they are of."""
    path = stored_in("runs.nc", "design.nc", "findings.nc")(value)
    if path == value:
        return value
    from impactlab.files import opened

    with opened(path, indexed=False) as stored:
        file = str(stored.attrs.get("study_file", ""))
    if not file:
        raise ValueError(f"{path}: names no study file: name it instead, studies/NAME.yaml")
    return Path(os.path.normpath(value / file))


StudyFile = Annotated[
    Path,
    typer.Argument(
        metavar="STUDY",
        help="A study file, studies/NAME.yaml, or results/NAME.",
        callback=_study_file,
    ),
]
RunsFile = Annotated[
    Path, argument("RUNS", "Solved runs, results/NAME/runs.nc, or results/NAME.", "runs.nc")
]
RESULTS = Path("results")


def new_file(*suffixes: str, help: str) -> Any:
    """Return an option for a file to write; other suffixes, and folders, are refused at once."""
    return typer.Option(help=help, dir_okay=False, callback=_check(suffixes))


def new_folder(*, help: str) -> Any:
    """Return an option for a folder to write to; a file, or the name of one, is refused at once."""
    return typer.Option(help=help, file_okay=False, callback=_check(()))


def _check(suffixes: tuple[str, ...]) -> Callable[[typer.CallbackParam, Path | None], Path | None]:
    def check(param: typer.CallbackParam, value: Path | None) -> Path | None:
        if value is not None:
            from impactlab.files import check_suffix  # late: it loads xarray

            check_suffix(param.opts[0], value, suffixes)
        return value

    return check


def chosen(option: str, text: str, names: Collection[str]) -> tuple[str, ...]:
    """Return the names of a list "a,b", none of "". Raises ValueError naming the option."""
    from impactlab.validation.errors import unknown

    selected = tuple(filter(None, text.replace(",", " ").split()))
    for name in selected:
        if name not in names:
            raise ValueError(f"{option} = {text!r}: {unknown('response', name, names)}")
    return selected


def given(option: str, text: str, units: str) -> float:
    """Return an option's quantity in SI; "s" is a duration. Raises ValueError naming the option."""
    from impactlab.model.quantities import duration, si

    try:
        return duration(text) if units == "s" else si(text, units)
    except ValueError as error:
        raise ValueError(f"{option} = {text!r}: {error}") from None


def assigned(arguments: list[str]) -> dict[str, str]:
    """Return arguments NAME=VALUE by name. Raises ValueError for any other, or a repeated name."""
    values: dict[str, str] = {}
    for argument in arguments:
        name, sign, text = argument.partition("=")
        if not sign or not text:
            raise ValueError(f"{argument!r}: expected NAME=VALUE, such as velocity=2")
        if name in values:
            raise ValueError(f"{name}: appears twice, as {values[name]!r} and as {text!r}")
        values[name] = text
    return values
