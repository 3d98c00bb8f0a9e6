"""The form of a study file: which keys it has, and what may stand at each.

The keys, units and choices of parameters come from the table PARAMETERS: a new parameter needs
nothing here.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    Field,
    PlainValidator,
    StrictBool,
    StringConstraints,
    TypeAdapter,
)

from impactlab.dataset import RESPONSES
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


_WORDS: TypeAdapter[list[str]] = TypeAdapter(list[Annotated[str, one_of("response", RESPONSES)]])


def _responses(data: Any) -> tuple[str, ...]:
    if data == "all":
        return tuple(RESPONSES)
    if not isinstance(data, list) or not data:
        raise ValueError(f"expected `all`, or a list of names out of {', '.join(RESPONSES)}")
    names = _WORDS.validate_python(data)
    if twice := [name for at, name in enumerate(names) if name in names[:at]]:
        raise ValueError(f"names {twice[0]} more than once: name each response once")
    return tuple(names)


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
    responses: Annotated[tuple[str, ...], PlainValidator(_responses)] = tuple(RESPONSES)
    store: Store = Field(default_factory=Store)
    analysis: Analysis | None = None
