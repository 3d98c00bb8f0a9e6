"""Study files for the tests to change and to damage."""

import json

import pytest
from jsonschema import Draft202012Validator
from ruamel.yaml import YAML

from impactlab.study.schema.json_schema import study_schema
from impactlab.study.schema.readers import read_study
from impactlab.validation.errors import StudyError

GRID = """
title: A grid
impact: {base: paper}
duration: 12 ms
sampling:
  method: grid
  parameters:
    velocity: [0.5 m/s, 1]
"""
SAMPLE = """
title: A sample
impact: {base: paper}
duration: 1 ms
sampling:
  method: sobol
  base_samples: 8
  parameters:
    velocity: {distribution: uniform, low: 1 m/s, high: 2 m/s}
    beam_depth: {distribution: normal, mean: 27.8 mm, standard_deviation: 0.1 mm}
"""


def changed(text, changes):
    """The text with values set at dotted keys."""
    data = YAML(typ="safe", pure=True).load(text)
    for path, value in changes.items():
        *parents, last = path.split(".")
        node = data
        for step in parents:
            node = node.setdefault(step, {})
        node[last] = value
    return json.dumps(data).replace("NaN", ".nan")


@pytest.fixture(scope="session")
def validator():
    """The JSON Schema of study files."""
    schema = json.loads(json.dumps(study_schema()))
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


@pytest.fixture
def grid():
    """Makes the text of a grid study, with values set at dotted keys."""
    return lambda changes=None: changed(GRID, changes) if changes else GRID


@pytest.fixture
def sample():
    """Makes the text of a sample study, with values set at dotted keys."""
    return lambda changes=None: changed(SAMPLE, changes) if changes else SAMPLE


@pytest.fixture
def sampled():
    """Makes the text of a study with this section `sampling`, of three bounded parameters."""
    names = {"velocity": (1, 2), "beam_depth": (0.02, 0.03), "gravity": (0, 10)}
    given = {
        name: {"distribution": "uniform", "low": low, "high": high}
        for name, (low, high) in names.items()
    }

    def text(method, parameters=None, **others):
        section = {"method": method, "parameters": given | (parameters or {})} | others
        limits = {"limits": {"peak_force": "10 kN"}} if method == "target_hsic" else {}
        return changed(SAMPLE, {"sampling": section} | limits)

    return text


@pytest.fixture
def read(tmp_path):
    """Reads a study from its text."""

    def reader(text, name="some-study_1.yaml"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_study(path)

    return reader


@pytest.fixture
def problems(read):
    """The problems of a study's text: (key, the whole line)."""

    def reader(text, name="some-study_1.yaml"):
        with pytest.raises(StudyError) as caught:
            read(text, name)
        return [(problem.key, str(problem)) for problem in caught.value.args]

    return reader


@pytest.fixture
def refused(problems):
    """Check that a study's text has one problem, at this key and in these words; its line."""

    def check(text, key, *words):
        ((where, line),) = problems(text)
        assert where == key
        for part in words:
            assert part in line
        return line

    return check
