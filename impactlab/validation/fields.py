"""Base classes of the sections of a study file, types of their values, and messages.

A `Stated` section is an object in Python, too. Made there, it holds what was stated, unchecked;
read from a mapping, with the parameters of a study as context, it holds checked values in SI units.
`Study` reads the mappings of the objects that it is given.
"""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import MISSING, fields
from functools import cache, partial
from typing import Annotated, Any, ClassVar, Literal, Self, TypeVar

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    PlainValidator,
    StrictStr,
    StringConstraints,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    create_model,
    model_validator,
)
from pydantic_core import PydanticCustomError

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import PARAMETERS, Parameter, flatten
from impactlab.model.quantities import as_text, si, whole
from impactlab.validation.errors import Problem, StudyError, dotted, unknown
from impactlab.validation.refusals import check_alone


class FileSection(BaseModel):
    """A mapping with fixed keys; any other key is refused.

    The context of the validation takes the allowed keys under "keys", by the id of the mapping, so
    that a message about an unknown key can list them; it holds the parameters that the study can
    vary under "parameters", and units of responses of its own under "responses".
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _note_keys(cls, data: Any, info: ValidationInfo) -> Any:
        if info.context:
            info.context["keys"][id(data)] = tuple(cls.model_fields)
        return data


def at_key(key: str, reason: str) -> PydanticCustomError:
    """Return an error at a (dotted) key below the mapping under validation."""
    return PydanticCustomError("at_key", "{reason}", {"key": key, "reason": reason})


def quantity(units: str) -> Any:
    """Return the type of a number in SI `units`, or a string with a unit of that dimension."""
    return Annotated[float, _read_quantity(units)]


def _read_quantity(units: str) -> BeforeValidator:
    return BeforeValidator(partial(si, units=units), json_schema_input_type=float | str)


def one_of(kind: str, choices: Collection[str]) -> BeforeValidator:
    """Return a check that a value is a word out of `choices`."""

    def check(value: object) -> object:
        if not isinstance(value, str) or value not in choices:
            raise ValueError(unknown(kind, value, choices))
        return value

    return BeforeValidator(check, json_schema_input_type=Literal[tuple(choices)])


def names(kind: str, choices: Collection[str], further: Collection[str] = ()) -> PlainValidator:
    """Return the reader of `all` choices, or of a list of some (and of the study's own).

    further: what may be listed, and is not among `all`.
    """

    def read(data: Any, info: ValidationInfo) -> tuple[str, ...]:
        every = dict.fromkeys([*choices, *further, *(info.context or {}).get(f"{kind}s", ())])
        adapter: TypeAdapter[list[str]] = TypeAdapter(list[Annotated[str, one_of(kind, every)]])
        if data == "all":
            return tuple(choices)
        if not isinstance(data, list) or not data:
            raise ValueError(f"expected `all`, or a list of names: choose from {', '.join(every)}")
        entries = adapter.validate_python(data)
        if twice := [name for index, name in enumerate(entries) if name in entries[:index]]:
            raise ValueError(f"names {twice[0]} more than once: name each {kind} once")
        return tuple(entries)

    word: Any = one_of(kind, [*choices, *further]).json_schema_input_type
    return PlainValidator(read, json_schema_input_type=Literal["all"] | list[word])


def name_at(key: str, choices: Collection[str], data: Any) -> str:
    """Return the entry at `key` of a mapping. Raises ValueError unless it is among the choices."""
    if not isinstance(data, dict):
        raise ValueError(f"expected a mapping with the key {key} ({', '.join(choices)})")
    if key not in data:
        raise at_key(key, f"is required: choose from {', '.join(choices)}")
    name = data[key]
    if not isinstance(name, str) or name not in choices:
        raise at_key(key, unknown(key, name, choices))
    return name


def by_name(
    title: str, types: Mapping[str, Any], data: Any, info: ValidationInfo
) -> dict[str, Any]:
    """Read a mapping of some of these keys, each with its type; return it in the file's order."""
    usual = isinstance(data, dict) and data.keys() <= types.keys()
    names = data if usual else types  # all of them, for the message on another one
    fields: Any = {name: (types[name], None) for name in names}
    section = create_model(title, __base__=FileSection, **fields)
    content = section.model_validate(data, context=info.context)
    return {name: getattr(content, name) for name in data}


def requires(test: Callable[[Any], bool], message: str) -> AfterValidator:
    """Return a check that a value passes a test; the message says what it must be."""

    def check(value: Any) -> Any:
        if not test(value):
            raise ValueError(message)
        return value

    return AfterValidator(check)


Names = Annotated[tuple[StrictStr, ...], requires(bool, "is empty: list at least one name")]
"""A list of words, at least one."""
Number = Annotated[float, _read_quantity("1")]
"""A pure number."""
Whole = Annotated[int, BeforeValidator(whole)]
"""A whole number."""
Text = Annotated[
    str,
    StringConstraints(strict=True, strip_whitespace=True, max_length=2000),
    requires(
        lambda text: all(line.isprintable() for line in text.replace("\t", " ").split("\n")),
        "holds characters that cannot be printed: take them out",
    ),
]

LABEL = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,59}")
"""Names of a study's own; no formulas in tables, and no labels that a legend leaves out."""


