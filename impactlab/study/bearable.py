"""What is said of a study before it runs: what is hardly meant, and what costs too much."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from shutil import disk_usage

from distributed.system import MEMORY_LIMIT

from impactlab.study.declaration import FunctionStudy, Study
from impactlab.study.declaration.plausible import doubts, ends_of, stated_at
from impactlab.study.errors import Problem
from impactlab.study.estimate import Estimate
from impactlab.study.status import disk_size
from impactlab.study.words import amount, time

MOST_TIME = 30 * 86400.0
"""Of one core, in s: a month."""


def remarks(study: Study | FunctionStudy) -> list[Problem]:
    """What of a study's impacts is hardly meant, though it can be."""
    if isinstance(study, FunctionStudy):
        return []
    found = doubts(ends_of((study.impact, study.discretisation), study.sampling))
    file = str(study.path)
    return [Problem(file, stated_at(each.name, study.sampling), each.reason) for each in found]


def unbearable(cost: Estimate, folder: Path) -> list[Problem]:
    """What is beyond a month of one core, this machine's memory, or the free disk at `folder`.

    One problem each, at the key that drives it.
    """
    return [
        Problem(cost.file, key, f"{reason}; see --dry-run, and --force runs it all the same")
        for key, reason in _beyond(cost, room(folder))
    ]


def _beyond(cost: Estimate, disk: float) -> Iterator[tuple[str, str]]:
    if cost.seconds > MOST_TIME:
        limit = f"above the {time(MOST_TIME)} that a study may take"
        yield cost.slow, f"about {time(cost.seconds)} of one core for {cost.runs:,} runs, {limit}"
    if cost.memory > MEMORY_LIMIT:
        yield cost.large, f"about {amount(cost.memory)} of memory, of {amount(MEMORY_LIMIT)}"
    if cost.disk > disk:
        yield cost.large, f"about {amount(cost.disk)} of disk, of {amount(disk)} that it may take"


def room(folder: Path) -> float:
    """Bytes that a study may take: those free on the disk of its folder, and its own there."""
    there = next(each for each in (folder, *folder.resolve().parents) if each.exists())
    return float(disk_usage(there).free + disk_size(folder.rglob("*")))
