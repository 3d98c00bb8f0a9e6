"""Arguments that commands share, and how their texts are read."""

from __future__ import annotations

from collections.abc import Collection
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

StudyFile = Annotated[
    Path, typer.Argument(metavar="STUDY", help="A study file, studies/NAME.yaml.")
]
RunsFile = Annotated[
    Path, typer.Argument(metavar="RUNS", help="Solved runs, results/NAME/runs.nc.")
]
new_file: Any = partial(typer.Option, dir_okay=False)
"""An option for a file to write; a folder of this name is refused before any work."""
new_folder: Any = partial(typer.Option, file_okay=False)
"""An option for a folder to write to; a file of this name is refused."""
RESULTS = Path("results")


def chosen(option: str, text: str, names: Collection[str]) -> tuple[str, ...]:
    """Return the names of a list "a,b", none of "". Raises ValueError naming the option."""
    from impactlab.study.errors import unknown

    found = tuple(filter(None, text.replace(",", " ").split()))
    for name in found:
        if name not in names:
            raise ValueError(f"{option} = {text!r}: {unknown('response', name, names)}")
    return found


def given(option: str, text: str, units: str) -> float:
    """Return an option's quantity in SI; "s" is a duration. Raises ValueError naming the option."""
    from impactlab.model.quantities import duration, si

    try:
        return duration(text) if units == "s" else si(text, units)
    except ValueError as error:
        raise ValueError(f"{option} = {text!r}: {error}") from None


def assigned(arguments: list[str]) -> dict[str, str]:
    """Arguments NAME=VALUE by name; raises ValueError for any other, and for a name given twice."""
    found: dict[str, str] = {}
    for argument in arguments:
        name, sign, text = argument.partition("=")
        if not sign or not text:
            raise ValueError(f"{argument!r}: expected NAME=VALUE, such as velocity=2")
        if name in found:
            raise ValueError(f"{name}: is given twice, as {found[name]!r} and as {text!r}")
        found[name] = text
    return found
