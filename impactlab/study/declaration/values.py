"""The type of one value of each parameter: its unit or its choices, and what the model allows."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator

from impactlab.model.parameters import PARAMETERS, Parameter, Value
from impactlab.study.declaration.form import Whole, one_of, quantity
from impactlab.study.possible import check_alone


def _value(parameter: Parameter) -> Any:
    def possible(value: Value) -> Value:
        check_alone(parameter.name, value)
        return value

    if parameter.choices:
        return Annotated[str, one_of(parameter.long_name, parameter.choices)]
    number = Whole if parameter.whole else quantity(parameter.units)
    return Annotated[number, AfterValidator(possible)]


VALUES: dict[str, Any] = {name: _value(entry) for name, entry in PARAMETERS.items()}
"""Pydantic types by the name of the parameter; they give SI numbers and words."""
