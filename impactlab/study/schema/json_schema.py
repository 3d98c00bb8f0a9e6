"""JSON Schema of study files, with which editors complete keys and words and mark mistakes.

It is made from the sections that read the files. It accepts each file that they accept, and some
that they refuse: limits that hang on other values, and units, are theirs to check.
"""

from typing import Any

from pydantic import TypeAdapter

from impactlab.methods import METHODS
from impactlab.methods.distributions import CHOICE, DISTRIBUTIONS, ENTRIES, Integers
from impactlab.methods.grid import Grid, Range
from impactlab.model.parameters import PARAMETERS, Parameter
from impactlab.study.schema.declarations import DISCRETISATION, IMPACT, StudyFile
from impactlab.study.schema.readers import FunctionFile, verification_file
from impactlab.study.schema.table_file import Column, TableFile
from impactlab.validation.fields import value_type
from impactlab.variables import SCALARS
from impactlab.verification.functions import FUNCTIONS

Schema = dict[str, Any]
_QUANTITY: Schema = {"type": ["number", "string"]}
_BOUNDS = {"ge": "minimum", "le": "maximum", "gt": "exclusiveMinimum", "lt": "exclusiveMaximum"}


def study_schema() -> Schema:
    """Return the JSON Schema (draft 2020-12) of all kinds of study files."""
    number = Parameter("number", "1", "any number", ())
    entries: dict[str, Schema] = {"listed": {}, "drawn": {}}
    for name, parameter in PARAMETERS.items():
        shared = not (parameter.choices or parameter.is_integer)
        for kind, entry in (("listed", _grid_entry), ("drawn", _sample_entry)):
            schema = {"$ref": f"#/$defs/{kind}_number"} if shared else entry(parameter)
            entries[kind][name] = schema | {"description": parameter.long_name}
    impacts = _object(StudyFile)
    impacts["properties"] |= {
        "impact": _object(IMPACT),
        "discretisation": {"anyOf": [{"const": "auto"}, _object(DISCRETISATION)]},
        "duration": _QUANTITY,
        "sampling": _sampling("parameters"),
        "limits": _closed(dict.fromkeys(SCALARS, _QUANTITY)),
    }
    function = _object(FunctionFile)
    function["properties"] |= {
        "function": {"enum": list(FUNCTIONS)},
        "sampling": _sampling("number"),
        "limits": _open(_QUANTITY),
    }
    table = _object(TableFile)
    plain = [{"type": "null"}, {"type": "string"}]  # no unit, or the unit alone
    drawn: Schema = {"$ref": "#/$defs/drawn_column"}
    table["properties"] |= {
        "inputs": _open({"anyOf": [*plain, _object(Column), drawn]}),
        "outputs": _open({"anyOf": [*plain, _object(Column)]}),
        "limits": _open(_QUANTITY),
    }
    definitions = {
        "listed_number": _grid_entry(number),
        "drawn_number": _sample_entry(number),
        "listed_parameters": _closed(entries["listed"]),
        "drawn_parameters": _closed(entries["drawn"]),
        "drawn_column": _distributions([*DISTRIBUTIONS, CHOICE], _QUANTITY, _object(Column)),
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Study of impactlab",
        "type": "object",
        "if": {"required": ["checks"]},
        "then": _object(verification_file()),
        "else": {
            "if": {"required": ["table"]},
            "then": table,
            "else": {"if": {"required": ["function"]}, "then": function, "else": impacts},
        },
        "$defs": definitions,
    }


def _sampling(entries: str) -> Schema:
    """Return the schema of the section `sampling`, of impacts or of numbers of any name."""
    branches = []
    for name, kind in METHODS.items():
        section = _object(kind)
        reference = {"$ref": f"#/$defs/{'listed' if kind is Grid else 'drawn'}_{entries}"}
        section["properties"] |= {
            "method": {"const": name},
            "parameters": reference if entries == "parameters" else _open(reference),
        }
        section["required"] = ["method", *section.get("required", [])]
        branches.append({"if": {"properties": {"method": {"const": name}}}, "then": section})
    return {
        "type": "object",
        "required": ["method"],
        "properties": {"method": {"enum": list(METHODS)}},
        "allOf": branches,
    }


def _grid_entry(parameter: Parameter) -> Schema:
    """Return the schema of what a parameter has in a grid: a list, or a range of numbers."""
    value = _value(parameter)
    listed = {"type": "array", "items": value, "minItems": 1}
    if parameter.choices:
        return listed
    spaced = _object(Range[Any])
    spaced["properties"] |= {"start": value, "stop": value}
    return {"anyOf": [listed, spaced]}


def _sample_entry(parameter: Parameter) -> Schema:
    """Return the schema of a parameter in a sample: a distribution, words, or a fixed value."""
    names: list[str] = ["fixed"]
    if parameter.choices:
        names += [CHOICE]
    else:
        names += [Integers.name()] if parameter.is_integer else DISTRIBUTIONS
    return _distributions(names, _value(parameter))


def _distributions(names: list[str], value: Schema, beside: Schema | None = None) -> Schema:
    """Return the schema of an entry of one of these names; beside: a section with further keys."""
    branches = []
    for name in names:
        section = _object(ENTRIES[name])
        for key, entry in section["properties"].items():
            if key == "values":
                section["properties"][key] = {"type": "array", "items": value, "minItems": 2}
            elif not entry.keys() & {"type", "anyOf", "enum"}:
                section["properties"][key] = value
        section["properties"]["distribution"] = {"const": name}
        section["properties"] |= beside["properties"] if beside else {}
        section["required"] = ["distribution", *section.get("required", [])]
        branches.append({"if": {"properties": {"distribution": {"const": name}}}, "then": section})
    return {
        "type": "object",
        "required": ["distribution"],
        "properties": {"distribution": {"enum": names}},
        "allOf": branches,
    }


def _value(parameter: Parameter) -> Schema:
    schema: Schema = _plain(TypeAdapter(value_type(parameter)).json_schema())
    return schema


def _closed(properties: Schema) -> Schema:
    return {"type": "object", "properties": properties, "additionalProperties": False}


def _open(entry: Schema) -> Schema:
    return {"type": "object", "additionalProperties": entry}


def _object(kind: Any) -> Schema:
    """Return the schema of a section, without references."""
    schema = TypeAdapter(kind).json_schema()
    definitions = schema.pop("$defs", {})
    plain: Schema = _plain(schema, definitions)
    return plain


def _plain(node: Any, definitions: Schema | None = None) -> Any:
    """Return a schema with its references resolved, and without titles, which repeat the keys."""
    if isinstance(node, list):
        return [_plain(entry, definitions) for entry in node]
    if not isinstance(node, dict):
        return node
    if "$ref" in node:
        return _plain((definitions or {})[node["$ref"].rsplit("/")[-1]], definitions)
    plain: Schema = {}
    for key, entry in node.items():
        if key == "properties":  # names of keys, title among them
            plain[key] = {name: _plain(child, definitions) for name, child in entry.items()}
        elif key == "description":
            plain[key] = entry.split("\n")[0]
        elif key != "title" and not (key == "default" and not isinstance(entry, str | float)):
            plain[_BOUNDS.get(key) or key] = _plain(entry, definitions)
    return plain
