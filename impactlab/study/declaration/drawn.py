"""What a sample says of one parameter: how it is distributed, or the one value that it keeps."""

from __future__ import annotations

from functools import cache
from typing import Any, Generic, Literal, TypeVar

from pydantic import ValidationInfo

from impactlab.model.parameters import Value
from impactlab.study.declaration.distributions import DISTRIBUTIONS, Distribution
from impactlab.study.declaration.form import Form, Reader, at_key, chosen, quantity
from impactlab.study.declaration.values import Factor

V = TypeVar("V", bound=Value)


class Fixed(Form, Generic[V]):
    """One value for all runs: the parameter is listed, but not varied."""

    distribution: Literal["fixed"]
    value: V


@cache
def drawn(factor: Factor) -> Reader:
    """Reads a Fixed, or a Distribution whose bounds, where it has any, the model allows.

    Words and whole numbers can only be fixed.
    """
    value_type: Any = factor.type
    fixed: dict[str, type[Form]] = {"fixed": Fixed[value_type]}
    if factor.parameter.choices or factor.parameter.whole:
        return _only_fixed(factor, chosen("distribution", fixed))
    read_any = chosen("distribution", _distributions(factor.parameter.units) | fixed)

    def read(data: Any, info: ValidationInfo) -> Any:
        given = read_any(data, info)
        for key, value in given.bounds().items() if isinstance(given, Distribution) else ():
            try:
                factor.check(value)
            except ValueError as error:
                raise at_key(key, str(error)) from None
        return given

    return read


def _only_fixed(factor: Factor, read_fixed: Reader) -> Reader:
    what = "a choice of words" if factor.parameter.choices else "a whole number"

    def read(data: Any, info: ValidationInfo) -> Any:
        if isinstance(data, dict) and data.get("distribution") == "fixed":
            return read_fixed(data, info)
        raise ValueError(
            f"is {what} and cannot be sampled: vary it in a study with method: grid, "
            "or write {distribution: fixed, value: ...}"
        )

    return read


@cache
def _distributions(units: str) -> dict[str, type[Form]]:
    return {name: form[quantity(units)] for name, form in DISTRIBUTIONS.items()}