def value_type(parameter: Parameter) -> Any:
    """Return the type of one value: a word, a whole number, or a number in SI units."""
    if parameter.choices:
        return Annotated[str, one_of(parameter.long_name, parameter.choices)]
    if parameter.any_word and parameter.path:
        return str | list[Any]
    number = Whole if parameter.is_integer else quantity(parameter.units)
    return Annotated[number, AfterValidator(partial(check_alone, parameter))]


_ONE_LINE = requires(
    lambda text: len(text.splitlines()) == 1,
    "must be one line of text: put more into the key description",
)


class Heading(FileSection):
    """The first keys of every study file, which head the report."""

    title: Annotated[Text, StringConstraints(max_length=200), _ONE_LINE]
    description: Text = ""


_WORDS = {
    "missing": "is required",
    "greater_than": "must be above {gt:,}",
    "greater_than_equal": "must be at least {ge:,}",
    "less_than": "must be below {lt:,}",
    "less_than_equal": "must be at most {le:,}",
    "string_type": "expected text: put it in quotes",
    "bool_type": "expected true or false",
    "invalid_key": "a key must be a word",
    "model_type": "expected a mapping with keys of its own",
    "dataclass_type": "expected a mapping with keys of its own",
    "too_short": "is empty: list at least one value",
    "tuple_type": "expected a list of names",
}
"""Messages for pydantic's types of error, with its numbers; any other keeps its own message."""
_NOT_HERE = {
    r".*(correlat|covarian|copula).*": (
        "parameters correlate by the key correlations of the section sampling with method: latin, "
        "delta, hsic, pawn, rbd_fast, regression, shapley or target_hsic alone; Sobol, Morris and "
        "FAST indices assume independent parameters: for these vary the quantities "
        "that they depend on, give them one index together "
        "(groups), or fix all but one ({distribution: fixed, value: ...})"
    ),
    "groups?": "groups belong to the section sampling with method: sobol or morris",
    "until": "belongs to the section sampling with method: sobol or a Latin hypercube",
}
"""Keys that people look for, as patterns, and messages for where there is no such key."""


S = TypeVar("S", bound=FileSection)


def validated(
    kind: type[S],
    data: Any,
    file: str,
    parameters: Mapping[str, Parameter] = PARAMETERS,
    responses: Mapping[str, str] | None = None,
) -> S:
    """Return a file's content as its section. Raises StudyError with all of its problems.

    parameters: those that it can vary. responses: those that it may have, with their units.
    """
    keys: dict[int, tuple[str, ...]] = {}
    context = {"keys": keys, "parameters": parameters, "responses": responses or {}}
    try:
        return kind.model_validate(data, context=context)
    except ValidationError as error:
        lines = error.errors(include_url=False)
    raise StudyError(*(_problem(line, data, file, keys) for line in lines))


def _problem(line: Any, data: Any, file: str, keys: Mapping[int, Sequence[str]]) -> Problem:
    kind, context = line["type"], line.get("ctx", {})
    path = [*line["loc"], *context["key"].split(".")] if kind == "at_key" else [*line["loc"]]
    parent, present, value = _value_at(data, path)
    if kind in ("extra_forbidden", "unexpected_keyword_argument"):
        allowed, key = keys[id(parent)], str(path[-1])
        elsewhere = (
            say
            for like, say in _NOT_HERE.items()
            if re.fullmatch(like, key) and not any(re.fullmatch(like, name) for name in allowed)
        )
        reason = next(elsewhere, None) or _nested(path) or unknown("key", path[-1], allowed)
    elif kind == "value_error":
        reason = str(context["error"])
    else:
        reason = _WORDS[kind].format(**context) if kind in _WORDS else line["msg"]
    shown = {"value": value} if present and not isinstance(value, dict) else {}
    return Problem(file, dotted(path), reason, **shown)


def _nested(path: Sequence[Any]) -> str:
    """Return where a parameter belongs that stands by its full name in a section of its root."""
    entry = PARAMETERS.get(str(path[-1]))
    if entry is None or len(path) != 2 or path[0] != entry.path[0]:
        return ""
    text = "..."
    for key in reversed(entry.path[1:]):
        text = f"{{{key}: {text}}}"
    return f"is written {text[1:-1]} in the section {path[0]}"


def _value_at(data: Any, path: Sequence[Any]) -> tuple[Any, bool, Any]:
    """Return the mapping or list that holds the end of a path, whether it does, and the value."""
    parent = None
    for step in path:
        parent = data
        if not (step in parent if isinstance(parent, dict) else isinstance(parent, list)):
            return parent, False, None
        data = parent[int(step)] if isinstance(parent, list) else parent[step]
    return parent, True, data


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
