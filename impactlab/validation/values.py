"""Types of single values of parameters in study files."""

from __future__ import annotations

import re
from functools import partial
from typing import Annotated, Any

from pydantic import AfterValidator

from impactlab.model.parameters import Parameter
from impactlab.validation.fields import Whole, one_of, quantity
from impactlab.validation.refusals import check_alone

LABEL = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,59}")
"""Names of a study's own; no formulas in tables, and no labels that a legend leaves out."""


def value_type(parameter: Parameter) -> Any:
    """Return the type of one value: a word, a whole number, or a number in SI units."""
    if parameter.choices:
        return Annotated[str, one_of(parameter.long_name, parameter.choices)]
    number = Whole if parameter.is_integer else quantity(parameter.units)
    return Annotated[number, AfterValidator(partial(check_alone, parameter))]
