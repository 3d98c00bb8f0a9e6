"""Files beside the shards of a study that no study asks for any more."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.study.solvers import SOLVERS
from impactlab.study.storage import DAMAGED, Shards
from impactlab.study.work import Work

Array = np.ndarray[Any, Any]
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
        folder = Shards(shards_folder, work.form, SOLVERS[work.solver].VERSION).folder
        wanted.setdefault(folder, []).append(work.keys)
    found = {}
    for path in _beside(shards_folder):
        if reason := _reason(path, wanted):
            found[path] = reason if designs else NO_STUDY
    return found


def _beside(shards_folder: Path) -> Iterable[Path]:
    return sorted(path for path in shards_folder.glob("*/*") if path.is_file())


def _reason(path: Path, wanted: dict[Path, list[Array]]) -> str:
    """Why a file can go; "" where it has to stay."""
    if path.name.startswith("."):
        return UNFINISHED
    if path.name.endswith(DAMAGED):
        return SET_ASIDE
    if path.parent not in wanted:
        return OTHER_SOLVER
    keys = Shards.keys(path)
    asked = any(np.isin(keys, each).any() for each in wanted[path.parent])
    return OTHER_RUNS if keys.size and not asked else ""
