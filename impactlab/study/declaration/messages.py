"""Pydantic's errors as problems of a study file, in words for the person who wrote it."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from impactlab.study.errors import Problem, dotted, unknown

_WORDS = {
    "missing": "is required",
    "string_type": "expected text: put it in quotes",
    "bool_type": "expected true or false",
    "invalid_key": "a key must be a word",
    "model_type": "expected a mapping with keys of its own",
    "too_short": "is empty: list at least one value",
    "tuple_type": "expected a list of names",
}
"""What to say for pydantic's types of error; for any other its own message stands."""
_NOT_HERE = {
    r".*(correlat|covarian|copula).*": (
        "parameters that vary together are not possible: the indices share out the variance of "
        "independent parameters, and drawing these independently without a word would be wrong; "
        "vary what they depend on in common, take one index for all (groups), or hold all but one "
        "at a value ({distribution: fixed, value: ...})"
    ),
    "groups?": "groups are for the section sampling with method: sobol or morris",
    "until": "is for the section sampling with method: sobol",
}
"""Keys that people look for, as patterns, and what to say where there is no such key."""


def problems(
    error: ValidationError, data: Any, file: str, keys: Mapping[int, Sequence[str]]
) -> list[Problem]:
    """The problems of a study file.

    data: what was validated. keys: the keys allowed in each mapping in it, by the mapping's id.
    """
    return [_problem(line, data, file, keys) for line in error.errors(include_url=False)]


def _problem(line: Any, data: Any, file: str, keys: Mapping[int, Sequence[str]]) -> Problem:
    kind, context = line["type"], line.get("ctx", {})
    path = [*line["loc"], *context["key"].split(".")] if kind == "at_key" else [*line["loc"]]
    parent, present, value = _found(data, path)
    if kind == "extra_forbidden":
        reason = _no_such_key(path[-1], keys[id(parent)])
    elif kind == "value_error":
        reason = str(context["error"])
    else:
        reason = _WORDS.get(kind, line["msg"])
    shown = {"value": value} if present and not isinstance(value, dict) else {}
    return Problem(file, dotted(path), reason, **shown)


def _no_such_key(key: Any, allowed: Sequence[str]) -> str:
    looked_for = (words for like, words in _NOT_HERE.items() if re.fullmatch(like, str(key)))
    return next(looked_for, None) or unknown("key", key, allowed)


def _found(data: Any, path: Sequence[Any]) -> tuple[Any, bool, Any]:
    """The mapping or list at the end of a path, whether it has the last step, and what is there."""
    parent = None
    for step in path:
        parent = data
        known = step in parent if isinstance(parent, dict) else isinstance(parent, list)
        if not known:
            return parent, False, None
        data = parent[int(step)] if isinstance(parent, list) else parent[step]
    return parent, True, data
