"""A study of runs as its file declares it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.study.declaration import checks, messages
from impactlab.study.declaration.methods import Grid, Sample, Sobol
from impactlab.study.declaration.reading import Source
from impactlab.study.declaration.schema import Analysis, Store, StudyForm
from impactlab.study.declaration.sections import Auto
from impactlab.study.errors import Problem, StudyError


@dataclass(frozen=True)
class Study:
    """What to run and why: everything that a study file says, in SI units.

    name: the file's, without the ending; path: as it was given. impact and discretisation: the
    base of all runs. auto: how nodes, points and courant are to be found, where they are not
    stated. duration: simulated time in s. sampling: Grid or Sample. responses: names out of
    dataset.RESPONSES; analyses: out of dataset.ANALYSES. store: what else is kept of each run.
    analysis: how sensitivity indices are made. text: the file as it was read.
    """

    name: str
    path: Path
    title: str
    description: str
    impact: Impact
    discretisation: Discretisation
    auto: Auto | None
    duration: float
    sampling: Grid | Sample
    responses: tuple[str, ...]
    analyses: tuple[str, ...]
    store: Store
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


def study(source: Source) -> Study:
    """The study that a file declares. Raises StudyError that holds everything wrong with it."""
    data, path = source.data, source.path
    form, problems = _validated(data, str(path))
    sound = set(StudyForm.model_fields) - {problem.key.split(".")[0] for problem in problems}
    problems += checks.problems(form, str(path), sound)
    if problems:
        raise StudyError(*problems)
    return Study(
        name=source.name,
        path=path,
        title=form.title,
        description=form.description,
        impact=form.impact,
        discretisation=form.discretisation.discretisation,
        auto=form.discretisation.auto,
        duration=form.duration,
        sampling=form.sampling,
        responses=form.responses,
        analyses=form.analyses,
        store=form.store,
        analysis=form.analysis or Analysis(),
        text=source.text,
    )


_STAND_INS: dict[str, Any] = {
    "title": "-",
    "impact": {"base": "paper"},
    "duration": 1.0,
    "sampling": {"method": "grid", "parameters": {"velocity": [1.0]}},
}
"""For required sections that are wrong, so that the others can be checked all the same."""


def _validated(data: dict[str, Any], file: str) -> tuple[StudyForm, list[Problem]]:
    keys: dict[int, tuple[str, ...]] = {}
    try:
        return StudyForm.model_validate(data, context=keys), []
    except ValidationError as error:
        wrong = {line["loc"][0] for line in error.errors(include_url=False)}
        sound = {key: data[key] for key in StudyForm.model_fields if key in data.keys() - wrong}
        form = StudyForm.model_validate(_STAND_INS | sound)
        return form, messages.problems(error, data, file, keys)
