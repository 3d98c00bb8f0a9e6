"""A study of a test function as its file declares it: all of a study, on known indices."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any

from pydantic import Field, PlainValidator, ValidationError, create_model

from impactlab.model.parameters import Parameter, Value
from impactlab.study.declaration import messages
from impactlab.study.declaration.declared import Declared
from impactlab.study.declaration.heading import Heading
from impactlab.study.declaration.methods import Grid, Sample, sampling_reader
from impactlab.study.declaration.reading import Source
from impactlab.study.declaration.schema import Analysis
from impactlab.study.declaration.values import Factor
from impactlab.study.errors import Problem, StudyError, unknown
from impactlab.verification.functions import FUNCTIONS

RESPONSES = ("value",)


@dataclass(frozen=True)
class FunctionStudy(Declared):
    """Runs of a function in the place of the solver. function: a name out of FUNCTIONS."""

    function: str


def function_study(source: Source) -> FunctionStudy:
    """The study that a file declares. Raises StudyError that holds everything wrong with it."""
    name, file = source.data.get("function"), str(source.path)
    if not isinstance(name, str) or name not in FUNCTIONS:
        raise StudyError(Problem(file, "function", unknown("function", name, FUNCTIONS), name))
    keys: dict[int, tuple[str, ...]] = {}
    try:
        form: Any = _form(name).model_validate(source.data, context=keys)
    except ValidationError as error:
        raise StudyError(*messages.problems(error, source.data, file, keys)) from None
    return FunctionStudy(
        name=source.name,
        path=source.path,
        title=form.title,
        description=form.description,
        sampling=form.sampling,
        responses=RESPONSES,
        analyses=("sensitivity", "surrogate"),
        analysis=form.analysis,
        text=source.text,
        function=name,
    )


@cache
def _form(name: str) -> type[Heading]:
    title = FUNCTIONS[name].title
    factors = {key: _factor(key, title) for key in FUNCTIONS[name].ranges}
    sampling = Annotated[Grid | Sample, PlainValidator(sampling_reader(factors))]
    fields: Any = {
        "function": (str, ...),
        "sampling": (sampling, ...),
        "analysis": (Analysis, Field(default_factory=Analysis)),
    }
    return create_model("FunctionForm", __base__=Heading, **fields)


def _factor(name: str, title: str) -> Factor:
    return Factor(Parameter(name, "1", f"{name} of the {title}", ()), _any)


def _any(value: Value) -> None:
    """Every number is possible."""
