"""A study of impacts as its file declares it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.study.declaration import checks, messages
from impactlab.study.declaration.declared import Declared
from impactlab.study.declaration.reading import Source
from impactlab.study.declaration.schema import Analysis, Store, StudyForm
from impactlab.study.declaration.sections import Auto
from impactlab.study.errors import Problem, StudyError


@dataclass(frozen=True)
class Study(Declared):
    """What to run and why: everything that a study file says, in SI units.

    impact and discretisation: the base of all runs. auto: how nodes, points and courant are to be
    found, where they are not stated. duration: simulated time in s. responses: names out of
    dataset.RESPONSES. store: what else is kept of each run.
    """

    impact: Impact
    discretisation: Discretisation
    auto: Auto | None
    duration: float
    store: Store


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
