"""The form of a study file: which keys it has, and what may stand at each.

The keys, units and choices of parameters come from the table PARAMETERS: a new parameter needs
nothing here.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    Field,
    PlainValidator,
    StrictBool,
    StringConstraints,
    TypeAdapter,
)

from impactlab.dataset import ANALYSES, RESPONSES
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.study.declaration.form import (
    Form,
    Number,
    Whole,
    above_zero,
    between,
    one_of,
    quantity,
)
from impactlab.study.declaration.methods import Grid, Sobol, read_sampling
from impactlab.study.declaration.sections import read_discretisation, read_impact


def _printable(text: str) -> str:
    if not all(line.isprintable() for line in text.replace("\t", " ").split("\n")):
        raise ValueError("holds characters that cannot be printed: take them out")
    return text


def _one_line(text: str) -> str:
    if len(text.splitlines()) != 1:
        raise ValueError("must be one line of text; more goes to the key description")
    return text


def _names(kind: str, choices: Collection[str]) -> PlainValidator:
    """Reads `all`, or a list of some of the choices."""
    words: TypeAdapter[list[str]] = TypeAdapter(list[Annotated[str, one_of(kind, choices)]])

    def read(data: Any) -> tuple[str, ...]:
        if data == "all":
            return tuple(choices)
        if not isinstance(data, list) or not data:
            raise ValueError(f"expected `all`, or a list of names out of {', '.join(choices)}")
        names = words.validate_python(data)
        if twice := [name for at, name in enumerate(names) if name in names[:at]]:
            raise ValueError(f"names {twice[0]} more than once: name each {kind} once")
        return tuple(names)

    return PlainValidator(read)


Text = Annotated[
    str,
    StringConstraints(strict=True, strip_whitespace=True, max_length=2000),
    AfterValidator(_printable),
]
Fraction = Annotated[Number, between(0.5, 0.999)]


class Store(Form):
    """What is kept of each run beside the responses.

    histories: force and displacements over time, at `samples` times. profiles: strains and
    deflection along the beam at the end.
    """

    histories: StrictBool = False
    profiles: StrictBool = False
    samples: Annotated[Whole, between(2, 100_000)] = 1000


class Analysis(Form):
    """How intervals of sensitivity indices are made.

    confidence: their level. resamples: bootstrap resamples each.
    """

    confidence: Fraction = 0.95
    resamples: Annotated[Whole, between(10, 100_000)] = 200


class StudyForm(Form):
    """A study file, read: SI numbers, objects of the model, a way of sampling."""

    title: Annotated[Text, StringConstraints(max_length=200), AfterValidator(_one_line)]
    description: Text = ""
    impact: Annotated[Impact, PlainValidator(read_impact)]
    discretisation: Annotated[Discretisation, PlainValidator(read_discretisation)] = Field(
        default_factory=Discretisation
    )
    duration: Annotated[quantity("s"), AfterValidator(above_zero)]  # type: ignore[valid-type]
    sampling: Annotated[Grid | Sobol, PlainValidator(read_sampling)]
    responses: Annotated[tuple[str, ...], _names("response", RESPONSES)] = tuple(RESPONSES)
    analyses: Annotated[tuple[str, ...], _names("analysis", ANALYSES)] = tuple(ANALYSES)
    store: Store = Field(default_factory=Store)
    analysis: Analysis | None = None
