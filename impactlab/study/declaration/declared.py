"""What every study of runs declares, whatever solves them."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from impactlab.study.declaration.methods import Grid, Sample, Sobol
from impactlab.study.declaration.schema import Analysis


@dataclass(frozen=True)
class Declared:
    """The part of a study of runs that does not depend on its solver.

    name: the file's, without the ending; path: as it was given. sampling: Grid or Sample.
    responses: what is asked of each run; analyses: out of dataset.ANALYSES. analysis: how
    sensitivity indices are made. text: the file as it was read.
    """

    name: str
    path: Path
    title: str
    description: str
    sampling: Grid | Sample
    responses: tuple[str, ...]
    analyses: tuple[str, ...]
    analysis: Analysis
    text: str

    @property
    def size(self) -> str:
        """How much there is to do, in words."""
        until = self.sampling.until if isinstance(self.sampling, Sobol) else None
        return f"{self.runs:,} runs" + (f", at most {until.runs:,}" if until else "")

    @property
    def runs(self) -> int:
        """How many runs the study has."""
        return self.sampling.runs

    @property
    def sha256(self) -> str:
        """The SHA-256 of the text, in hexadecimal digits."""
        return hashlib.sha256(self.text.encode()).hexdigest()
