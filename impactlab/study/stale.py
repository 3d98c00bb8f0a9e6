"""Shards that no study asks for any more."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from impactlab.study.lock import held
from impactlab.study.solvers import SOLVERS
from impactlab.study.storage import DAMAGED, Shards
from impactlab.study.work import Work


def stale(shards_folder: Path, designs: Iterable[xr.Dataset]) -> dict[Path, str]:
    """Files of a study's shards that can go, and why; nothing is removed.

    designs: all that the study may ask for; none where it is gone. A shard stays as long as one of
    its runs is asked for. Raises BlockingIOError where a process works in the folder.
    """
    with held(shards_folder):
        wanted = [(work, Shards(shards_folder, work.form, _version(work))) for work in works(designs)]
        ...
