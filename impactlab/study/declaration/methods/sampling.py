"""What all ways of choosing runs have in common."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self

from pydantic import PlainValidator, ValidationInfo, create_model, model_validator

from impactlab.model.parameters import Value
from impactlab.study.declaration.form import Form, Reader, at_key
from impactlab.study.declaration.values import Factor

MOST_RUNS = 10_000_000


class Sampling(Form):
    """Which parameters are varied, in the order of the file, and how."""

    fewest: ClassVar[int] = 1

    method: str
    parameters: Mapping[str, Any]

    @staticmethod
    @abstractmethod
    def entry(factor: Factor) -> Reader:
        """Reads what the section says of one parameter."""

    @property
    @abstractmethod
    def runs(self) -> int:
        """How many runs the study has."""

    @property
    def varied(self) -> Mapping[str, Any]:
        """What is said of each parameter that differs between runs."""
        return self.parameters

    @property
    def fixed(self) -> dict[str, Value]:
        """The parameters listed with one value, which replaces the study's."""
        return {}

    @abstractmethod
    def bounds(self) -> dict[str, tuple[Value, ...]]:
        """Least and greatest number of each bounded parameter, or any one word."""

    @classmethod
    def of(cls, factors: Mapping[str, Factor]) -> type[Self]:
        """This method for studies that can vary these factors."""
        parameters = Annotated[Mapping[str, Any], _by_name(cls, factors)]
        fields: Any = {"parameters": (parameters, ...)}
        return create_model(cls.__name__, __base__=cls, **fields)

    @model_validator(mode="after")
    def _bearable(self) -> Self:
        if len(self.varied) < self.fewest:
            reason = f"too few: method {self.method} varies {self.fewest} or more"
            raise at_key("parameters", reason + " (fixed ones do not count)" * bool(self.fixed))
        if self.runs > MOST_RUNS:
            raise ValueError(f"makes {self.runs:,} runs: at most {MOST_RUNS:,} are possible")
        return self


def _by_name(method: type[Sampling], factors: Mapping[str, Factor]) -> PlainValidator:
    """Reads a mapping from names of factors, in the order of the file."""
    entries: Any = {
        name: (Annotated[Any, PlainValidator(method.entry(factor))], None)
        for name, factor in factors.items()
    }
    form = create_model("Parameters", __base__=Form, **entries)

    def read(data: Any, info: ValidationInfo) -> dict[str, Any]:
        given = form.model_validate(data, context=info.context)
        return {name: getattr(given, name) for name in data}

    return PlainValidator(read)
