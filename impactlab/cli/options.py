"""Arguments that commands share, and how their texts are read."""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path
from typing import Annotated, Any

import typer

StudyFile = Annotated[
    Path, typer.Argument(metavar="STUDY", help="A study file, studies/NAME.yaml.")
]
RunsFile = Annotated[
    Path, typer.Argument(metavar="RUNS", help="Solved runs, results/NAME/runs.nc.")
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
