"""The text of a study file that sections given in Python stand for."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

from ruamel.yaml import YAML

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import PARAMETERS, flatten
from impactlab.validation.errors import Problem, StudyError
from impactlab.validation.stated import plain


def _values(impact: Impact, grid: Discretisation, root: str) -> dict[str, Any]:
    """Return every value as a section of a study file: defaults, too, which may change."""
    section: dict[str, Any] = {}
    for name, value in flatten(impact, grid).items():
        key, *path = PARAMETERS[name].path
        if key == root:
            node = section
            for step in path[:-1]:
                node = node.setdefault(step, {})
            node[path[-1]] = value
    return section


def content_of(sections: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of a study file with these sections; those that are None are left out.

    Raises StudyError naming a section that no file can hold.
    """
    content: dict[str, Any] = {}
    for key, section in sections.items():
        if isinstance(section, Impact):
            section = _values(section, Discretisation(), "impact")
        elif isinstance(section, Discretisation):
            section = _values(paper_impact(), section, "discretisation")
        try:
            content |= {} if section is None else {key: plain(section)}
        except ValueError as error:
            raise StudyError(Problem("Study", key, str(error))) from None
    return content


def text_of(content: Mapping[str, Any]) -> str:
    """Return the text of a study file with this content."""
    yaml: Any = YAML(typ="safe", pure=True)
    text = io.StringIO()
    yaml.default_flow_style, yaml.sort_base_mapping_type_on_output = None, False
    yaml.width, yaml.allow_unicode = 96, True
    yaml.dump(content, text)
    return text.getvalue()
