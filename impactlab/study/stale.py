"""Files beside the shards of a study that no study asks for any more."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.study.solvers import SOLVERS, solver_named
from impactlab.study.storage import DAMAGED, Form, Shards
from impactlab.study.work import Work

Array = np.ndarray[Any, Any]
_STUDY = "study"
"""Beside the folders of shards: where the file lies that asks for them."""
NO_STUDY = "its study is gone"
SET_ASIDE = "was damaged and set aside"
UNFINISHED = "was not written to its end"
OTHER_RUNS = "no run in it is asked for"
OTHER_SOLVER = "of another version of the solver, or in another form"


def stale(shards_folder: Path, designs: Collection[xr.Dataset]) -> dict[Path, str]:
    """What can go in a study's folder of shards, and why; nothing is removed.

    designs: all that the study may ask for; none where it is gone. A shard stays as long as one of
    its runs is asked for, or it cannot be read.
    """
    wanted: dict[Path, list[Array]] = {}
    for design in designs:
        work = Work.of(design)
        folder = Shards(shards_folder, work.form, solver_named(work.solver).VERSION).folder
        wanted.setdefault(folder, []).append(work.keys)
    found = {}
    for path in _beside(shards_folder):
        if reason := _reason(path, wanted):
            found[path] = reason if designs else NO_STUDY
    return found


def note_study(shards_folder: Path, file: Path) -> None:
    """Leave word of where the study lies that asks for what is in a folder."""
    shards_folder.mkdir(parents=True, exist_ok=True)
    with suppress(OSError):  # a full disk is told by what needs more of it
        (shards_folder / _STUDY).write_text(f"{file.resolve()}\n")


def noted_study(shards_folder: Path) -> Path | None:
    """The file that note_study told of, where there is one still."""
    note = shards_folder / _STUDY
    with suppress(OSError, ValueError):
        file = Path(note.read_text().strip())
        return file if file.is_file() else None
    return None


def outdated(folder: Path) -> dict[Path, str]:
    """As stale, of runs beside a study's own, all responses kept: those of another solver.

    Which of the others would be asked for again, only a search tells.
    """
    versions = [solver_named(name).VERSION for name in SOLVERS]
    current = {Shards(folder, Form(0, False), version).folder for version in versions}
    reasons = {path: _beyond_asking(path, current) for path in _beside(folder)}
    return {path: reason for path, reason in reasons.items() if reason}


def _beside(shards_folder: Path) -> Iterable[Path]:
    return sorted(path for path in shards_folder.glob("*/*") if path.is_file())


def _reason(path: Path, wanted: Mapping[Path, list[Array]]) -> str:
    """Why a file can go; "" where it has to stay."""
    if reason := _beyond_asking(path, wanted):
        return reason
    keys = Shards.keys(path)
    asked = any(np.isin(keys, each).any() for each in wanted[path.parent])
    return OTHER_RUNS if keys.size and not asked else ""


def _beyond_asking(path: Path, current: Collection[Path]) -> str:
    """Why no study can ask for what is in a file; current: folders of the solvers of today."""
    if path.name.startswith("."):
        return UNFINISHED
    if path.name.endswith(DAMAGED):
        return SET_ASIDE
    return "" if path.parent in current else OTHER_SOLVER
