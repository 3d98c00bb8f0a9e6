"""What a study can vary: each parameter with the type of its values and what the model allows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any

from pydantic import AfterValidator

from impactlab.model.parameters import PARAMETERS, Parameter, Value
from impactlab.study.declaration.form import Whole, one_of, quantity
from impactlab.study.validity import check_alone


@dataclass(frozen=True)
class Factor:
    """A parameter as study files may state it.

    check: raises ValueError with the reason when no run at all can have this value.
    """

    parameter: Parameter
    check: Callable[[Value], None]

    @property
    def type(self) -> Any:
        """Pydantic's type of one value: a word, a whole number, or a number in SI units."""
        if self.parameter.choices:
            return Annotated[str, one_of(self.parameter.long_name, self.parameter.choices)]
        number = Whole if self.parameter.whole else quantity(self.parameter.units)
        return Annotated[number, AfterValidator(self._possible)]

    def _possible(self, value: Value) -> Value:
        self.check(value)
        return value


FACTORS = {name: Factor(entry, partial(check_alone, name)) for name, entry in PARAMETERS.items()}
"""Everything that an impact and its discretisation can vary, by name."""

VALUES: dict[str, Any] = {name: factor.type for name, factor in FACTORS.items()}
"""Pydantic types by the name of the parameter; they give SI numbers and words."""
