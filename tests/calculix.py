"""Runs of CalculiX on a deck, and a parser of its output."""

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

CCX = shutil.which("ccx")
_LONGEST = 500
"""Seconds that a run may take: many times the usual."""


def needed(test: Callable[..., None]) -> Callable[..., None]:
    """Mark a test that runs CalculiX, skipped where there is none."""
    there = pytest.mark.skipif(CCX is None, reason="there is no command ccx (calculix-ccx)")
    return pytest.mark.calculix(there(test))


@dataclass
class Run:
    """A run's return code (minus the signal that ended it), screen and printed results."""

    code: int
    screen: str
    printed: str

    def table(self, title: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return times (t,) and rows (t, rows, columns) of the tables under this title."""
        blocks = re.findall(rf"{title}.*? time +(\S+)\n\n((?: +.*\n)+)", self.printed)
        rows = [[line.split() for line in body.splitlines()] for _, body in blocks]
        return np.array([time for time, _ in blocks], float), np.array(rows, float)

    def contact(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return times (t,) and the force on the slave surface, (t, 3)."""
        times = re.findall(r"statistics for slave set.*? time +(\S+)", self.printed)
        forces = re.findall(r"total surface force.*\n\n(.*)\n", self.printed)
        return np.array(times, float), np.array([f.split()[:3] for f in forces], float)


def run(deck: Path, threads: int = 1) -> Run:
    """Run CalculiX on this deck, in the deck's folder."""
    assert CCX is not None
    lines = ["stdbuf", "-oL"]  # else a crash takes the screen with it
    done = subprocess.run(
        [*lines, CCX, deck.stem],
        cwd=deck.parent,
        env={**os.environ, "OMP_NUM_THREADS": str(threads)},
        capture_output=True,
        text=True,
        check=False,
        timeout=_LONGEST,
    )
    printed = deck.with_suffix(".dat")
    return Run(done.returncode, done.stdout, printed.read_text() if printed.exists() else "")
