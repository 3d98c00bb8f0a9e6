"""Sections that are objects in Python, too: one class for both.

Made in Python, such an object holds what was stated, unchecked; read from a mapping, with the
parameters of a study as context, it holds checked values in SI units. `Study` reads the mappings of
the objects that it is given.
"""

import re
from collections.abc import Mapping
from dataclasses import MISSING, fields
from functools import cache
from typing import Any, ClassVar, Self

import numpy as np
from pydantic import ConfigDict, TypeAdapter, ValidationInfo, model_validator

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import PARAMETERS, flatten
from impactlab.model.quantities import as_text


class Stated:
    """A dataclass whose fields are the keys of a section, beside the key that names the class."""

    __pydantic_config__ = ConfigDict(extra="forbid")
    _name_key: ClassVar[str]

    @classmethod
    def name(cls) -> str:
        """Return the name of the class as study files spell it: log_uniform for LogUniform."""
        return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", cls.__name__).lower()

    @classmethod
    def read(cls, data: Any, context: Any) -> Self:
        """Return the section of a mapping. Raises pydantic's error, see `section.validated`."""
        section: Self = _adapter(cls).validate_python(data, context=context)  # type: ignore[arg-type]
        return section

    @model_validator(mode="before")
    @classmethod
    def _note_keys(cls, data: Any, info: ValidationInfo) -> Any:
        if not isinstance(data, dict):
            return data
        keys = (cls._name_key, *(field.name for field in fields(cls)))  # type: ignore[arg-type]
        info.context["keys"][id(data)] = keys  # type: ignore[index]
        return {key: value for key, value in data.items() if key != cls._name_key}

    def stated(self) -> dict[str, Any]:
        """Return the keys and values of the section as a study file has them.

        Returns
        -------
        dict
            The name of the class, and its fields but for optional ones that are empty.
        """
        section: dict[str, Any] = {self._name_key: self.name()}
        for field in fields(self):  # type: ignore[arg-type]
            value = getattr(self, field.name)
            required = field.default is MISSING and field.default_factory is MISSING
            if required or not (value is None or value == () or value == {}):
                section[field.name] = plain(value)
        return section


@cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(kind)


def plain(value: Any) -> Any:
    """Return numbers, text, lists and mappings in place of any other value.

    Raises ValueError for a value that no study file can hold.
    """
    if isinstance(value, Stated):
        return value.stated()
    if isinstance(value, Impact):
        return _parameters("impact", value, Discretisation())
    if isinstance(value, Discretisation):
        return _parameters("discretisation", paper_impact(), value)
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set):
        return [plain(item) for item in value]
    if not isinstance(text := as_text(value), str | int | float | list | None):
        raise ValueError(f"is of type {type(value).__name__}, which no study file can hold")
    return text


def _parameters(root: str, impact: Impact, grid: Discretisation) -> dict[str, Any]:
    """Return every value as a section of a study file: defaults, too, which may change."""
    section: dict[str, Any] = {}
    for name, value in flatten(impact, grid).items():
        key, *path, last = PARAMETERS[name].path
        if key == root:
            node = section
            for step in path:
                node = node.setdefault(step, {})
            node[last] = value
    return section
