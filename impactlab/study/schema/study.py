"""Studies and verifications as their files define them, and the sections of a study of impacts."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, Field, PlainValidator, StrictBool

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.study.sampling.grid import Grid
from impactlab.study.sampling.methods import sampling_reader
from impactlab.study.sampling.sections import Sample
from impactlab.study.sampling.sobol import Sobol
from impactlab.study.schema.model import (
    Auto,
    DiscretisationSection,
    read_discretisation,
    read_impact,
)
from impactlab.study.schema.parameters import FACTORS
from impactlab.study.schema.section import (
    Heading,
    Number,
    Section,
    Whole,
    above_zero,
    between,
    names,
    one_of,
    quantity,
)
from impactlab.variables import ANALYSES, RESPONSES


class Store(Section):
    """Data kept of each run beside the responses.

    histories: force and displacements over time, at `samples` times. profiles: strains and
    deflection along the beam at the end.
    """

    histories: StrictBool = False
    profiles: StrictBool = False
    samples: Annotated[Whole, between(2, 100_000)] = 1000


class Analysis(Section):
    """Settings of sensitivity indices and their intervals.

    confidence: level of the intervals. resamples: number of bootstrap resamples. failed_runs: what
    happens to a response that is missing in some runs: no index is given ("fail"), or a surrogate
    fitted to the other runs supplies its values ("impute").
    """

    confidence: Annotated[Number, between(0.5, 0.999)] = 0.95
    resamples: Annotated[Whole, between(10, 100_000)] = 200
    failed_runs: Annotated[str, one_of("policy", ("fail", "impute"))] = "fail"


class StudyFile(Heading):
    """The keys of a study of impacts; units, choices and defaults come from PARAMETERS."""

    impact: Annotated[Impact, PlainValidator(read_impact)]
    discretisation: Annotated[DiscretisationSection, PlainValidator(read_discretisation)] = (
        DiscretisationSection(Discretisation())
    )
    duration: Annotated[quantity("s"), AfterValidator(above_zero)]  # type: ignore[valid-type]
    sampling: Annotated[Grid | Sample, PlainValidator(sampling_reader(FACTORS))]
    responses: Annotated[tuple[str, ...], names("response", RESPONSES)] = tuple(RESPONSES)
    analyses: Annotated[tuple[str, ...], names("analysis", ANALYSES)] = tuple(ANALYSES)
    store: Store = Field(default_factory=Store)
    analysis: Analysis | None = None


@dataclass(frozen=True)
class StudyBase:
    """The part of a study of runs that does not depend on its solver.

    name: the file's name without its ending; path: as given. responses: names of the responses of
    each run; analyses: names out of ANALYSES. analysis: settings of sensitivity indices. text: the
    file as it was read.
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
        """Describe the amount of work."""
        until = self.sampling.until if isinstance(self.sampling, Sobol) else None
        return f"{self.runs:,} runs" + (f", at most {until.runs:,}" if until else "")

    @property
    def runs(self) -> int:
        """Number of runs of the study."""
        return self.sampling.runs

    @property
    def sha256(self) -> str:
        """SHA-256 of the text, in hexadecimal digits."""
        return hashlib.sha256(self.text.encode()).hexdigest()


@dataclass(frozen=True)
class Study(StudyBase):
    """A study of impacts, in SI units.

    impact and discretisation: the base of all runs. auto: how to find nodes, points and courant
    where they are not given. duration: simulated time in s. responses: names out of RESPONSES.
    store: other data kept of each run.
    """

    impact: Impact
    discretisation: Discretisation
    auto: Auto | None
    duration: float
    store: Store


@dataclass(frozen=True)
class FunctionStudy(StudyBase):
    """A study of a test function in place of the solver. function: a name out of FUNCTIONS."""

    function: str


@dataclass(frozen=True)
class Verification:
    """Checks of the solver to make, and why.

    name: the file's name without its ending; path: as given. checks: names out of
    verification.catalogue, in the file's order. text: the file as it was read.
    """

    name: str
    path: Path
    title: str
    description: str
    checks: tuple[str, ...]
    text: str

    @property
    def size(self) -> str:
        """Describe the amount of work."""
        return f"{len(self.checks)} check{'s' * (len(self.checks) > 1)}"

    @property
    def sha256(self) -> str:
        """SHA-256 of the text, in hexadecimal digits."""
        return hashlib.sha256(self.text.encode()).hexdigest()
